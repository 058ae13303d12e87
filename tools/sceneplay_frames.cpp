// sceneplay frames FILE -o DIR: plays a file and writes one picture a frame.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <future>
#include <optional>
#include <thread>

#include "render/image_file.h"
#include "render/renderer.h"
#include "render/strategy_names.h"
#include "scene/gltf/read.h"
#include "scene/limits.h"
#include "timeline/calendar.h"
#include "timeline/player.h"
#include "tools/calibrations.h"
#include "tools/camera_paths.h"
#include "tools/drawing_options.h"
#include "tools/frame_fields.h"
#include "tools/frame_times.h"
#include "tools/memory_fields.h"
#include "tools/output.h"
#include "tools/read_gltf.h"
#include "tools/sceneplay.h"
#include "tools/trace.h"
#include "tools/verb.h"

namespace scenegen::tools {

namespace {

using nlohmann::ordered_json;

struct FramesRequest {
  std::string file, folder, times, camera, camera_path, report, trace;
  double fps = 25;
  double length_s = 0;
  render::PictureFormat format = render::PictureFormat::png;
  bool ids = false, depth = false;
  bool show_nodes = false;
  bool memory = false;
  std::string strategy = "inline";
  std::uint32_t frames_in_flight = 2;
  DrawingOptions drawing;
  bool quiet = false;
};

Result<std::vector<double>> moments(const FramesRequest& request, const Options& options, const Scene& scene,
                                    double duration_s) {
  if (options.given("--times")) {
    const auto& calendar = scene.info.calendar;
    auto times = parse_times(request.times, duration_s, calendar ? &*calendar : nullptr);
    if (!times) times.error().where = "--times";
    return times;
  }
  if (options.given("--fps") || options.given("--duration")) {
    auto times =
        film_times(request.fps, options.given("--duration") ? request.length_s : duration_s, duration_s);
    if (!times) times.error().where = "--fps";
    return times;
  }
  return parse_times(duration_s > 0.0 ? "25%,50%,75%,100%" : "0", duration_s);
}

std::string digits_of(std::size_t number) {
  std::string digits = std::to_string(number);
  digits.insert(0, digits.size() < 5 ? 5 - digits.size() : 0, '0');
  return digits;
}

/// The number in 00012, if `digits` is how a frame's number is written.
std::optional<std::size_t> frame_number(std::string_view digits) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size() || digits_of(number) != digits)
    return std::nullopt;
  return number;
}

/// Whether a file of this name is a picture as this program writes them, and not one of this run's.
bool is_stale(const FramesRequest& request, std::size_t frames, const std::filesystem::path& name) {
  const std::string stem = name.stem().string();
  const std::size_t line = stem.find('_');
  if (line == std::string::npos) return false;
  const auto number = frame_number(std::string_view(stem).substr(line + 1));
  if (!number) return false;
  const std::string kind = stem.substr(0, line);
  const std::string form = name.extension().string();
  const bool picture = kind == "frame" && (form == ".png" || form == ".jpg" || form == ".bmp");
  const bool ids = kind == "ids" && form == ".png";
  const bool depth = kind == "depth" && form == ".pfm";
  if (!picture && !ids && !depth) return false;
  const bool made =
      picture ? form == "." + std::string(extension(request.format)) : (ids ? request.ids : request.depth);
  return !made || *number >= frames;
}

/// Pictures of an earlier, longer run would end up in a film that is made of the folder.
void remove_stale(const FramesRequest& request, std::size_t frames) {
  std::error_code error;
  std::vector<std::filesystem::path> stale;
  for (const auto& entry : std::filesystem::directory_iterator(request.folder, error)) {
    if (entry.is_regular_file(error) && is_stale(request, frames, entry.path().filename()))
      stale.push_back(entry.path());
  }
  std::size_t removed = 0;
  for (const std::filesystem::path& path : stale) {
    if (std::filesystem::remove(path, error)) {
      ++removed;
    } else {
      (void)std::fprintf(stderr, "warning: %s of an earlier run cannot be removed\n",
                         printable(path.string()).c_str());
    }
  }
  if (removed > 0 && !request.quiet)
    (void)std::fprintf(stderr, "note: removed %s of an earlier run from %s\n",
                       counted(removed, "picture").c_str(), printable(request.folder).c_str());
}

/// Encodes and writes the files of one frame; runs on a thread of its own.
struct Encoded {
  double encode_ms = 0;
  std::uint64_t bytes = 0;
};
Result<Encoded> write_frame(const FramesRequest& request, std::size_t number, render::FrameResult& frame,
                            const render::View& view) {
  const Stopwatch watch;
  if (request.show_nodes) render::draw_chunk_boxes(frame.chunk_boxes, view, request.drawing.size, frame.rgba);
  const std::string digits = digits_of(number);
  Encoded out;
  const auto write = [&](const std::string& name, const std::string& bytes) {
    out.bytes += bytes.size();
    return write_file((std::filesystem::path(request.folder) / name).string(), bytes);
  };
  Result<void> written = write("frame_" + digits + "." + std::string(extension(request.format)),
                               render::encode_picture(request.format, request.drawing.size, frame.rgba));
  if (written && request.ids)
    written = write("ids_" + digits + ".png", render::encode_ids(request.drawing.size, frame.ids));
  if (written && request.depth) {
    std::vector<float> metres(frame.depth.size());
    std::transform(frame.depth.begin(), frame.depth.end(), metres.begin(), [&](float d) {
      return d > 0.0F ? view.distance_m(d) : std::numeric_limits<float>::infinity();
    });
    written = write("depth_" + digits + ".pfm", render::encode_pfm(request.drawing.size, metres));
  }
  if (!written) return forward_error(written);
  out.encode_ms = watch.seconds() * 1e3;
  return out;
}

ordered_json frame_json(const render::FrameReport& r, double seek_ms, double encode_ms) {
  ordered_json out{{"timeS", r.time_s}};
  for (const CounterField& field : counter_fields()) out[std::string(field.name)] = r.*field.value;
  add_choice(r, out);
  ordered_json& stages = out["stagesMs"] = {{"seek", seek_ms}};
  for (const StageField& field : stage_fields()) {
    const double ms = r.*field.value;
    stages[std::string(field.name)] = ms < 0 ? ordered_json() : ordered_json(ms);
  }
  stages["encode"] = encode_ms;
  ordered_json& gpu = out["gpuStagesMs"];
  if (r.gpu_stages_ms.front() < 0) return out;  // null
  for (std::size_t i = 0; i < render::kGpuStages; ++i)
    gpu[std::string(render::kGpuStageNames[i])] = r.gpu_stages_ms[i];
  return out;
}

/// Plays the times through the renderer: while the device draws a frame, the one before is encoded.
class Filming {
 public:
  Filming(const FramesRequest& request, timeline::Player player, CameraMan camera, render::Renderer renderer,
          std::optional<Calendar> calendar)
      : request_(request),
        calendar_(std::move(calendar)),
        player_(std::move(player)),
        camera_(std::move(camera)),
        renderer_(std::move(renderer)) {}

  Result<void> run(const std::vector<double>& times) {
    Progress progress("frames", times.size(), request_.quiet);
    for (const double time_s : times) {
      if (renderer_.in_flight() == renderer_.most_in_flight()) {
        if (Result<void> done = finish_one(progress); !done) return done;
      }
      const Stopwatch watch;
      const timeline::ChangeSet& changes = player_.seek(time_s);
      seek_ms_.push_back(watch.seconds() * 1e3);
      views_.push_back(camera_.view(player_, time_s));
      if (Result<void> done = renderer_.submit(changes, player_, views_.back()); !done) return done;
    }
    while (renderer_.in_flight() > 0) {
      if (Result<void> done = finish_one(progress); !done) return done;
    }
    while (!encoding_.empty()) {
      if (Result<void> done = take_encoded(progress); !done) return done;
    }
    return {};
  }

  [[nodiscard]] ordered_json frames() const { return frames_; }
  [[nodiscard]] const ordered_json& trace() const { return trace_; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  [[nodiscard]] render::Renderer& renderer() { return renderer_; }
  [[nodiscard]] render::MemoryAccount memory() const { return renderer_.memory(player_); }

 private:
  struct Job {
    render::FrameReport report;
    double seek_ms;
    std::future<Result<Encoded>> encoded;
  };

  Result<void> finish_one(Progress& progress) {
    render::FrameResult frame;
    if (Result<void> done = renderer_.finish(frame); !done) return done;
    const std::size_t most = std::max(1U, std::thread::hardware_concurrency());
    while (encoding_.size() >= most) {
      if (Result<void> done = take_encoded(progress); !done) return done;
    }
    const std::size_t number = finished_++;
    const render::FrameReport report = frame.report;
    if (!request_.trace.empty())
      trace_.push_back(trace_row(report, views_[number], request_.strategy, seek_ms_[number],
                                 request_.ids || request_.depth ? 2 : 1));
    encoding_.push_back({report, seek_ms_[number],
                         std::async(std::launch::async, [this, number, frame = std::move(frame),
                                                         view = views_[number]]() mutable {
                           return write_frame(request_, number, frame, view);
                         })});
    return {};
  }

  Result<void> take_encoded(Progress& progress) {
    Job job = std::move(encoding_.front());
    encoding_.pop_front();
    Result<Encoded> encoded = job.encoded.get();
    if (!encoded) return forward_error(encoded);
    bytes_ += encoded->bytes;
    frames_.push_back(frame_json(job.report, job.seek_ms, encoded->encode_ms));
    if (calendar_) frames_.back()["date"] = timeline::date_at(*calendar_, job.report.time_s);
    progress.advance();
    return {};
  }

  const FramesRequest& request_;
  std::optional<Calendar> calendar_;  ///< the file's: frames then have a date
  timeline::Player player_;
  CameraMan camera_;
  render::Renderer renderer_;
  std::vector<render::View> views_;
  std::vector<double> seek_ms_;
  std::deque<Job> encoding_;
  std::size_t finished_ = 0;
  std::uint64_t bytes_ = 0;
  ordered_json frames_ = ordered_json::array();
  ordered_json trace_ = ordered_json::array();
};

ordered_json report_json(const FramesRequest& request, Filming& filming, double load_s, double total_s) {
  const render::DeviceInfo& device = filming.renderer().device();
  ordered_json out{{"schema", "sceneplay/frames"},
                   {"version", 1},
                   {"file", request.file},
                   {"device", {{"name", device.name}, {"type", device.type}, {"driver", device.driver}}},
                   {"size", {request.drawing.size.x, request.drawing.size.y}},
                   {"samples", request.drawing.samples},
                   {"strategy", request.strategy},
                   {"framesInFlight", request.frames_in_flight},
                   {"shadows", request.drawing.shadows},
                   {"loadS", load_s},
                   {"totalS", total_s},
                   {"deviceBytes", filming.renderer().device_bytes()}};
  out.update(memory_json(filming.memory()));
  out["warnings"] = filming.renderer().warnings();
  out["frames"] = filming.frames();
  return out;
}

render::RendererOptions renderer_options(const FramesRequest& request) {
  render::RendererOptions o = request.drawing.renderer();
  o.outputs = {true, request.ids, request.depth};
  o.strategy = request.strategy;
  o.predictions = !request.report.empty() || !request.trace.empty();
  o.how.measure_commands = !request.report.empty() || request.memory;
  o.frames_in_flight = request.frames_in_flight;
  o.chunk_boxes = request.show_nodes;
  return o;
}

/// A file in the folder of the pictures, which is yet to be made.
bool in_new_folder(const std::string& path, const std::string& folder) {
  std::error_code error;
  if (std::filesystem::exists(folder, error)) return false;
  const auto real = [&](const std::filesystem::path& p) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(p, error), error);
  };
  return real(path).parent_path() == real(folder);
}

/// Before the long work.
Result<void> check_files(const FramesRequest& request) {
  if (auto named = check_trace_name(request.trace); !named) return named;
  if (auto apart = check_distinct_files({{"--report", request.report}, {"--trace", request.trace}},
                                        {{"FILE", request.file}, {"--camera-path", request.camera_path}});
      !apart)
    return apart;
  for (const std::string& path : {request.report, request.trace}) {
    if (path.empty() || path == "-" || in_new_folder(path, request.folder)) continue;
    if (auto writable = check_output_file(path); !writable) return writable;
  }
  return {};
}

/// An error about what should have told of pictures that are there.
tl::unexpected<Error> without_pictures_lost(Error error, const FramesRequest& request) {
  error.what += "; the pictures in " + request.folder + " are complete";
  return tl::unexpected<Error>(std::move(error));
}

Result<void> draw(const FramesRequest& request, const Options& options) {
  const Stopwatch watch;
  auto read = read_gltf(request.file, {});
  if (!read) return forward_error(read);
  const Scene& scene = read->scene;
  auto camera = request.camera_path.empty()
                    ? CameraMan::of_scene(scene, request.camera, request.drawing.size)
                    : CameraMan::of_path(request.camera_path, scene, request.drawing.size);
  if (!camera) return forward_error(camera);
  auto times = moments(request, options, scene, camera->played_s(static_cast<double>(scene.duration_s)));
  if (!times) return forward_error(times);
  timeline::Player player(timeline::compile(scene));
  render::RendererOptions how = renderer_options(request);
  if (auto costs = set_costs(how, request.drawing.calibration, request.quiet); !costs) return costs;
  auto renderer = render::Renderer::create(scene, player, how);
  if (!renderer) return forward_error(renderer);
  if (auto made = make_folder(request.folder, "frame_00000.png"); !made) return made;
  if (auto writable = check_files(request); !writable) return writable;  // now also those in that folder
  std::size_t warned = 0;
  print_warnings(*renderer, warned, request.quiet);
  const std::uint64_t objects = scene.objects.size();
  std::optional<Calendar> calendar = std::move(read->scene.info.calendar);
  *read = {};  // the renderer and the player hold what they need
  const double load_s = watch.seconds();
  Filming filming(request, std::move(player), std::move(*camera), std::move(*renderer), std::move(calendar));
  if (auto done = filming.run(*times); !done) return done;
  print_warnings(filming.renderer(), warned, request.quiet);  // what came up on the way
  if (auto clean = check_validation(filming.renderer()); !clean) return clean;
  remove_stale(request, times->size());
  if (!request.trace.empty()) {
    if (auto written = write_trace(request.trace, filming.trace()); !written)
      return without_pictures_lost(std::move(written.error()), request);
  }
  if (!request.report.empty()) {
    const auto json = report_json(request, filming, load_s, watch.seconds());
    if (auto written = write_file(request.report, pretty(json)); !written)
      return without_pictures_lost(std::move(written.error()), request);
  }
  // A report on stdout must be all there is on it.
  const auto say = [&](const std::string& text) -> Result<void> {
    if (request.report != "-") return write_stdout(text);
    (void)std::fputs(text.c_str(), stderr);
    return {};
  };
  if (request.memory) {
    if (auto written = say(memory_table(filming.memory())); !written) return written;
  }
  if (request.quiet) return {};
  return say(request.folder + "  " + human_count(times->size()) +
             (times->size() == 1 ? " frame  " : " frames  ") + std::to_string(request.drawing.size.x) + "x" +
             std::to_string(request.drawing.size.y) + "  " + human_bytes(filming.bytes()) + "  " +
             human_count(objects) + " objects  " + filming.renderer().device().name + "  " +
             human_seconds(watch.seconds()) + "\n");
}

void add_options(Options& options, FramesRequest& r) {
  options.positional("FILE", r.file, "a .glb or .gltf file");
  options.group("Output");
  options.add("-o,--output", text_value(r.folder, "DIR"),
              "folder for frame_00000.png and so on; made when missing; pictures of an earlier run "
              "do not stay");
  options.add("--size",
              size2_value(r.drawing.size, {1, 1}, {limits::kMaxFrameSide, limits::kMaxFrameSide}, "WxH"),
              "size of the pictures in pixels");
  options.add("--format",
              choice_value<render::PictureFormat>(r.format, {{"png", render::PictureFormat::png},
                                                             {"jpg", render::PictureFormat::jpg},
                                                             {"bmp", render::PictureFormat::bmp}}),
              "form of the pictures");
  options.flag("--ids", r.ids,
               "also ids_00000.png: RGBA, object index = R + 2^8 G + 2^16 B + 2^24 A; all ones: background");
  options.flag("--depth", r.depth, "also depth_00000.pfm: metres along the view direction; inf: background");
  options.flag("--show-nodes", r.show_nodes,
               "boxes of the octree's chunks over the picture: red hidden, green visible, grey not asked "
               "about; with --strategy octree, queries-all, queries or (while it draws by these) adaptive");
  options.add("--report", text_value(r.report, "FILE"), "counts and stage times of every frame as JSON");
  options.add("--trace", text_value(r.trace, "FILE"),
              "one row a frame: camera, choice, predictions, counts, stage times; .csv or .json");
  options.flag("--memory", r.memory, "print what the renderer's memory is for, after the last frame");
  options.group("Time");
  options.add(
      "--times",
      text_value(r.times, "LIST",
                 "seconds, percentages, dates (2024-03-15, 2024-03-15T12:00), FROM:TO:STEP, backwards "
                 "where TO is before FROM; separated by commas"),
      "moments to draw; dates, and steps such as 7d, need a file with a calendar (scenegen schedule)",
      Role::run, "25%,50%,75%,100%");
  options.add("--fps", real_value(r.fps, 0.001, 10000, "N"), "film: pictures a second");
  options.add("--duration", real_value(r.length_s, 0.001, 1e6, "S"),
              "film: seconds that the whole timeline takes", Role::run, "the timeline's own length");
  options.group("View");
  options.add("--camera",
              text_value(r.camera, "NAME|INDEX", "a camera of the file, or auto: frame the whole scene"),
              "camera; a file's camera may crop the scene at another shape of picture than it was made for",
              Role::run, "the file's first, else auto");
  options.add("--camera-path", text_value(r.camera_path, "FILE|NAME", camera_path_range()),
              "camera path: as JSON, or made from the scene (docs/CAMERA_PATH.md)");
  add_drawing_options(options, r.drawing, choice_value<std::string>(r.strategy, render::strategy_choices()),
                      choice_value<std::uint32_t>(r.frames_in_flight, {{"1", 1}, {"2", 2}, {"3", 3}}, "N"));
  add_device_options(options, r.drawing);
  options.group("General");
  options.add_general(r.quiet);
}

}  // namespace

int frames_verb(std::span<const std::string> arguments) {
  if (std::find(arguments.begin(), arguments.end(), "--list-devices") != arguments.end())
    return list_devices_verb();
  FramesRequest request;
  Options options("sceneplay frames", {"sceneplay frames FILE -o DIR [options]"},
                  "plays a file and writes one picture a frame.");
  add_options(options, request);
  const auto check = [&]() -> Result<void> {
    if (request.folder.empty())
      return fail(ErrorKind::usage, "--output", "missing (usage: sceneplay frames FILE -o DIR)");
    if (options.given("--times") && (options.given("--fps") || options.given("--duration")))
      return fail(ErrorKind::usage, "--times", "has no place beside --fps and --duration");
    if (options.given("--camera") && options.given("--camera-path"))
      return fail(ErrorKind::usage, "--camera", "has no place beside --camera-path");
    if (auto known =
            check_strategies({&request.strategy, 1}, request.show_nodes, request.drawing.late_visibility);
        !known)
      return known;
    if (!request.camera_path.empty()) {
      if (auto readable = check_camera_path(request.camera_path); !readable) return readable;
    }
    return check_files(request);
  };
  return run_verb(options, arguments, {.check = check, .work = [&]() -> Result<int> {
                                         Result<void> drawn = draw(request, options);
                                         return drawn ? Result<int>(0) : forward_error(drawn);
                                       }});
}

}  // namespace scenegen::tools
