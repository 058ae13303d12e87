#include "scene/axis_affine.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace scenegen {

namespace {

constexpr float kTolerance = 1e-6F;  // some units in the last place of float32

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_but_positions(const Geometry& a, const Geometry& b) {
  return a.topology == b.topology && a.positions_m.size() == b.positions_m.size() &&
         same_bits(a.indices, b.indices) && same_bits(a.normals, b.normals) &&
         same_bits(a.tangents, b.tangents) && same_bits(a.texcoords[0], b.texcoords[0]) &&
         same_bits(a.texcoords[1], b.texcoords[1]) && same_bits(a.colors, b.colors);
}

Box bounds_of(const Scene& scene, const Mesh& mesh) {
  Box box;
  for (const Primitive& p : mesh.primitives) box.add(scene.geometries[p.geometry.value].bounds());
  return box;
}

/// Whether stretching by `scale` leaves the direction of `d` as it is.
bool keeps_direction(const glm::dvec3& d, const glm::dvec3& scale) {
  const double length = glm::length(d);
  if (length == 0.0) return true;
  const glm::dvec3 stretched = d * scale;
  return glm::length(stretched / glm::length(stretched) - d / length) <= static_cast<double>(kTolerance);
}

bool keeps_directions(const Geometry& g, const glm::dvec3& scale) {
  return std::all_of(g.normals.begin(), g.normals.end(),
                     [&](const glm::vec3& n) { return keeps_direction(n, 1.0 / scale); }) &&
         std::all_of(g.tangents.begin(), g.tangents.end(),
                     [&](const glm::vec4& t) { return keeps_direction(glm::vec3(t), scale); });
}

bool lands_on(const Geometry& a, const Geometry& b, const AxisAffine& affine, float tolerance_m) {
  for (std::size_t i = 0; i < a.positions_m.size(); ++i) {
    const glm::vec3 d = glm::abs(affine.scale * a.positions_m[i] + affine.offset_m - b.positions_m[i]);
    if (!(std::max({d.x, d.y, d.z}) <= tolerance_m)) return false;
  }
  return true;
}

}  // namespace

glm::mat4 AxisAffine::matrix() const {
  glm::mat4 m(1.0F);
  for (int axis = 0; axis < 3; ++axis) m[axis][axis] = scale[axis];
  m[3] = glm::vec4(offset_m, 1.0F);
  return m;
}

std::optional<AxisAffine> box_affine(const Scene& a, const Mesh& mesh_a, const Scene& b, const Mesh& mesh_b) {
  const Box box_a = bounds_of(a, mesh_a), box_b = bounds_of(b, mesh_b);
  if (box_a.empty() || box_b.empty()) return std::nullopt;
  const glm::dvec3 size_a = glm::dvec3(box_a.hi) - glm::dvec3(box_a.lo);
  const glm::dvec3 size_b = glm::dvec3(box_b.hi) - glm::dvec3(box_b.lo);
  glm::dvec3 scale(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    if ((size_a[axis] > 0) != (size_b[axis] > 0)) return std::nullopt;
    if (size_a[axis] > 0) scale[axis] = size_b[axis] / size_a[axis];
  }
  const AxisAffine out{glm::vec3(scale), glm::vec3(glm::dvec3(box_b.lo) - scale * glm::dvec3(box_a.lo))};
  if (!(glm::length(out.scale) < 1e30F) || glm::any(glm::lessThan(out.scale, glm::vec3(1e-30F))))
    return std::nullopt;
  return out;
}

namespace {

/// Vertices that were moved by a hair are no stretching: compare() would take the hair for a placement's
/// rounding.
bool next_to_nothing(const AxisAffine& affine, const glm::vec3& size_m) {
  constexpr float kHair = 1e-3F;
  const float longest_m = std::max({size_m.x, size_m.y, size_m.z});
  return glm::all(glm::lessThan(glm::abs(affine.scale - 1.0F), glm::vec3(kHair))) &&
         glm::all(glm::lessThan(glm::abs(affine.offset_m), glm::vec3(kHair * longest_m)));
}

}  // namespace

std::optional<AxisAffine> axis_affine(const Scene& a, const Mesh& mesh_a, const Scene& b,
                                      const Mesh& mesh_b) {
  if (mesh_a.primitives.size() != mesh_b.primitives.size() || mesh_a.primitives.empty()) return std::nullopt;
  const auto of_a = [&](std::size_t i) -> const Geometry& {
    return a.geometries[mesh_a.primitives[i].geometry.value];
  };
  const auto of_b = [&](std::size_t i) -> const Geometry& {
    return b.geometries[mesh_b.primitives[i].geometry.value];
  };
  for (std::size_t i = 0; i < mesh_a.primitives.size(); ++i) {
    if (!same_but_positions(of_a(i), of_b(i))) return std::nullopt;
  }
  const std::optional<AxisAffine> out = box_affine(a, mesh_a, b, mesh_b);
  if (!out) return std::nullopt;
  const glm::vec3 size_b = bounds_of(b, mesh_b).size();
  if (next_to_nothing(*out, size_b)) return std::nullopt;
  const float tolerance_m = kTolerance * std::max({size_b.x, size_b.y, size_b.z});
  for (std::size_t i = 0; i < mesh_a.primitives.size(); ++i) {
    if (!lands_on(of_a(i), of_b(i), *out, tolerance_m) || !keeps_directions(of_a(i), glm::dvec3(out->scale)))
      return std::nullopt;
  }
  return out;
}

}  // namespace scenegen
