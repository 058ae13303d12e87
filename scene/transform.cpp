#include "scene/transform.h"

#include <cmath>

namespace scenegen {

glm::mat4 Transform::matrix() const {
  glm::mat4 m = glm::mat4_cast(rotation);
  m[0] *= scale.x;
  m[1] *= scale.y;
  m[2] *= scale.z;
  m[3] = glm::vec4(translation_m, 1.0F);
  return m;
}

bool decompose(const glm::mat4& m, Transform& out, float tolerance) {
  if (m[0][3] != 0.0F || m[1][3] != 0.0F || m[2][3] != 0.0F || m[3][3] != 1.0F) return false;
  glm::mat3 basis(m);
  glm::vec3 scale(glm::length(basis[0]), glm::length(basis[1]), glm::length(basis[2]));
  if (glm::determinant(basis) < 0.0F) scale.x = -scale.x;
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(scale[i]) || scale[i] == 0.0F) return false;
    basis[i] /= scale[i];
  }
  out.translation_m = glm::vec3(m[3]);
  out.rotation = glm::normalize(glm::quat_cast(basis));
  out.scale = scale;

  const glm::mat4 again = out.matrix();
  const float largest = glm::max(glm::max(std::abs(scale.x), std::abs(scale.y)), std::abs(scale.z));
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) {
      if (!(std::abs(again[c][r] - m[c][r]) <= tolerance * largest)) return false;
    }
  }
  return true;
}

Box transformed(const Box& b, const glm::mat4& m) {
  if (b.empty()) return b;
  Box out{glm::vec3(m[3]), glm::vec3(m[3])};
  for (int c = 0; c < 3; ++c) {
    const glm::vec3 at_lo = glm::vec3(m[c]) * b.lo[c];
    const glm::vec3 at_hi = glm::vec3(m[c]) * b.hi[c];
    out.lo += glm::min(at_lo, at_hi);
    out.hi += glm::max(at_lo, at_hi);
  }
  return out;
}

}  // namespace scenegen
