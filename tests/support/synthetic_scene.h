// Scenes for tests: one that has a little of everything, and towns of any size.
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace scenegen::testing {

/// Everything a scene can hold: textures, blend, mask, unlit and glowing materials, a mesh of two primitives,
/// lines, shared geometry; visibility tracks (shared, equal, temporary, always off); frames (nested, with
/// matrix, moved by STEP, LINEAR and CUBICSPLINE); looks; material tracks; cameras; awkward names; a zero
/// scale.
[[nodiscard]] Scene everything_scene();

/// A town-like scene: `objects` boxes of few meshes, scales and rotations in a grid, names of about 30
/// characters, one visibility track for each of `moments` moments.
[[nodiscard]] Scene town_scene(std::uint32_t objects, std::uint32_t moments);

}  // namespace scenegen::testing
