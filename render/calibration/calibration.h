// Measuring what one unit of each stage costs on a device (D 2.5.4, 4.2).
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "render/device_options.h"
#include "render/model/unit_costs.h"
#include "scene/result.h"

namespace scenegen::render {

/// What unit costs hold for.
struct CalibrationKey {
  std::string device_uuid;  ///< 32 hexadecimal digits
  std::string device;       ///< its name, for people
  std::string driver;       ///< name and version
  glm::uvec2 size{0};
  std::uint32_t samples = 4;
  bool shadows = true;
  friend bool operator==(const CalibrationKey&, const CalibrationKey&) = default;
};
[[nodiscard]] CalibrationKey calibration_key(const DeviceInfo& device, glm::uvec2 size, std::uint32_t samples,
                                             bool shadows);

struct Calibration {
  CalibrationKey key;
  bool quick = false;
  model::UnitCosts costs;
  std::vector<std::string> not_measured;  ///< names of units that are rough_costs()
  std::vector<std::string>
      clamped;  ///< units whose measured value was negative, set to 0 (or curves of them)
};

struct CalibrationOptions {
  DeviceOptions device;
  std::shared_ptr<vkr::Device> shared_device;  ///< used in place of opening one for `device`
  glm::uvec2 size{1280, 720};
  std::uint32_t samples = 4;
  bool shadows = true;
  bool quick = false;   ///< fewer sizes and frames: at most about 10 s
  double budget_s = 0;  ///< about how long; 0: 75 s on a software device, 11 s on others, 8 s when quick
  /// Called now and then from the same thread with the share that is done.
  std::function<void(double)> progress;
};

/// Draws test scenes with the strategies themselves and takes costs from how times grow with their sizes.
/// Errors: those of Renderer::create().
[[nodiscard]] Result<Calibration> calibrate(const CalibrationOptions& options);

}  // namespace scenegen::render
