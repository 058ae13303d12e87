// Typed data out of buffers, every number checked before anything is read or allocated. Private to
// scene/gltf.
#pragma once

#include <vector>

#include "scene/gltf/container.h"

namespace scenegen::gltf::reading {

/// A sum that may not be exceeded: without it a short file that names one accessor a million times would fill
/// any memory.
class Budget {
 public:
  Budget(std::uint64_t most, const char* what) : left_(most), what_(what) {}
  void take(std::uint64_t amount, const Place& at) {
    if (amount > left_) reject(at, what_);
    left_ -= amount;
  }

 private:
  std::uint64_t left_;
  const char* what_;
};

class Data {
 public:
  Data(const Document& document, const Buffers& buffers, std::uint64_t input_bytes)
      : document_(document), buffers_(buffers), input_bytes_(input_bytes) {}

  [[nodiscard]] const Accessor& accessor(std::uint32_t index, const Place& at) const;
  /// The bytes of a buffer view.
  [[nodiscard]] Bytes view(std::uint32_t index, const Place& at) const;
  /// count * components floats, normalised integers mapped to [0, 1] or [-1, 1], all finite.
  [[nodiscard]] std::vector<float> floats(std::uint32_t index, std::uint32_t components, const Place& at);
  /// Unsigned integers of a SCALAR accessor.
  [[nodiscard]] std::vector<std::uint32_t> integers(std::uint32_t index, const Place& at);
  /// Bytes that decoding produces. Honest files need 1 to 8 for every byte of the file and its buffers (bytes
  /// to floats, buffers shared by several meshes).
  Budget& budget() { return budget_; }
  /// Triangles that Draco streams say they hold; each costs the decoder about 80 bytes. A regular grid,
  /// Draco's best case, takes some 0.5 bit a triangle; a bomb says 4 G of them in 30 bytes.
  Budget& draco_triangles() { return draco_triangles_; }
  [[nodiscard]] std::uint64_t input_bytes() const { return input_bytes_; }

 private:
  struct Elements {
    const std::uint8_t* bytes = nullptr;  ///< none: zeros
    std::uint64_t count = 0, stride = 0;
  };
  [[nodiscard]] Elements elements(const Accessor& accessor, const Place& at) const;
  template <class Read>
  void apply_sparse(const Accessor& accessor, const Place& at, const Read& read);

  const Document& document_;
  const Buffers& buffers_;
  std::uint64_t input_bytes_;
  Budget budget_{(64ULL << 20) + 64 * input_bytes_,
                 "the file unfolds to far more data than its size allows (64 MB + 64 bytes a byte)"};
  Budget draco_triangles_{
      (1ULL << 20) + 16 * input_bytes_,
      "the Draco streams say they hold more triangles than their size allows (2^20 + 16 a byte)"};
};

}  // namespace scenegen::gltf::reading
