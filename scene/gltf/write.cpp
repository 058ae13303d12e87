#include "scene/gltf/write.h"

#include "scene/gltf/write_check.h"
#include "scene/gltf/write_content.h"
#include "scene/gltf/write_document.h"

namespace scenegen::gltf {

namespace {

/// What can be refused without a look at the vertices is refused first.
Result<void> prepare(Document& document, const std::string& path, FileForm form) {
  if (form == FileForm::glb) {
    if (Result<void> size = check_glb_buffer(path, document.buffer_bytes()); !size) return size;
  }
  return document.measure();
}

}  // namespace

Result<WriteReport> write(const Scene& scene, const std::string& path, const WriteOptions& options) {
  const Result<FileForm> form = form_of(path);
  if (!form) return tl::unexpected<Error>(form.error());
  if (Result<void> writable = check_writable(scene); !writable) return forward_error(writable);
  Document document(scene, options);
  if (Result<void> fits = prepare(document, path, *form); !fits) return forward_error(fits);
  return write_content(document, *form, path, binary_path(path), options.later);
}

Result<WriteReport> predict(const Scene& scene, const std::string& path, const WriteOptions& options) {
  const Result<FileForm> form = form_of(path);
  if (!form) return tl::unexpected<Error>(form.error());
  if (Result<void> writable = check_writable(scene); !writable) return forward_error(writable);
  Document document(scene, options);
  if (Result<void> fits = prepare(document, path, *form); !fits) return forward_error(fits);
  return predict_content(document, *form, path, binary_path(path));
}

}  // namespace scenegen::gltf
