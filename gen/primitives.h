// Shapes that generated scenes are made of. Y up, centred on the origin.
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace scenegen::gen {

/// Where the faces of a unit box lie in the brick texture (textures.h): long sides (+-z), ends (+-x), beds
/// (+-y).
struct AtlasRegion {
  glm::vec2 lo, hi;
};
constexpr AtlasRegion kLongSide{{0.0F, 0.0F}, {0.5F, 0.5F}};
constexpr AtlasRegion kEnd{{0.5F, 0.0F}, {0.75F, 0.5F}};
constexpr AtlasRegion kBed{{0.0F, 0.5F}, {0.5F, 1.0F}};

/// Box of side 1, 24 vertices indexed, with normals, tangents and atlas coordinates.
[[nodiscard]] Geometry unit_box();
/// The same as 36 vertices drawn in order; every face shows the whole texture when `whole_faces`.
[[nodiscard]] Geometry unit_box_unindexed(bool whole_faces);

/// unit_box() with a texture that repeats every `repeat_m` on each face once the box is scaled to `size_m`.
[[nodiscard]] Geometry tiled_unit_box(const glm::dvec3& size_m, double repeat_m);

/// Sphere of diameter 1 of `slices` meridians and `stacks` >= 2 bands, poles on y; 6 * slices * (stacks - 1)
/// vertices drawn in order, with normals and texture coordinates.
[[nodiscard]] Geometry uv_sphere(std::uint32_t slices, std::uint32_t stacks);

struct SineCosine {
  double sine = 0, cosine = 1;
};
/// Of `k / n` turns, by a power series: the same bits with every library and compiler. Error < 1e-15.
[[nodiscard]] SineCosine of_turn(std::uint64_t k, std::uint64_t n);

}  // namespace scenegen::gen
