// What is in a glTF document beside the scene that was read from it: for tools that write the scene anew.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/gltf/read.h"
#include "scene/result.h"

namespace scenegen::gltf {

struct Survey {
  std::uint64_t nodes = 0, channels = 0, accessors = 0, meshes = 0, materials = 0, textures = 0, images = 0;
  std::uint64_t draws = 0;  ///< primitives of the meshes of all nodes: draw calls of a viewer that shows all
  /// Used by the scene shown and not in a Scene: what a rewrite would lose. ReadResult::ignored without nodes
  /// and scenes that are not shown; `extras` of others.
  std::vector<Ignored> losses;
};

/// `read` must have been read with keep_source.
[[nodiscard]] Result<Survey> survey(const ReadResult& read);

}  // namespace scenegen::gltf
