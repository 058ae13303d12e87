#include "tools/bench_run.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <new>

#include "timeline/player.h"
#include "tools/bench_clock.h"
#include "tools/bench_devices.h"
#include "tools/bench_results.h"
#include "tools/camera_paths.h"
#include "tools/frame_times.h"
#include "tools/trace.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

/// Evenly over the timeline, both ends included; a scene that does not change has one moment.
std::vector<double> even_moments(std::uint32_t frames, double duration_s) {
  std::vector<double> out;
  out.reserve(frames);
  for (std::uint32_t i = 0; i < frames; ++i)
    out.push_back(frames == 1 ? 0.0 : duration_s * i / static_cast<double>(frames - 1));
  return out;
}

ordered_json settings_json(const BenchRequest& r) {
  ordered_json out{{"version", SCENEGEN_VERSION},
                   {"size", {r.drawing.size.x, r.drawing.size.y}},
                   {"samples", r.drawing.samples},
                   {"shadows", r.drawing.shadows}};
  if (r.times.empty()) {
    out["frames"] = r.frames;
  } else {
    out["times"] = r.times;
  }
  const ordered_json rest{{"camera", r.camera},
                          {"warmUp", r.warm_up},
                          {"renderers", r.keep_renderers ? "kept" : "fresh"},
                          {"readback", r.readback},
                          {"octreeN", r.drawing.octree_n},
                          {"octreeMemoryMiB", r.drawing.octree_mib},
                          {"nodeForm", static_cast<int>(r.drawing.node_form)},
                          {"calibration", r.drawing.calibration},
                          {"correction", !r.drawing.no_correction},
                          {"lateVisibility", r.drawing.late_visibility},
                          {"fullBarriers", r.drawing.full_barriers},
                          {"validation", r.drawing.validation}};
  out.update(rest);
  return out;
}

std::uint64_t file_bytes(const std::string& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  return error ? 0 : static_cast<std::uint64_t>(bytes);
}

/// Groups of one scene, camera and number of frames in flight; their cases take turns.
struct Round {
  std::string camera;
  std::vector<GroupResult> groups;  ///< by device
};

class Bench {
 public:
  Bench(const BenchRequest& request, std::vector<BenchDevice> devices)
      : request_(request),
        devices_(std::move(devices)),
        store_((std::filesystem::path(request.folder) / "runs").string(), settings_json(request)),
        scenes_(request.scenes()),
        clock_("bench",
               scenes_.size() * request.cameras().size() * request.frames_in_flight.size() * devices_.size() *
                   request.ways.size() * request.repeat,
               request.quiet) {}

  Result<void> run() {
    if (auto opened = store_.open(request_.resume); !opened) return opened;
    for (const BenchDevice& device : devices_) {
      if (device.error) note(*device.error);
    }
    for (const BenchScene& scene : scenes_) {
      if (auto done = run_scene(scene); !done) return done;
    }
    if (!request_.trace.empty()) {
      if (auto written = write_trace(request_.trace, trace_); !written) note(written.error());
    }
    return first_failure_ ? tl::unexpected<Error>(*first_failure_) : Result<void>();
  }

 private:
  void note(const Error& error) {
    if (!first_failure_) first_failure_ = error;
  }
  void failed(CaseResult& result, const Error& error) {
    result.error = error.str();
    result.runs.clear();
    note(error);
  }

  std::vector<Round> rounds_of(const std::string& name) const {
    std::vector<Round> out;
    for (const std::string& camera : request_.cameras()) {
      for (const std::uint32_t n : request_.frames_in_flight) {
        Round& round = out.emplace_back(Round{camera, {}});
        for (const BenchDevice& device : devices_) {
          GroupResult& group = round.groups.emplace_back();
          for (const BenchWay& way : request_.ways)
            group.cases.push_back({{name, device.label, camera, n, way}, {}, {}});
        }
      }
    }
    return out;
  }

  Result<void> run_scene(const BenchScene& source) {
    const Stopwatch watch;
    auto scene = loaded(source);
    const double load_ms = watch.seconds() * 1e3;
    if (scene) {
      timeline_ = timeline::compile(*scene);
      scenes_json_.push_back(scene_json(source.name, *scene, file_bytes(source.name), load_ms));
    }
    for (Round& round : rounds_of(source.name)) {
      if (!scene) {
        for (GroupResult& group : round.groups)
          for (CaseResult& result : group.cases) failed(result, scene.error());
        clock_.skip(round.groups.size() * request_.ways.size() * request_.repeat);
      } else if (auto done = run_round(*scene, round); !done) {
        return done;
      }
      for (GroupResult& group : round.groups) groups_.push_back(std::move(group));
      if (auto told = report(round.groups.size()); !told) return told;
    }
    return {};
  }

  static Result<Scene> loaded(const BenchScene& source) {
    try {
      return source.load();
    } catch (const std::bad_alloc&) {
      return fail(ErrorKind::io, source.name, "does not fit into memory");
    }
  }

  Result<std::vector<double>> moments_of(const Scene& scene, const CameraMan& camera) const {
    const double duration_s = camera.played_s(static_cast<double>(scene.duration_s));
    if (request_.times.empty()) return even_moments(request_.frames, duration_s);
    const auto& calendar = scene.info.calendar;
    auto moments = parse_times(request_.times, duration_s, calendar ? &*calendar : nullptr);
    if (!moments) moments.error().where = "--times";
    return moments;
  }

  Result<void> run_round(const Scene& scene, Round& round) {
    auto camera = request_.camera_paths.empty()
                      ? CameraMan::of_scene(scene, round.camera, request_.drawing.size)
                      : CameraMan::of_path(round.camera, scene, request_.drawing.size);
    auto moments = camera ? moments_of(scene, *camera) : forward_error(camera);
    std::vector<CaseResult*> cases;
    std::vector<BenchSeat> seats;
    for (std::size_t d = 0; d < devices_.size(); ++d) {
      for (CaseResult& result : round.groups[d].cases) {
        cases.push_back(&result);
        if (!moments) {
          failed(result, moments.error());
        } else if (devices_[d].error) {
          failed(result, *devices_[d].error);
        } else {
          result.moments_s = *moments;
        }
        if (moments) seats.emplace_back(scene, timeline_, *camera, options_of(result.what, devices_[d]));
      }
    }
    const std::size_t count = cases.size();
    if (!moments) clock_.skip(count * request_.repeat);
    for (std::uint32_t repetition = 0; moments && repetition < request_.repeat; ++repetition) {
      // Another one begins each time: what drifts, and what one leaves behind for the next, hits all alike.
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = (i + repetition) % count;
        if (auto done = run_case(seats[at], *cases[at], repetition); !done) return done;
      }
    }
    return {};
  }

  Result<void> run_case(BenchSeat& seat, CaseResult& result, std::uint32_t repetition) {
    if (!result.error.empty()) {
      clock_.skip(1);
      return {};
    }
    auto known = request_.resume ? store_.find(result.what, repetition) : std::optional<BenchRun>();
    if (!known) return forward_error(known);
    if (*known) {
      result.runs.push_back(std::move(**known));
      clock_.skip(1);
      return {};
    }
    ordered_json rows = ordered_json::array();
    clock_.begin();
    auto run = measured(seat, result, request_.trace.empty() ? nullptr : &rows);
    clock_.end();
    if (!request_.keep_renderers || !run) seat.forget();
    if (!run) {
      failed(result, run.error());
      return {};
    }
    add_to_trace(result.what, repetition, rows);
    // The run counts even if it cannot be kept.
    if (auto saved = store_.save(result.what, repetition, *run); !saved) note(saved.error());
    result.runs.push_back(std::move(*run));
    return {};
  }

  Result<BenchRun> measured(BenchSeat& seat, const CaseResult& result, ordered_json* rows) {
    try {
      return seat.run(
          result.moments_s, request_.warm_up,
          [&](std::size_t done, std::size_t of) {
            clock_.within(static_cast<double>(done) / static_cast<double>(of));
          },
          rows);
    } catch (const std::bad_alloc&) {
      return fail(ErrorKind::no_device, result.what.file, "does not fit into memory");
    }
  }

  void add_to_trace(const BenchCase& what, std::uint32_t repetition, const ordered_json& rows) {
    for (const ordered_json& row : rows) {
      ordered_json& out = trace_.emplace_back(ordered_json{{"file", what.file},
                                                           {"device", what.device},
                                                           {"camera", what.camera},
                                                           {"framesInFlight", what.frames_in_flight},
                                                           {"repetition", repetition}});
      out.update(row);
      out["strategy"] = what.way.label;
    }
  }

  [[nodiscard]] render::RendererOptions options_of(const BenchCase& what, const BenchDevice& device) const {
    render::RendererOptions o = request_.drawing.renderer();
    o.shared_device = device.device;
    o.outputs.readback = request_.readback;
    o.strategy = what.way.strategy;
    o.how.late_visibility = o.how.late_visibility || what.way.late;
    o.how.objects_per_node = what.way.octree_n.value_or(o.how.objects_per_node);
    o.how.node_form = what.way.form.value_or(o.how.node_form);
    o.frames_in_flight = what.frames_in_flight;
    if (device.costs) o.costs = device.costs;
    o.predictions = !request_.trace.empty();
    return o;
  }

  /// Both files, and the tables of the last `count` groups.
  Result<void> report(std::size_t count) {
    const ordered_json cases = cases_json(groups_);
    ordered_json settings = settings_json(request_);
    settings["repeat"] = request_.repeat;
    const ordered_json json{
        {"schema", kBenchSchema},
        {"version", kBenchVersion},
        {"program", {{"name", "sceneplay"}, {"version", SCENEGEN_VERSION}, {"compiler", compiler()}}},
        {"arguments", request_.arguments},
        {"machine", machine_json()},
        {"devices", devices_json(devices_)},
        {"settings", settings},
        {"scenes", scenes_json_},
        {"cases", cases}};
    const std::filesystem::path folder(request_.folder);
    // A disk that is full now may have room later; what is measured goes on.
    if (auto written = write_file((folder / "bench.json").string(), pretty(json)); !written)
      note(written.error());
    if (auto written = write_file((folder / "bench.csv").string(), flat_csv(cases)); !written)
      note(written.error());
    if (request_.quiet) return {};
    clock_.clear();
    std::string text;
    for (std::size_t g = groups_.size() - count; g < groups_.size(); ++g) {
      for (const CaseResult& result : groups_[g].cases) {
        for (const std::string& warning :
             result.runs.empty() ? std::vector<std::string>() : result.runs.back().warnings)
          (void)std::fprintf(stderr, "warning: %s: %s\n", result.what.way.label.c_str(),
                             printable(warning).c_str());
      }
      text += (g == 0 ? heading() : "\n") + group_table(groups_[g]);
    }
    return write_stdout(text);
  }

  [[nodiscard]] std::string heading() const {
    const BenchRequest& r = request_;
    std::string out;
    for (const BenchDevice& d : devices_) {
      if (!d.error) out += d.label + " (" + d.info.driver + ")\n";
    }
    return out + std::to_string(r.drawing.size.x) + "x" + std::to_string(r.drawing.size.y) + "  " +
           std::to_string(r.drawing.samples) + (r.drawing.samples == 1 ? " sample" : " samples") +
           "  shadows " + (r.drawing.shadows ? "on" : "off") + "  " + counted(r.repeat, "run") + " each\n\n";
  }

  const BenchRequest& request_;
  std::vector<BenchDevice> devices_;
  RunStore store_;
  std::vector<BenchScene> scenes_;
  BenchClock clock_;
  std::shared_ptr<const timeline::Timeline> timeline_;
  std::vector<GroupResult> groups_;
  ordered_json scenes_json_ = ordered_json::array();
  std::optional<Error> first_failure_;
  ordered_json trace_ = ordered_json::array();
};

}  // namespace

std::vector<BenchScene> BenchRequest::scenes() const {
  std::vector<BenchScene> out;
  if (quick) out = quick_scenes();
  for (const std::string& file : files) out.push_back(scene_of_file(file));
  return out;
}

Result<void> run_bench(const BenchRequest& request) {
  if (auto named = check_trace_name(request.trace); !named) return named;
  for (const std::string& path : request.camera_paths) {
    if (auto known = check_camera_path(path); !known) return known;
  }
  auto devices = open_devices(request);
  if (!devices) return forward_error(devices);
  std::error_code error;
  std::filesystem::create_directories(request.folder, error);
  if (error || !std::filesystem::is_directory(request.folder, error))
    return fail(ErrorKind::io, request.folder, error ? "cannot be made: " + error.message() : "is no folder");
  if (!request.trace.empty()) {
    if (auto writable = check_output_file(request.trace); !writable) return writable;
  }
  if (auto writable = check_output_file((std::filesystem::path(request.folder) / "bench.json").string());
      !writable)
    return writable;
  return Bench(request, std::move(*devices)).run();
}

}  // namespace scenegen::tools
