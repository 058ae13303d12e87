// Bytes: the file, its GLB chunks, its buffers and images wherever they lie. Private to scene/gltf.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/gltf/document.h"

namespace scenegen::gltf::reading {

using Bytes = std::span<const std::uint8_t>;

/// A block that is not cleared first, with simdjson's padding behind it.
struct Block {
  std::unique_ptr<std::uint8_t[]> data;
  std::uint64_t size = 0;
  [[nodiscard]] Bytes bytes() const { return {data.get(), size}; }
};
[[nodiscard]] Block make_block(std::uint64_t size);

/// Reads at most `most` bytes of a regular file; "-" is stdin when `allow_stdin`. Faults are of kind io, at
/// `at`.
[[nodiscard]] Block read_file(const std::string& path, const Place& at, bool allow_stdin, std::uint64_t most);

struct Container {
  std::string_view json;
  Bytes bin;
  bool has_bin = false;
};
/// Splits a .glb into its chunks; anything that does not begin with "glTF" is taken for JSON.
[[nodiscard]] Container split_container(Bytes file);

/// True and the bytes for "data:[type][;base64],…".
[[nodiscard]] bool decode_data_uri(std::string_view uri, const Place& at, std::vector<std::uint8_t>& out,
                                   std::string* media_type);
/// Path of a relative URI below (or beside, "../") the folder of the document; faults on schemes and absolute
/// paths.
[[nodiscard]] std::string resolve_uri(std::string_view uri, const std::string& folder, const Place& at);

/// The document's buffers, each buffer's byteLength long.
class Buffers {
 public:
  void load(const Document& document, const Container& container, const std::string& folder);
  [[nodiscard]] Bytes operator[](std::uint32_t i) const { return bytes_[i]; }
  [[nodiscard]] std::uint64_t external_bytes() const { return external_bytes_; }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }

 private:
  std::vector<Bytes> bytes_;
  std::vector<std::vector<std::uint8_t>> decoded_;
  std::vector<Block> files_;
  std::uint64_t external_bytes_ = 0;
};

}  // namespace scenegen::gltf::reading
