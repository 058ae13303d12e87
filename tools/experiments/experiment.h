// The experiments of the papers, one file each: what `sceneplay experiment NAME` runs.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/renderer.h"
#include "scene/result.h"
#include "tools/output.h"
#include "tools/report/document.h"

namespace scenegen::tools {

/// What an experiment is given. It makes its scenes itself, from the generator, with `seed`.
struct ExperimentContext {
  std::string folder;                             ///< where its pictures go; exists
  std::shared_ptr<render::vkr::Device> device;    ///< null for those that do not draw
  render::DeviceInfo device_info;                 ///< of `device`
  std::optional<render::model::UnitCosts> costs;  ///< of `device`, when the experiment asked for them
  std::uint64_t seed = 0;
  bool quick = false;                                ///< fewer sizes and frames: minutes on a software device
  std::optional<std::uint32_t> repeat;               ///< else what suits the experiment
  std::uint32_t width = 0, height = 0, samples = 1;  ///< of pictures
  /// As --camera-path names them, for experiments that look from several; none: the experiment's own.
  std::vector<std::string> camera_paths;
  Progress* progress = nullptr;
};

struct Experiment {
  std::string_view name;     ///< "octree-or-bvh"
  std::string_view source;   ///< "D 5.2"
  std::string_view summary;  ///< one line of help
  bool draws = true;         ///< needs a Vulkan device
  bool uses_costs = false;   ///< needs calibrated unit costs
  Result<DocumentSection> (*run)(const ExperimentContext& context);
};

/// All of them, in the order of the paper.
[[nodiscard]] std::span<const Experiment> experiments();

}  // namespace scenegen::tools
