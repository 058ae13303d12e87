#include "scene/gltf/write.h"

#include "scene/gltf/write_check.h"
#include "scene/gltf/write_content.h"
#include "scene/gltf/write_document.h"

namespace scenegen::gltf {

Result<WriteReport> write(const Scene& scene, const std::string& path, const WriteOptions& options) {
  const Result<FileForm> form = form_of(path);
  if (!form) return tl::unexpected<Error>(form.error());
  if (Result<void> writable = check_writable(scene); !writable) return forward_error(writable);
  return write_content(Document(scene, options), *form, path, binary_path(path));
}

Result<WriteReport> predict(const Scene& scene, const std::string& path, const WriteOptions& options) {
  const Result<FileForm> form = form_of(path);
  if (!form) return tl::unexpected<Error>(form.error());
  if (Result<void> writable = check_writable(scene); !writable) return forward_error(writable);
  return predict_content(Document(scene, options), *form, path, binary_path(path));
}

}  // namespace scenegen::gltf
