// What `scenegen` does for one request: parameters -> scene -> appearance times -> file.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gen/generate.h"
#include "scene/gltf/write.h"
#include "scene/result.h"
#include "timeline/appearance.h"
#include "tools/scenegen_options.h"

namespace scenegen::tools {

/// What was made, or would be.
struct Made {
  gen::Prediction counts;
  gltf::WriteReport file;
  std::optional<AppearanceInfo> appearance;
  std::vector<std::string> notes;
  std::vector<gltf::OutputFile> files;  ///< complete, not yet in their places
  double seconds = 0;

  [[nodiscard]] std::uint64_t moments() const { return appearance ? appearance->moments : 0; }
};

/// Makes the scene and writes it beside the request's output (the caller puts `files` there), or only
/// measures it (--dry-run). `arguments` are kept in the file. Errors: what the parameters cannot be, too
/// little memory, a file that cannot be written.
[[nodiscard]] Result<Made> make_scene(const GenerateRequest& request,
                                      const std::vector<std::string>& arguments);

}  // namespace scenegen::tools
