#include "tools/read_gltf.h"

#include <algorithm>
#include <filesystem>

#include "scene/import/import.h"

namespace scenegen::tools {

Result<gltf::ReadResult> read_gltf(const std::string& path, const gltf::ReadOptions& options) {
  auto read = gltf::read(path, options);
  if (read || read.error().kind != ErrorKind::bad_input || import::is_gltf(path)) return read;
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  const std::vector<std::string> known = import::model_extensions();
  if (extension.empty() || !std::binary_search(known.begin(), known.end(), extension.substr(1))) return read;
  return fail(
      ErrorKind::bad_input, path,
      "is no glTF, and only that is read here; scenegen animate and scenegen schedule make a .glb of '" +
          extension + "'");
}

}  // namespace scenegen::tools
