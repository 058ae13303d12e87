// sceneplay experiment NAME... -o DIR: repeats experiments of the papers.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "scene/limits.h"
#include "tools/bench_results.h"
#include "tools/calibrations.h"
#include "tools/camera_paths.h"
#include "tools/drawing_options.h"
#include "tools/experiments/run.h"
#include "tools/sceneplay.h"
#include "tools/verb.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

struct ExperimentRequest {
  std::vector<std::string> names;
  std::string folder;
  bool quick = false;
  std::uint64_t seed = 1;
  std::uint32_t repeat = 0;
  glm::uvec2 size{0};
  std::vector<std::string> camera_paths;
  DrawingOptions drawing;
  bool quiet = false;
  std::vector<std::string> arguments;
};

/// Runs what was asked for; what fails is said, and the rest goes on.
class Laboratory {
 public:
  Laboratory(const ExperimentRequest& request, std::vector<const Experiment*> chosen)
      : request_(request), chosen_(std::move(chosen)), progress_("experiment", 0, request.quiet) {}

  Result<int> run() {
    if (auto made = make_folder(request_.folder, "experiment.json"); !made) return forward_error(made);
    if (auto ready = set_up(); !ready) return forward_error(ready);
    int code = 0;
    for (const Experiment* experiment : chosen_) {
      auto section = run_one(*experiment);
      progress_.clear();
      if (!section) {
        const Error error{section.error().kind, std::string(experiment->name) + ": " + section.error().where,
                          section.error().what};
        const int failed = report_error(error);
        if (code == 0) code = failed;
        results_.failures.emplace_back(experiment->name, section.error());
      } else {
        results_.document.sections.push_back(std::move(*section));
      }
      // A disk that is full now may have room later, and what was found is on stdout too: the rest goes on.
      if (auto written = write(section.has_value()); !written) {
        const int failed = report_error(written.error());
        if (code == 0) code = failed;
      }
    }
    return code;
  }

 private:
  Result<void> set_up() {
    const auto draws = [](const Experiment* e) { return e->draws; };
    context_.folder = request_.folder;
    context_.seed = request_.seed;
    context_.quick = request_.quick;
    if (request_.repeat > 0) context_.repeat = request_.repeat;
    const glm::uvec2 usual = request_.quick ? glm::uvec2(320, 180) : glm::uvec2(1920, 1080);
    const glm::uvec2 size = request_.size.x > 0 ? request_.size : usual;
    context_.width = size.x;
    context_.height = size.y;
    context_.samples = request_.drawing.samples;
    context_.camera_paths = request_.camera_paths;
    context_.progress = &progress_;
    if (std::any_of(chosen_.begin(), chosen_.end(), draws)) {
      auto device = render::share_device(request_.drawing.renderer().device);
      if (device) {
        context_.device = *device;
        context_.device_info = render::info_of(**device);
      } else if (std::all_of(chosen_.begin(), chosen_.end(), draws)) {
        return forward_error(device);
      } else {
        no_device_ = device.error();  // those that need none can run
      }
    }
    results_.document = {"Experiments of the papers", facts(), {}};
    return {};
  }

  /// An experiment that runs out of memory or over a limit of the device is one that failed: the rest goes
  /// on.
  Result<DocumentSection> guarded_run(const Experiment& experiment) const {
    try {
      return experiment.run(context_);
    } catch (const std::bad_alloc&) {
      return fail(ErrorKind::bad_input, std::string(experiment.name), "out of memory");
    } catch (const std::runtime_error& error) {
      return fail(ErrorKind::no_device, std::string(experiment.name), error.what());
    }
  }

  Result<DocumentSection> run_one(const Experiment& experiment) {
    if (experiment.draws && !context_.device) return tl::unexpected<Error>(*no_device_);
    if (experiment.uses_costs && !context_.costs) {
      progress_.clear();
      render::RendererOptions options = request_.drawing.renderer();
      options.shared_device = context_.device;
      options.size = {context_.width, context_.height};
      options.shadows = false;
      options.strategy = "adaptive";
      if (auto set = set_costs(options, request_.drawing.calibration, request_.quiet); !set)
        return forward_error(set);
      context_.costs = std::move(options.costs);
    }
    progress_.stage(std::string(experiment.name));
    const Stopwatch watch;
    auto section = guarded_run(experiment);
    if (section) seconds_.emplace_back(experiment.name, watch.seconds());
    return section;
  }

  [[nodiscard]] std::vector<std::pair<std::string, std::string>> facts() const {
    const ordered_json machine = machine_json();
    const auto word = [](const ordered_json& v) { return v.is_string() ? v.get<std::string>() : v.dump(); };
    std::vector<std::pair<std::string, std::string>> out{{"program", "sceneplay " SCENEGEN_VERSION},
                                                         {"compiler", compiler()}};
    for (const auto& [key, value] : machine.items()) {
      if (key == "memoryBytes") {
        out.emplace_back("memory", human_bytes(value.get<std::uint64_t>()));
      } else if (key == "load" && value.is_number()) {
        out.emplace_back("load", human_real(value.get<double>(), 2));
      } else {
        out.emplace_back(key, word(value));
      }
    }
    if (context_.device) {
      out.emplace_back("device", context_.device_info.name);
      out.emplace_back("driver", context_.device_info.driver);
      out.emplace_back("pictures", std::to_string(context_.width) + "x" + std::to_string(context_.height) +
                                       ", " + counted(context_.samples, "sample"));
    }
    out.emplace_back("seed", std::to_string(context_.seed));
    out.emplace_back("arguments", join(request_.arguments, " "));
    return out;
  }

  /// All files anew, so that a run that is killed keeps what it had; the last section to stdout.
  Result<void> write(bool has_new) {
    ordered_json seconds = ordered_json::object();
    for (const auto& [name, s] : seconds_) seconds[name] = s;
    const ordered_json run{{"program", {{"version", SCENEGEN_VERSION}, {"compiler", compiler()}}},
                           {"machine", machine_json()},
                           {"device", context_.device ? ordered_json{{"name", context_.device_info.name},
                                                                     {"type", context_.device_info.type},
                                                                     {"driver", context_.device_info.driver}}
                                                      : ordered_json()},
                           {"seed", context_.seed},
                           {"quick", context_.quick},
                           {"size", {context_.width, context_.height}},
                           {"samples", context_.samples},
                           {"cameraPaths", context_.camera_paths},
                           {"arguments", request_.arguments},
                           {"seconds", seconds}};
    Result<void> files = write_files(pretty(experiment_json(run, results_)), has_new);
    if (!has_new || request_.quiet) return files;
    const bool first = results_.document.sections.size() == 1;
    auto told = write_stdout((first ? "" : "\n\n") + section_text(results_.document.sections.back()));
    return files ? told : files;
  }

  [[nodiscard]] Result<void> write_files(const std::string& json, bool tables) const {
    const std::filesystem::path folder(request_.folder);
    if (auto written = write_file((folder / "experiment.json").string(), json); !written) return written;
    if (!tables) return {};
    for (const auto& [name, text] : table_files(results_.document)) {
      if (auto written = write_file((folder / name).string(), text); !written) return written;
    }
    return {};
  }

  const ExperimentRequest& request_;
  std::vector<const Experiment*> chosen_;
  Progress progress_;
  ExperimentContext context_;
  std::optional<Error> no_device_;
  ExperimentResults results_;
  std::vector<std::pair<std::string, double>> seconds_;
};

}  // namespace

int experiment_verb(std::span<const std::string> arguments) {
  const auto given = [&](std::string_view word) {
    return std::find(arguments.begin(), arguments.end(), word) != arguments.end();
  };
  if (given("--list-devices")) return list_devices_verb();
  if (arguments.empty() || given("--list")) {
    const auto written = write_stdout(experiment_list());
    return written ? 0 : report_error(written.error());
  }
  ExperimentRequest r;
  r.arguments.assign(arguments.begin(), arguments.end());
  bool list = false;
  Options options("sceneplay experiment",
                  {"sceneplay experiment NAME... -o DIR [options]", "sceneplay experiment --list"},
                  "repeats experiments of the papers and puts what it finds beside what they say "
                  "(docs/EXPERIMENTS.md).");
  options.positional("NAME...", r.names, "experiments, as --list names them; all: all of them");
  options.group("Output");
  options.add("-o,--output", text_value(r.folder, "DIR"),
              "folder for experiment.json, a .csv for each table and pictures; made when missing");
  options.flag("--list", list, "print the experiments there are");  // handled before parsing
  options.group("Measuring");
  options.flag("--quick", r.quick, "small scenes and few frames: minutes on a software device", Role::run);
  options.add("--seed", whole_value(r.seed, std::uint64_t{0}, limits::kMaxSeed), "of the scenes");
  options.add("--repeat", whole_value(r.repeat, 1U, 1000U), "how often each case is measured", Role::run,
              "what suits the experiment");
  options.add("--size", size2_value(r.size, {16, 16}, {limits::kMaxFrameSide, limits::kMaxFrameSide}, "WxH"),
              "size of the pictures in pixels", Role::run, "1920x1080; with --quick 320x180");
  options.add(
      "--camera-path", texts_value(r.camera_paths, "FILE|NAME", camera_path_range(), not_empty),
      "camera path of merged-batch; may be given several times: the paper's figures of a still scene stand "
      "beside the first, those of an animation beside the last",
      Role::run, "fixed and fly");
  options.add("--samples", choice_value<std::uint32_t>(r.drawing.samples, {{"1", 1}, {"4", 4}}, "N"),
              "samples a pixel");
  options.add("--calibration", calibration_value(r.drawing.calibration),
              "what drawing costs here, for experiments that choose or predict by it (docs/CALIBRATION.md)");
  add_device_options(options, r.drawing);
  options.group("General");
  options.add_general(r.quiet);
  std::vector<const Experiment*> chosen;
  const auto check = [&]() -> Result<void> {
    auto found = find_experiments(r.names);
    if (!found) return forward_error(found);
    chosen = std::move(*found);
    for (const std::string& path : r.camera_paths) {
      if (auto known = check_camera_path(path); !known) return known;
    }
    if (r.folder.empty())
      return fail(ErrorKind::usage, "--output", "missing (usage: sceneplay experiment NAME... -o DIR)");
    return {};
  };
  return run_verb(options, arguments,
                  {.check = check, .work = [&]() -> Result<int> { return Laboratory(r, chosen).run(); }});
}

}  // namespace scenegen::tools
