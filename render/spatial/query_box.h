// The box that an occlusion query asks about.
#pragma once

#include "render/view.h"

namespace scenegen::render {

/// How boxes are grown before they are asked about, for one view and size of picture.
class QueryBoxes {
 public:
  QueryBoxes(const View& view, glm::uvec2 size);

  /// `box` grown by a pixel at its farthest corner: whatever pixel something inside it covers, the grown box
  /// covers with a nearer depth, however the device rounds.
  [[nodiscard]] Box grown(const Box& box) const;
  /// Could the near plane cut the box open? Then it cannot be asked about: it has to be drawn.
  [[nodiscard]] bool touches_eye(const Box& grown) const;

 private:
  glm::vec3 eye_m_;
  glm::vec3 forward_;
  float pixel_ = 0;  // side of a pixel: at 1 m (perspective) or anywhere (orthographic), m
  bool orthographic_ = false;
  float near_m_ = 0;
  Box near_box_m_;  // round the eye and the near plane's corners
};

}  // namespace scenegen::render
