// sceneplay calibrate: measures what drawing costs on a device, for the strategies that choose by it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "render/calibration/calibration_file.h"
#include "render/calibration/unit_names.h"
#include "tools/calibrations.h"
#include "tools/output.h"
#include "tools/sceneplay.h"
#include "tools/verb.h"

namespace scenegen::tools {
namespace {

struct CalibrateRequest {
  render::CalibrationOptions how;
  std::string output;
  bool show = false;
  Format format = Format::table;
  bool quiet = false;
};

/// "1.234 us" with three digits that count.
std::string duration_text(double seconds) {
  constexpr std::array<const char*, 5> kUnits{"s", "ms", "us", "ns", "ps"};
  std::size_t unit = 0;
  double value = seconds;
  for (; unit + 1 < kUnits.size() && value != 0.0 && std::abs(value) < 1.0; ++unit) value *= 1e3;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g %s", value, value == 0.0 ? "s" : kUnits[unit]);
  return text.data();
}

std::string number_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

bool holds(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool has_zero(const render::model::UnitCosts& costs, const render::UnitName& unit) {
  const auto zero = [](const render::model::Curve& curve) {
    return std::find(curve.y.begin(), curve.y.end(), 0.0) != curve.y.end();
  };
  if (unit.value != nullptr) return costs.*unit.value == 0.0;
  if (unit.curve != nullptr) return zero(costs.*unit.curve);
  return std::any_of((costs.*unit.curves).begin(), (costs.*unit.curves).end(), zero);
}

std::string table(const render::Calibration& c) {
  Table out({{"unit", "unit"}, {"symbol", "symbol"}, {"cost", "cost"}, {"what", "what"}});
  for (const render::UnitName& unit : render::unit_names()) {
    std::string what(unit.meaning);
    if (holds(c.not_measured, unit.name)) what += " (not measured: rough)";
    // Some point of it, which later fits may have lifted: then none of its rows is 0, and the first says it.
    const bool clamped = holds(c.clamped, unit.name);
    const bool any_zero = clamped && has_zero(c.costs, unit);
    bool said = false;
    const auto add = [&](double value, const std::string& cost, const std::string& more) {
      std::string note;
      if (clamped && (any_zero ? value == 0.0 : !said))
        note = any_zero ? " (came out below 0)" : " (a point came out below 0)";
      said = true;
      std::string text = what;
      text.append(more).append(note);
      out.row({std::string(unit.name), std::string(unit.symbol), cost, std::move(text)});
    };
    const auto points = [&](const render::model::Curve& curve, const std::string& more) {
      for (std::size_t i = 0; i < curve.x.size(); ++i)
        add(curve.y[i], unit.share ? number_text(curve.y[i]) : duration_text(curve.y[i]),
            ", " + more + number_text(curve.x[i]) + " " + std::string(unit.x));
    };
    if (unit.value != nullptr) {
      const double value = c.costs.*unit.value;
      add(value,
          unit.share   ? number_text(value)
          : unit.bytes ? number_text(value) + " B"
                       : duration_text(value),
          "");
    } else if (unit.curve != nullptr) {
      points(c.costs.*unit.curve, "");
    } else {
      for (std::size_t i = 0; i < render::model::kShadings; ++i)
        points((c.costs.*unit.curves)[i], std::string(render::kShadingNames[i]) + ", ");
    }
  }
  return out.str(Format::table);
}

Result<void> run(const CalibrateRequest& request) {
  render::CalibrationOptions how = request.how;
  auto device = render::share_device(how.device);
  if (!device) return forward_error(device);
  how.shared_device = std::move(*device);
  std::string path = request.output;  // it must be possible to write there before a minute is spent
  if (path.empty()) {
    Result<std::string> place = calibration_place(
        render::calibration_key(render::info_of(*how.shared_device), how.size, how.samples, how.shadows));
    if (!place) return forward_error(place);
    path = std::move(*place);
  } else if (Result<void> good = check_output_file(path); !good) {
    return good;
  }
  const Stopwatch watch;
  Result<render::Calibration> measured = [&] {
    Progress progress("calibrating", 100, request.quiet);
    int shown = 0;
    how.progress = [&](double share) {
      for (; shown < static_cast<int>(100.0 * share); ++shown) progress.advance();
    };
    return render::calibrate(how);
  }();
  if (!measured) return forward_error(measured);
  if (Result<void> written = write_file(path, render::calibration_json(*measured)); !written) return written;
  if (request.show) {
    if (Result<void> written = write_stdout(table(*measured)); !written) return written;
  }
  for (const std::string& name : measured->clamped)
    std::fprintf(stderr, "warning: %s came out below 0 (the machine is busy?) and was set to 0\n",
                 name.c_str());
  if (!request.quiet)
    std::fprintf(stderr, "%s  %s  %ux%u  %u samples  %.1f s\n", path.c_str(), measured->key.device.c_str(),
                 how.size.x, how.size.y, how.samples, watch.seconds());
  return {};
}

}  // namespace

int calibrate_verb(std::span<const std::string> arguments) {
  CalibrateRequest r;
  Options options("sceneplay calibrate", {"sceneplay calibrate [options]"},
                  "measures what drawing costs on a device, for strategies that choose by it.");
  options.group("Pictures that it is for");
  options.add("--size", size2_value(r.how.size, {16, 16}, {16384, 16384}, "WxH"), "pixels");
  options.add("--samples", choice_value<std::uint32_t>(r.how.samples, {{"1", 1}, {"4", 4}}, "N"),
              "samples a pixel");
  options.add("--shadows", on_off_value(r.how.shadows), "shadows of the sun");
  options.group("Measuring");
  options.flag("--quick", r.how.quick, "fewer sizes and frames");
  options.flag("--show", r.show, "print the units, with their symbols in the dissertation");
  options.add("-o,--output", text_value(r.output, "FILE"), "JSON file (docs/CALIBRATION.md)", Role::run,
              "in the user's cache, where sceneplay looks for it");
  options.group("Device");
  options.add("--device", text_value(r.how.device.wanted, "NAME|INDEX"), "Vulkan device", Role::run,
              "a discrete GPU, else any");
  options.group("General");
  options.add_general(r.quiet);
  return run_verb(options, arguments, {.work = [&]() -> Result<int> {
                    Result<void> done = run(r);
                    return done ? Result<int>(0) : forward_error(done);
                  }});
}

}  // namespace scenegen::tools
