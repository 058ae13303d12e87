// Camera paths that are made from a scene, so that any scene can be measured without a file:
// docs/CAMERA_PATH.md.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "render/camera_path.h"
#include "scene/scene.h"

namespace scenegen::render {

/// "fixed", "orbit", "walk", "fly", "cuts".
[[nodiscard]] std::span<const std::string_view> scripted_path_names();

/// Length of a path for a scene that does not change, seconds.
constexpr double kStillPathS = 10.0;

/// From time 0 to `duration_s` (kStillPathS when that is 0). `object_bounds_m`: boxes of all objects; empty
/// ones count for nothing. Made of sums, products and square roots, and rounded to a millimetre (less
/// for scenes below a metre): the same path on every machine. None for a name that is not one of the above.
[[nodiscard]] std::optional<CameraPath> scripted_path(std::string_view name,
                                                      std::span<const Box> object_bounds_m,
                                                      double duration_s);

}  // namespace scenegen::render
