// sceneplay bench FILE... -o DIR: how long frames take, drawn in several ways.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>

#include "render/strategy_names.h"
#include "scene/gltf/read.h"
#include "scene/limits.h"
#include "timeline/player.h"
#include "tools/bench_case.h"
#include "tools/bench_results.h"
#include "tools/calibrations.h"
#include "tools/camera_paths.h"
#include "tools/drawing_options.h"
#include "tools/frame_times.h"
#include "tools/output.h"
#include "tools/sceneplay.h"
#include "tools/trace.h"
#include "tools/verb.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

struct BenchRequest {
  std::vector<std::string> files;
  std::string folder, times, camera, trace;
  std::vector<std::string> camera_paths;
  std::vector<BenchWay> ways{{"inline", "inline", false, {}, {}}, {"octree", "octree", false, {}, {}}};
  std::vector<std::uint32_t> frames_in_flight{2};
  std::uint32_t frames = 100, warm_up = 10, repeat = 5;
  DrawingOptions drawing;
  bool readback = false;
  bool resume = false;
  bool quiet = false;
  std::vector<std::string> arguments;

  /// Cameras to see every file from.
  [[nodiscard]] std::vector<std::string> cameras() const {
    return camera_paths.empty() ? std::vector{camera} : camera_paths;
  }
};

std::string spell_ways(const std::vector<BenchWay>& ways) {
  std::vector<std::string> labels;
  labels.reserve(ways.size());
  for (const BenchWay& way : ways) labels.push_back(way.label);
  return join(labels, ",");
}

Value ways_value(std::vector<BenchWay>& target) {
  return {Value::Kind::text,
          "LIST",
          {},
          [&target](std::string_view text) -> Result<void> {
            auto ways = parse_ways(text);
            if (!ways) return forward_error(ways);
            target = std::move(*ways);
            return {};
          },
          [&target] { return spell_ways(target); }};
}

Value in_flight_value(std::vector<std::uint32_t>& target) {
  return {Value::Kind::text, "LIST", "1, 2, 3; separated by commas",
          [&target](std::string_view text) -> Result<void> {
            std::vector<std::uint32_t> out;
            for (std::size_t begin = 0; begin <= text.size();) {
              const std::size_t end = std::min(text.find(',', begin), text.size());
              auto n = parse_whole(text.substr(begin, end - begin), 1, 3);
              if (!n) return forward_error(n);
              const auto number = static_cast<std::uint32_t>(*n);
              if (std::find(out.begin(), out.end(), number) == out.end()) out.push_back(number);
              begin = end + 1;
            }
            target = std::move(out);
            return {};
          },
          [&target] {
            std::vector<std::string> words;
            words.reserve(target.size());
            for (const std::uint32_t n : target) words.push_back(std::to_string(n));
            return join(words, ",");
          }};
}

/// Evenly over the timeline, both ends included; a scene that does not change has one moment.
std::vector<double> even_moments(std::uint32_t frames, double duration_s) {
  std::vector<double> out;
  out.reserve(frames);
  for (std::uint32_t i = 0; i < frames; ++i)
    out.push_back(frames == 1 ? 0.0 : duration_s * i / static_cast<double>(frames - 1));
  return out;
}

ordered_json settings_json(const BenchRequest& r, const render::DeviceInfo& device) {
  return {{"version", SCENEGEN_VERSION},
          {"device", device.name},
          {"driver", device.driver},
          {"size", {r.drawing.size.x, r.drawing.size.y}},
          {"samples", r.drawing.samples},
          {"shadows", r.drawing.shadows},
          {"times", r.times.empty() ? ordered_json(r.frames) : ordered_json(r.times)},
          {"camera", r.camera},
          {"warmUp", r.warm_up},
          {"readback", r.readback},
          {"octreeN", r.drawing.octree_n},
          {"octreeMemoryMiB", r.drawing.octree_mib},
          {"nodeForm", static_cast<int>(r.drawing.node_form)},
          {"calibration", r.drawing.calibration},
          {"correction", !r.drawing.no_correction},
          {"lateVisibility", r.drawing.late_visibility},
          {"fullBarriers", r.drawing.full_barriers},
          {"validation", r.drawing.validation}};
}

/// Runs all cases. What fails is noted and the rest goes on.
class Bench {
 public:
  Bench(const BenchRequest& request, std::shared_ptr<render::vkr::Device> device,
        const render::DeviceInfo& info, std::optional<render::model::UnitCosts> costs)
      : request_(request),
        device_(std::move(device)),
        info_(info),
        costs_(std::move(costs)),
        store_((std::filesystem::path(request.folder) / "runs").string(), settings_json(request, info)),
        progress_("bench",
                  1000 * request.files.size() * request.cameras().size() * request.frames_in_flight.size() *
                      request.ways.size() * request.repeat,
                  request.quiet) {}

  Result<void> run() {
    if (auto opened = store_.open(request_.resume); !opened) return opened;
    for (const std::string& file : request_.files) {
      if (auto done = run_file(file); !done) return done;
    }
    if (!request_.trace.empty()) {
      if (auto written = write_trace(request_.trace, trace_); !written) return written;
    }
    return first_failure_ ? tl::unexpected<Error>(*first_failure_) : Result<void>();
  }

 private:
  void failed(CaseResult& result, const Error& error) {
    result.error = error.str();
    result.runs.clear();
    if (!first_failure_) first_failure_ = error;
  }

  std::vector<GroupResult> groups_of(const std::string& file) const {
    std::vector<GroupResult> out;
    for (const std::string& camera : request_.cameras()) {
      for (const std::uint32_t n : request_.frames_in_flight) {
        GroupResult& group = out.emplace_back();
        for (const BenchWay& way : request_.ways) group.cases.push_back({{file, camera, n, way}, {}, {}});
      }
    }
    return out;
  }

  Result<void> run_file(const std::string& file) {
    std::vector<GroupResult> groups = groups_of(file);
    auto read = gltf::read(file, {});
    if (read) timeline_ = timeline::compile(read->scene);
    for (GroupResult& group : groups) {
      if (!read) {
        for (CaseResult& result : group.cases) failed(result, read.error());
      } else if (auto done = run_group(read->scene, group); !done) {
        return done;
      }
      groups_.push_back(std::move(group));
      if (auto written = report(); !written) return written;
    }
    return {};
  }

  Result<std::vector<double>> moments_of(const Scene& scene, const CameraMan& camera) const {
    const double duration_s = camera.played_s(static_cast<double>(scene.duration_s));
    if (request_.times.empty()) return even_moments(request_.frames, duration_s);
    const auto& calendar = scene.info.calendar;
    auto moments = parse_times(request_.times, duration_s, calendar ? &*calendar : nullptr);
    if (!moments) moments.error().where = "--times";
    return moments;
  }

  Result<void> run_group(const Scene& scene, GroupResult& group) {
    const std::string& name = group.cases.front().what.camera;
    auto camera = request_.camera_paths.empty() ? CameraMan::of_scene(scene, name, request_.drawing.size)
                                                : CameraMan::of_path(name, scene, request_.drawing.size);
    auto moments = camera ? moments_of(scene, *camera) : forward_error(camera);
    if (!moments) {
      for (CaseResult& result : group.cases) failed(result, moments.error());
      return {};
    }
    std::vector<BenchSeat> seats;
    for (const CaseResult& result : group.cases)
      seats.emplace_back(scene, timeline_, *camera, options_of(result.what));
    const std::size_t count = seats.size();
    for (std::uint32_t repetition = 0; repetition < request_.repeat; ++repetition) {
      // Another one begins each time: what drifts, and what one leaves behind for the next, hits all alike.
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = (i + repetition) % count;
        if (auto done = run_case(seats[at], group.cases[at], *moments, repetition); !done) return done;
      }
    }
    return {};
  }

  Result<void> run_case(BenchSeat& seat, CaseResult& result, const std::vector<double>& moments,
                        std::uint32_t repetition) {
    const std::uint64_t begun = 1000 * runs_done_++;
    const auto advance = [&](std::uint64_t to) { progress_.advance(to - std::exchange(progress_at_, to)); };
    if (result.error.empty()) {
      auto known = request_.resume ? store_.find(result.what, repetition) : std::optional<BenchRun>();
      if (!known) return forward_error(known);
      if (*known) {
        result.runs.push_back(std::move(**known));
        advance(begun + 1000);
        return {};
      }
      ordered_json rows = ordered_json::array();
      const auto on_frame = [&](std::size_t done, std::size_t of) { advance(begun + 1000 * done / of); };
      auto run = seat.run(moments, request_.warm_up, on_frame, request_.trace.empty() ? nullptr : &rows);
      if (run) {
        add_to_trace(result.what, repetition, rows);
        if (auto saved = store_.save(result.what, repetition, *run); !saved) return saved;
        result.runs.push_back(std::move(*run));
      } else {
        failed(result, run.error());
      }
    }
    advance(begun + 1000);
    return {};
  }

  void add_to_trace(const BenchCase& what, std::uint32_t repetition, const ordered_json& rows) {
    for (const ordered_json& row : rows) {
      ordered_json& out = trace_.emplace_back(ordered_json{{"file", what.file},
                                                           {"camera", what.camera},
                                                           {"framesInFlight", what.frames_in_flight},
                                                           {"repetition", repetition}});
      out.update(row);
      out["strategy"] = what.way.label;
    }
  }

  [[nodiscard]] render::RendererOptions options_of(const BenchCase& what) const {
    render::RendererOptions o = request_.drawing.renderer();
    o.shared_device = device_;
    o.outputs.readback = request_.readback;
    o.strategy = what.way.strategy;
    o.how.late_visibility = o.how.late_visibility || what.way.late;
    o.how.objects_per_node = what.way.octree_n.value_or(o.how.objects_per_node);
    o.how.node_form = what.way.form.value_or(o.how.node_form);
    o.frames_in_flight = what.frames_in_flight;
    if (costs_) o.costs = costs_;
    o.predictions = !request_.trace.empty();
    return o;
  }

  /// Both files, and the table of the group that was measured last.
  Result<void> report() {
    const ordered_json cases = cases_json(groups_);
    const ordered_json json{
        {"schema", "sceneplay/bench"},
        {"version", 1},
        {"program", {{"version", SCENEGEN_VERSION}, {"compiler", compiler()}}},
        {"arguments", request_.arguments},
        {"machine", machine_json()},
        {"device", {{"name", info_.name}, {"type", info_.type}, {"driver", info_.driver}}},
        {"settings", settings_json(request_, info_)},
        {"cases", cases}};
    const std::filesystem::path folder(request_.folder);
    if (auto written = write_file((folder / "bench.json").string(), pretty(json)); !written) return written;
    if (auto written = write_file((folder / "bench.csv").string(), flat_csv(cases)); !written) return written;
    progress_.clear();
    for (const CaseResult& result : groups_.back().cases) {
      if (!result.runs.empty() && !request_.quiet) {
        for (const std::string& warning : result.runs.back().warnings)
          (void)std::fprintf(stderr, "warning: %s: %s\n", result.what.way.label.c_str(),
                             printable(warning).c_str());
      }
    }
    if (request_.quiet) return {};
    return write_stdout((groups_.size() == 1 ? heading() : "\n") + group_table(groups_.back()));
  }

  [[nodiscard]] std::string heading() const {
    const BenchRequest& r = request_;
    return info_.name + " (" + info_.driver + ")  " + std::to_string(r.drawing.size.x) + "x" +
           std::to_string(r.drawing.size.y) + "  " + std::to_string(r.drawing.samples) +
           (r.drawing.samples == 1 ? " sample" : " samples") + "  shadows " +
           (r.drawing.shadows ? "on" : "off") + "  " + std::to_string(r.repeat) +
           (r.repeat == 1 ? " run each\n\n" : " runs each\n\n");
  }

  const BenchRequest& request_;
  std::shared_ptr<render::vkr::Device> device_;
  render::DeviceInfo info_;
  std::optional<render::model::UnitCosts> costs_;
  RunStore store_;
  Progress progress_;
  std::uint64_t progress_at_ = 0;
  std::uint64_t runs_done_ = 0;
  std::shared_ptr<const timeline::Timeline> timeline_;
  std::vector<GroupResult> groups_;
  std::optional<Error> first_failure_;
  ordered_json trace_ = ordered_json::array();
};

void add_options(Options& options, BenchRequest& r) {
  options.positional("FILE...", r.files, "scenes: .glb or .gltf files");
  options.group("Output");
  options.add("-o,--output", text_value(r.folder, "DIR"),
              "folder for bench.json, bench.csv and the single runs; made when missing");
  options.flag("--resume", r.resume,
               "keep the runs that DIR holds already, and measure only what is missing");
  options.add("--trace", text_value(r.trace, "FILE"),
              "one row a frame that counts, of the runs measured now: camera, choice, predictions (some 50 "
              "us a frame), "
              "counts, stage times; .csv or .json");
  options.group("Measuring");
  options.add("--repeat", whole_value(r.repeat, 1U, 1000U),
              "runs of each case; those of one scene and camera take turns");
  options.add("--frames", whole_value(r.frames, 1U, 1000000U), "frames of a run, evenly over the timeline");
  options.add("--times", text_value(r.times, "LIST", "as of sceneplay frames"), "moments of a run instead");
  options.add("--warm-up", whole_value(r.warm_up, 1U, 100000U), "frames before each run that do not count");
  options.add("--size",
              size2_value(r.drawing.size, {1, 1}, {limits::kMaxFrameSide, limits::kMaxFrameSide}, "WxH"),
              "size of the pictures in pixels");
  options.flag("--readback", r.readback, "read the pixels of every frame; else they stay on the device",
               Role::run);
  options.group("View");
  options.add("--camera", text_value(r.camera, "NAME|INDEX", "a camera of the file, or auto"), "camera",
              Role::run, "the file's first, else auto");
  options.add("--camera-path",
              texts_value(r.camera_paths, "FILE|NAME", camera_path_range(),
                          [](const std::string& text) -> Result<void> {
                            if (text.empty()) return fail(ErrorKind::usage, "", "is empty");
                            return {};
                          }),
              "camera path: as JSON, or made from the scene (docs/CAMERA_PATH.md); may be given several "
              "times");
  add_drawing_options(options, r.drawing, ways_value(r.ways), in_flight_value(r.frames_in_flight));
  add_device_options(options, r.drawing);
  options.group("General");
  options.add_general(r.quiet);
}

Result<void> measure(const BenchRequest& request) {
  if (auto named = check_trace_name(request.trace); !named) return named;
  auto device = render::share_device(request.drawing.renderer().device);
  if (!device) return forward_error(device);
  // Found out before anything is measured.
  for (const std::string& path : request.camera_paths) {
    if (auto known = check_camera_path(path); !known) return known;
  }
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
  // Once for all ways, so that they are compared under the same costs.
  render::RendererOptions costs = request.drawing.renderer();
  costs.shared_device = *device;
  const auto chooses = std::find_if(request.ways.begin(), request.ways.end(), [](const BenchWay& way) {
    return render::strategy_uses_costs(way.strategy);
  });
  if (chooses != request.ways.end()) costs.strategy = chooses->strategy;
  if (auto set = set_costs(costs, request.drawing.calibration, request.quiet); !set) return set;
  return Bench(request, *device, render::info_of(**device), std::move(costs.costs)).run();
}

}  // namespace

int bench_verb(std::span<const std::string> arguments) {
  if (std::find(arguments.begin(), arguments.end(), "--list-devices") != arguments.end())
    return list_devices_verb();
  BenchRequest request;
  request.arguments.assign(arguments.begin(), arguments.end());
  Options options(
      "sceneplay bench", {"sceneplay bench FILE... -o DIR [options]"},
      "measures how long frames take in several ways of drawing: --strategy A,B,C. "
      "A:late is A with --late-visibility, A:n=100 with --octree-n 100, A:indirect and A:secondaries "
      "with that --node-form.");
  add_options(options, request);
  const auto check = [&]() -> Result<void> {
    if (request.folder.empty())
      return fail(ErrorKind::usage, "--output", "missing (usage: sceneplay bench FILE... -o DIR)");
    if (options.given("--times") && options.given("--frames"))
      return fail(ErrorKind::usage, "--times", "has no place beside --frames");
    if (options.given("--camera") && options.given("--camera-path"))
      return fail(ErrorKind::usage, "--camera", "has no place beside --camera-path");
    return {};
  };
  return run_verb(options, arguments, {.check = check, .work = [&]() -> Result<int> {
                                         Result<void> measured = measure(request);
                                         return measured ? Result<int>(0) : forward_error(measured);
                                       }});
}

}  // namespace scenegen::tools
