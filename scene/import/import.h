// Models of other formats (FBX, OBJ, Collada, STL, 3MF, IFC, …) through Debian's Assimp.
#pragma once

#include <string>
#include <vector>

#include "scene/gltf/read.h"
#include "scene/result.h"

namespace scenegen::import {

enum class UpAxis : std::uint8_t { automatic, x, y, z };

struct ImportOptions {
  UpAxis up = UpAxis::automatic;  ///< automatic: what the file says, else what its format means
  double metres_per_unit = 0;     ///< 0: what the file says, else 1
};

/// True for .glb and .gltf, which need no import.
[[nodiscard]] bool is_gltf(const std::string& path);

/// Reads glTF natively and everything else through Assimp, which runs in a process of its own with bounds on
/// memory and time, so that a crash of it is an error here. The result always has `source`: for an imported
/// model the glTF document that it became (node hierarchy, names, `extras.guid`, materials, textures,
/// cameras). Errors as gltf::read; what Assimp says of the file, in one line.
[[nodiscard]] Result<gltf::ReadResult> read_model(const std::string& path, const ImportOptions& options = {});
/// Extensions that read_model takes, without the dot, ascending.
[[nodiscard]] std::vector<std::string> model_extensions();

}  // namespace scenegen::import
