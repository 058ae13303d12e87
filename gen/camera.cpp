#include "gen/camera.h"

#include <algorithm>
#include <cmath>

namespace scenegen::gen {

Camera framing_camera(const Box& bounds_m, float azimuth_slope, float elevation_slope) {
  constexpr double kTanHalfFov = 0.30933624960962325;  // tan(0.3)
  constexpr double kAspect = 16.0 / 9.0;
  constexpr double kBorder = 1.04;
  const glm::dvec3 back = glm::normalize(
      glm::dvec3(azimuth_slope, elevation_slope * std::sqrt(1.0 + azimuth_slope * azimuth_slope), 1.0));
  const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
  const glm::dvec3 up = glm::cross(back, right);

  // In camera axes a point p is in view when |p.y - eye.y| <= t (eye.z - p.z), likewise in x: each side of
  // the picture bounds the eye by its outermost corner, and opposite sides together give its place between
  // them.
  const glm::dvec3 lo(bounds_m.lo), hi(bounds_m.hi);
  const glm::dvec2 t(kTanHalfFov * kAspect / kBorder, kTanHalfFov / kBorder);
  glm::dvec2 above(-1e300), below(-1e300);
  for (int k = 0; k < 8; ++k) {
    const glm::dvec3 corner((k & 1) != 0 ? hi.x : lo.x, (k & 2) != 0 ? hi.y : lo.y,
                            (k & 4) != 0 ? hi.z : lo.z);
    const glm::dvec2 p(glm::dot(corner, right), glm::dot(corner, up));
    const glm::dvec2 depth = t * glm::dot(corner, back);
    above = glm::max(above, p + depth);
    below = glm::max(below, depth - p);
  }
  const glm::dvec2 middle = (above - below) * 0.5;
  const glm::dvec2 reach = (above + below) * 0.5 / t;
  const glm::dvec3 eye = right * middle.x + up * middle.y + back * std::max(reach.x, reach.y);
  const double distance = glm::length(eye - (lo + hi) * 0.5), radius = glm::length(hi - lo) * 0.5;

  Camera camera;
  camera.name = "camera";
  camera.yfov_rad = 0.6F;
  camera.frame_from_camera.translation_m = glm::vec3(eye);
  camera.frame_from_camera.rotation = glm::normalize(glm::quat_cast(glm::mat3(right, up, back)));
  camera.znear_m = static_cast<float>(std::max(0.05, (distance - radius) * 0.25));
  camera.zfar_m = static_cast<float>((distance + radius) * 4.0);
  return camera;
}

}  // namespace scenegen::gen
