// Does what was found out in one frame say something about another?
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "render/draw_scene.h"
#include "render/view.h"

namespace scenegen::render {

/// What a frame looks at.
struct Picture {
  glm::vec3 eye_m{0}, forward{0};
  double visible = 0;  ///< objects, by timeline
};

[[nodiscard]] inline Picture picture_of(const View& view, const DrawScene& scene) {
  return {view.eye_m(), view.forward(), static_cast<double>(scene.visible_object_count())};
}

/// Not after a seek (a quarter of the objects came or went) or a cut (the eye jumped by more than a twentieth
/// of the scene's diagonal, or turned by more than 25 degrees).
[[nodiscard]] inline bool alike(const Picture& a, const Picture& b, const Box& scene_m) {
  const double most = std::max(a.visible, b.visible);
  return std::abs(a.visible - b.visible) <= 0.25 * most && glm::dot(a.forward, b.forward) > 0.9F &&
         glm::distance(a.eye_m, b.eye_m) <= 0.05F * glm::length(scene_m.size());
}

}  // namespace scenegen::render
