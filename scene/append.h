// Joining scenes: one scene's resources and objects into another.
#pragma once

#include <string_view>

#include "scene/scene.h"

namespace scenegen {

/// What append_resources() put where: mesh m of the source is mesh first_mesh + m.
struct Appended {
  std::uint32_t first_mesh = 0;
};

/// Copies geometries, images, textures, materials and meshes of `from` behind those of `into`, ids remapped.
/// Tracks, cameras, frames and objects are not copied.
Appended append_resources(Scene& into, const Scene& from);

/// Adds every object of `from` at rest, `world_from_scene` applied, named `prefix` + its own name. Frames are
/// flattened into the object's own transform; where shear makes that impossible the object gets a frame that
/// holds the matrix. Names must turn out unique: the caller chooses the prefix.
void append_objects(Scene& into, const Scene& from, Appended resources, const Transform& world_from_scene,
                    std::string_view prefix);

}  // namespace scenegen
