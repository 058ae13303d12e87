// The same scene with less: nothing that is seen at any time changes (timeline::compare finds no difference).
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace scenegen {

/// How many of each kind of thing a scene holds.
struct ContentCounts {
  std::uint64_t meshes = 0, geometries = 0, materials = 0, textures = 0, images = 0, frames = 0, tracks = 0,
                keys = 0;
};
[[nodiscard]] ContentCounts count_content(const Scene& scene);

struct OptimizeReport {
  ContentCounts before, after;
  std::uint64_t equal_images = 0, equal_textures = 0, equal_materials = 0, equal_geometries = 0,
                equal_meshes = 0;       ///< joined with an equal one; names do not count
  std::uint64_t stretched_meshes = 0;   ///< joined with one of the same shape (scene/axis_affine.h)
  std::uint64_t stretched_objects = 0;  ///< that show them, their scale adjusted
  std::uint64_t equal_tracks = 0;       ///< joined with an equal one
  std::uint64_t constant_tracks = 0;    ///< that changed nothing: their value is now at rest
  std::uint64_t idle_keys = 0;          ///< keys left out because nothing changes at them
  std::uint64_t unframed_objects = 0;   ///< taken out of frames that never move
};

/// Joins what is equal, leaves out what is not used or changes nothing, and takes objects out of frames that
/// never move, so that more objects share a mesh and a track. Objects keep their order, names and
/// visibility; cameras and moving frames stay. Single-precision rounding of placements apart (some units in
/// the last place), the scene is the same. The scene must pass validate(). Deterministic; O(size of the
/// scene).
OptimizeReport optimize(Scene& scene);

}  // namespace scenegen
