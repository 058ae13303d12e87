// The devices of a benchmark.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/renderer.h"
#include "tools/bench_run.h"

namespace scenegen::tools {

struct BenchDevice {
  std::string label;  ///< tells it from the others: its name, or what was wanted when there is none
  std::shared_ptr<render::vkr::Device> device;  ///< null: `error` says why
  render::DeviceInfo info;
  std::optional<render::model::UnitCosts> costs;  ///< the same for all ways, so that they are comparable
  std::optional<Error> error;
};

/// Opens all that were asked for and sets their costs, once each. An error when none can be used.
[[nodiscard]] Result<std::vector<BenchDevice>> open_devices(const BenchRequest& request);
/// "devices" of bench.json.
[[nodiscard]] nlohmann::ordered_json devices_json(const std::vector<BenchDevice>& devices);

}  // namespace scenegen::tools
