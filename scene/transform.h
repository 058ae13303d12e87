// Rigid + scale transforms and boxes. Metres, right-handed, Y up.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

namespace scenegen {

/// Translation * rotation * scale, as a glTF node has it; 40 bytes.
struct Transform {
  glm::vec3 translation_m{0.0F};
  glm::quat rotation{1.0F, 0.0F, 0.0F,
                     0.0F};  ///< unit quaternion; GLM stores x, y, z, w and constructs w, x, y, z
  glm::vec3 scale{1.0F};

  [[nodiscard]] glm::mat4 matrix() const;
  friend bool operator==(const Transform&, const Transform&) = default;
};

/// The TRS whose matrix() equals `m` within `tolerance` (relative to its largest element), if there is one:
/// false for a matrix with shear or perspective. Negative determinants come back as a negative x scale.
bool decompose(const glm::mat4& m, Transform& out, float tolerance = 1e-5F);

/// Axis-aligned box; empty when lo > hi.
struct Box {
  glm::vec3 lo{std::numeric_limits<float>::infinity()};
  glm::vec3 hi{-std::numeric_limits<float>::infinity()};

  [[nodiscard]] bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
  [[nodiscard]] glm::vec3 centre() const { return 0.5F * (lo + hi); }
  [[nodiscard]] glm::vec3 size() const { return hi - lo; }
  void add(const glm::vec3& p) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  void add(const Box& b) {
    lo = glm::min(lo, b.lo);
    hi = glm::max(hi, b.hi);
  }
  friend bool operator==(const Box&, const Box&) = default;
};

/// The box round `m` applied to `b` (Arvo 1990, "Transforming axis-aligned bounding boxes").
Box transformed(const Box& b, const glm::mat4& m);

/// Authors think Z up, files and program are Y up: (x, y, z) -> (x, z, -y). Convert once, at the boundary.
inline glm::vec3 y_up_from_z_up(const glm::vec3& p) {
  return {p.x, p.z, -p.y};
}
inline glm::vec3 z_up_from_y_up(const glm::vec3& p) {
  return {p.x, -p.z, p.y};
}

}  // namespace scenegen
