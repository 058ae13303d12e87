// --camera-path: a file as in docs/CAMERA_PATH.md, or the name of a path that is made from the scene.
#pragma once

#include <string>

#include "render/camera_path.h"
#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::tools {

/// "a file, or fixed, orbit, …": for the help.
[[nodiscard]] std::string camera_path_range();
/// Whether there is such a path, before any scene is read. The error's `where` is the option or the file.
[[nodiscard]] Result<void> check_camera_path(const std::string& wanted);
[[nodiscard]] Result<render::CameraPath> camera_path_of(const std::string& wanted, const Scene& scene);

}  // namespace scenegen::tools
