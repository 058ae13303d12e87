// What all draws of a frame share: the view, and the light of every picture.
#pragma once

#include "render/shaders/shared_types.h"
#include "render/view.h"

namespace scenegen::render {

/// `scene_m`: what shadows must reach.
[[nodiscard]] CameraBlock camera_block(const View& view, const Box& scene_m);

}  // namespace scenegen::render
