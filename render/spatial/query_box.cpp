#include "render/spatial/query_box.h"

#include <algorithm>
#include <cmath>

namespace scenegen::render {

QueryBoxes::QueryBoxes(const View& view, glm::uvec2 size)
    : eye_m_(view.eye_m()),
      forward_(view.forward()),
      orthographic_(view.lens.orthographic),
      near_m_(view.lens.near_m) {
  // Half the picture's width and height at 1 m, or at any distance.
  const float half_x = 1.0F / std::abs(view.clip_from_camera[0][0]);
  const float half_y = 1.0F / std::abs(view.clip_from_camera[1][1]);
  pixel_ = 2.0F * std::max(half_x / static_cast<float>(size.x), half_y / static_cast<float>(size.y));
  const float reach = orthographic_ ? 1.0F : near_m_;
  near_box_m_.add(eye_m_);
  for (const float x : {-half_x * reach, half_x * reach}) {
    for (const float y : {-half_y * reach, half_y * reach})
      near_box_m_.add(glm::vec3(view.world_from_camera * glm::vec4(x, y, -near_m_, 1.0F)));
  }
  // Rounding of the corners themselves.
  const glm::vec3 size_m = near_box_m_.size();
  const float slack = 1e-3F * std::max({size_m.x, size_m.y, size_m.z}) +
                      1e-6F * std::max({std::abs(eye_m_.x), std::abs(eye_m_.y), std::abs(eye_m_.z)});
  near_box_m_.lo -= slack;
  near_box_m_.hi += slack;
}

Box QueryBoxes::grown(const Box& box) const {
  float by = pixel_;
  if (!orthographic_) {
    const glm::vec3 from_eye = box.centre() - eye_m_;
    const float farthest = glm::dot(from_eye, forward_) + glm::dot(0.5F * box.size(), glm::abs(forward_));
    by *= std::max(farthest, near_m_);
  }
  return {box.lo - by, box.hi + by};
}

bool QueryBoxes::touches_eye(const Box& grown) const {
  return glm::all(glm::lessThanEqual(grown.lo, near_box_m_.hi)) &&
         glm::all(glm::greaterThanEqual(grown.hi, near_box_m_.lo));
}

}  // namespace scenegen::render
