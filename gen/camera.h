// A camera that shows the whole of a scene.
#pragma once

#include "scene/scene.h"

namespace scenegen::gen {

/// Looks at the middle of `bounds_m` from the given azimuth (0: from +z, towards +x when positive) and
/// elevation, each as a slope tan(angle); vertical field of view 0.6 rad, as near as an aspect of 16:9
/// allows.
[[nodiscard]] Camera framing_camera(const Box& bounds_m, float azimuth_slope, float elevation_slope);

}  // namespace scenegen::gen
