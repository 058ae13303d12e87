// A document's text and bytes, put into a .glb, or a .gltf and its .bin, complete or not at all.
#pragma once

#include <string>
#include <string_view>

#include "scene/gltf/write.h"
#include "scene/gltf/write_sink.h"

namespace scenegen::gltf {

/// What goes into a file.
class FileContent {
 public:
  virtual ~FileContent() = default;
  /// The JSON text; `buffer_uri` empty for a .glb. The same at every call.
  virtual void emit_json(std::string_view buffer_uri, ByteSink& sink) const = 0;
  /// Bytes of the .glb's chunk or of the .bin; a multiple of 4.
  [[nodiscard]] virtual std::uint64_t buffer_bytes() const = 0;
  virtual void emit_buffer(ByteSink& sink) const = 0;
  /// Everything but the byte counts.
  [[nodiscard]] virtual WriteReport report() const = 0;
};

enum class FileForm : std::uint8_t { glb, gltf };
/// By the name's end; "-" and devices are .glb.
[[nodiscard]] Result<FileForm> form_of(const std::string& path);

/// The .bin beside a .gltf.
[[nodiscard]] std::string binary_path(const std::string& path);
/// RFC 3986: everything but unreserved characters is percent-encoded; '/' stays.
[[nodiscard]] std::string percent_encoded(std::string_view path);

/// Whether a buffer of this size fits into a .glb at all.
[[nodiscard]] Result<void> check_glb_buffer(const std::string& path, std::uint64_t bytes);

/// `binary` is used by .gltf only. `later`: as in WriteOptions.
[[nodiscard]] Result<WriteReport> write_content(const FileContent& content, FileForm form,
                                                const std::string& path, const std::string& binary,
                                                std::vector<OutputFile>* later);
/// The size that write_content would produce.
[[nodiscard]] Result<WriteReport> predict_content(const FileContent& content, FileForm form,
                                                  const std::string& path, const std::string& binary);

}  // namespace scenegen::gltf
