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

  // The nearest eye on the line through the centre that has all eight corners in view.
  const glm::dvec3 lo(bounds_m.lo), hi(bounds_m.hi), centre = (lo + hi) * 0.5;
  double distance = 0.1, radius = 0;
  for (int k = 0; k < 8; ++k) {
    const glm::dvec3 corner((k & 1) != 0 ? hi.x : lo.x, (k & 2) != 0 ? hi.y : lo.y,
                            (k & 4) != 0 ? hi.z : lo.z);
    const glm::dvec3 d = corner - centre;
    const double depth = glm::dot(d, back);
    distance = std::max(distance, depth + std::abs(glm::dot(d, up)) * kBorder / kTanHalfFov);
    distance = std::max(distance, depth + std::abs(glm::dot(d, right)) * kBorder / (kTanHalfFov * kAspect));
    radius = std::max(radius, glm::length(d));
  }

  Camera camera;
  camera.name = "camera";
  camera.yfov_rad = 0.6F;
  camera.frame_from_camera.translation_m = glm::vec3(centre + back * distance);
  camera.frame_from_camera.rotation = glm::normalize(glm::quat_cast(glm::mat3(right, up, back)));
  camera.znear_m = static_cast<float>(std::max(0.05, (distance - radius) * 0.25));
  camera.zfar_m = static_cast<float>((distance + radius) * 4.0);
  return camera;
}

}  // namespace scenegen::gen
