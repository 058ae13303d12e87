// Camera paths: docs/CAMERA_PATH.md describes the file.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "render/view.h"
#include "scene/result.h"

namespace scenegen::render {

struct CameraKey {
  double time_s = 0;
  glm::dvec3 eye_m{0.0};
  glm::dvec3 target_m{0.0};
  double yfov_rad = 0.6;
};

enum class PathInterpolation : std::uint8_t {
  linear,
  catmull_rom,
  step  ///< each key holds until the next: cuts
};

/// At least one key, times strictly increasing.
struct CameraPath {
  PathInterpolation interpolation = PathInterpolation::catmull_rom;
  double near_m = 0.05;
  std::vector<CameraKey> keys;

  /// Before the first key the first, after the last the last.
  [[nodiscard]] CameraKey at(double time_s) const;
  [[nodiscard]] View view(double time_s, float aspect) const;
};

/// What parse_camera_path() reads back, a line a key; ends with a newline.
[[nodiscard]] std::string camera_path_json(const CameraPath& path);

/// `name` is the file's, for errors, which point to the JSON value.
[[nodiscard]] Result<CameraPath> parse_camera_path(std::string_view json, const std::string& name);

}  // namespace scenegen::render
