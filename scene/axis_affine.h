// Meshes that are the same shape, stretched along their axes and shifted: bricks and beams of many lengths.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "scene/scene.h"

namespace scenegen {

/// p -> scale * p + offset_m.
struct AxisAffine {
  glm::vec3 scale{1.0F};
  glm::vec3 offset_m{0.0F};
  [[nodiscard]] glm::mat4 matrix() const;
};

/// What makes the box of `mesh_a` that of `mesh_b`; none if only one of them is flat along an axis, or empty.
[[nodiscard]] std::optional<AxisAffine> box_affine(const Scene& a, const Mesh& mesh_a, const Scene& b,
                                                   const Mesh& mesh_b);

/// What makes mesh `mesh_a` of `a` look like `mesh_b` of `b`: positions agree within 10^-6 of the extent,
/// normals and tangents would still be right, all else is the same bits. Materials are not looked at. None:
/// another shape, or (nearly) the same size and place.
[[nodiscard]] std::optional<AxisAffine> axis_affine(const Scene& a, const Mesh& mesh_a, const Scene& b,
                                                    const Mesh& mesh_b);

}  // namespace scenegen
