#include "tools/bench_devices.h"

#include <algorithm>

#include "render/strategy_names.h"
#include "tools/calibrations.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

BenchDevice open(const BenchRequest& request, const std::string& wanted) {
  BenchDevice out;
  out.label = wanted;
  render::RendererOptions options = request.drawing.renderer();
  options.device.wanted = wanted;
  auto device = render::share_device(options.device);
  if (!device) {
    out.error = device.error();
    return out;
  }
  out.info = render::info_of(**device);
  out.label = out.info.name;
  options.shared_device = *device;
  const auto chooses = std::find_if(request.ways.begin(), request.ways.end(), [](const BenchWay& way) {
    return render::strategy_traits(way.strategy).uses_costs;
  });
  if (chooses != request.ways.end()) options.strategy = chooses->strategy;
  if (auto set = set_costs(options, request.drawing.calibration, request.quiet); !set) {
    out.error = set.error();
    return out;
  }
  out.costs = std::move(options.costs);
  out.device = std::move(*device);
  return out;
}

}  // namespace

Result<std::vector<BenchDevice>> open_devices(const BenchRequest& request) {
  std::vector<BenchDevice> out;
  const std::vector<std::string> wanted =
      request.devices.empty() ? std::vector<std::string>{""} : request.devices;
  for (const std::string& name : wanted) {
    BenchDevice device = open(request, name);
    // Two cards of a kind, or one named twice (which shows the noise), are cases of their own.
    const std::string label = device.label;
    for (int i = 2; std::any_of(out.begin(), out.end(),
                                [&](const BenchDevice& other) { return other.label == device.label; });
         ++i)
      device.label = label + " #" + std::to_string(i);
    out.push_back(std::move(device));
  }
  const bool some =
      std::any_of(out.begin(), out.end(), [](const BenchDevice& d) { return d.device != nullptr; });
  if (!some) return tl::unexpected<Error>(*out.front().error);
  return out;
}

ordered_json devices_json(const std::vector<BenchDevice>& devices) {
  ordered_json out = ordered_json::array();
  for (const BenchDevice& d : devices) {
    if (d.error) {
      out.push_back({{"name", d.label}, {"error", d.error->str()}});
    } else {
      out.push_back(
          {{"name", d.label}, {"type", d.info.type}, {"driver", d.info.driver}, {"uuid", d.info.uuid}});
    }
  }
  return out;
}

}  // namespace scenegen::tools
