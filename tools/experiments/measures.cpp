#include "tools/experiments/measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <new>
#include <numeric>
#include <stdexcept>

#include "render/image_file.h"
#include "timeline/timeline.h"
#include "tools/report/report.h"

namespace scenegen::tools {

Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {0.5 * (values[(n - 1) / 2] + values[n / 2]), values.front(), values.back(), n};
}

Cell spread_cell(std::initializer_list<Spread> spreads) {
  double most = 0;
  for (const Spread& s : spreads) {
    if (s.count < 2) return {};
    most = std::max(most, s.percent());
  }
  return most;
}

double mean_of(const std::vector<double>& values) {
  return values.empty()
             ? 0.0
             : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double cpu_milliseconds(const std::function<void()>& work) {
  const auto now_ms = [] {
    timespec t{};
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
  };
  const double start_ms = now_ms();
  work();
  return now_ms() - start_ms;
}

Cell known(double value) {
  if (value < 0) return {};
  return value;
}

ChartPoint point(double x, const Spread& y) {
  return {x, y.median, y.low, y.high};
}

std::string in_words(double ratio) {
  std::array<char, 32> text{};
  const int digits = ratio >= 10 ? 0 : ratio >= 1 ? 1 : ratio >= 0.1 ? 2 : 3;
  (void)std::snprintf(text.data(), text.size(), "%.*f", digits, ratio);
  return text.data();
}

render::View first_camera(const ExperimentContext& context, const Scene& scene) {
  const float aspect = static_cast<float>(context.width) / static_cast<float>(context.height);
  return render::view_of_camera(scene.cameras.front(), scene.cameras.front().frame_from_camera.matrix(),
                                aspect);
}

std::uint32_t repetitions(const ExperimentContext& context, std::uint32_t full, std::uint32_t quick) {
  return context.repeat.value_or(context.quick ? quick : full);
}

render::RendererOptions drawing(const ExperimentContext& context) {
  render::RendererOptions o;
  o.shared_device = context.device;
  o.size = {context.width, context.height};
  o.samples = context.samples;
  o.shadows = false;
  o.outputs.readback = false;
  o.costs = context.costs;
  return o;
}

Spread WayRuns::frame_ms() const {
  std::vector<double> means;
  means.reserve(runs.size());
  for (const BenchRun& run : runs) means.push_back(mean_of(run.frame_ms));
  return spread_of(std::move(means));
}

Spread WayRuns::stage_ms(std::string_view stage) const {
  std::vector<double> means;
  for (const BenchRun& run : runs) {
    const auto found = std::find(run.stages.begin(), run.stages.end(), stage);
    if (found == run.stages.end()) return {-1, -1, -1, 0};
    const std::vector<double>& values = run.stages_ms[static_cast<std::size_t>(found - run.stages.begin())];
    // One frame without a figure (a device without timestamps) and the mean says nothing.
    if (std::any_of(values.begin(), values.end(), [](double v) { return v < 0; })) return {-1, -1, -1, 0};
    means.push_back(mean_of(values));
  }
  return spread_of(std::move(means));
}

Spread WayRuns::frame_ms(std::size_t frame) const {
  std::vector<double> values;
  values.reserve(runs.size());
  for (const BenchRun& run : runs) values.push_back(run.frame_ms[frame]);
  return spread_of(std::move(values));
}

Result<std::vector<WayRuns>> compare_ways(const ExperimentContext& context, const Scene& scene,
                                          const std::vector<Way>& ways, const Turns& turns) {
  auto camera = turns.camera ? Result<CameraMan>(*turns.camera)
                             : CameraMan::of_scene(scene, "", {context.width, context.height});
  if (!camera) return forward_error(camera);
  const std::shared_ptr<const timeline::Timeline> timeline = timeline::compile(scene);
  std::vector<WayRuns> out;
  std::vector<BenchSeat> seats;
  for (const Way& way : ways) {
    render::RendererOptions o = drawing(context);
    o.strategy = way.strategy;
    o.how.late_visibility = way.late;
    o.frames_in_flight = turns.frames_in_flight;
    seats.emplace_back(scene, timeline, *camera, o);
    out.push_back({way, {}});
  }
  for (std::uint32_t repetition = 0; repetition < turns.repeat; ++repetition) {
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const std::size_t at = (i + repetition) % ways.size();
      auto run = seats[at].run(turns.moments, turns.warm_up, [](std::size_t, std::size_t) {});
      if (!run) return forward_error(run);
      out[at].runs.push_back(std::move(*run));
      begin_step(context, ways[at].label);
    }
  }
  return out;
}

std::vector<double> moments_between(double from_s, double to_s, std::uint32_t count) {
  std::vector<double> out;
  out.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i)
    out.push_back(count == 1 ? to_s : from_s + (to_s - from_s) * i / static_cast<double>(count - 1));
  return out;
}

Result<Picture> take_picture(const ExperimentContext& context, const Scene& scene, double time_s,
                             const std::string& id, const std::string& title) {
  const glm::uvec2 size(640, 360);
  auto camera = CameraMan::of_scene(scene, "", size);
  if (!camera) return forward_error(camera);
  timeline::Player player(timeline::compile(scene));
  const timeline::ChangeSet& changes = player.seek(time_s);
  render::RendererOptions o = drawing(context);
  o.size = size;
  o.samples = 4;
  o.outputs.readback = true;
  auto renderer = render::Renderer::create(scene, player, o);
  if (!renderer) return forward_error(renderer);
  render::FrameResult frame;
  if (auto done = renderer->submit(changes, player, camera->view(player)); !done) return forward_error(done);
  if (auto done = renderer->finish(frame); !done) return forward_error(done);
  const std::string file = id + ".png";
  const auto written = write_file((std::filesystem::path(context.folder) / file).string(),
                                  render::encode_picture(render::PictureFormat::png, size, frame.rgba));
  if (!written) return tl::unexpected<Error>(written.error());
  return Picture{"picture-" + id, title, file, {}};
}

void keep_picture(Result<Picture> picture, std::vector<Picture>& pictures, std::vector<Failure>& failures) {
  if (picture) {
    pictures.push_back(std::move(*picture));
  } else {
    failures.push_back({"a picture", picture.error().str()});
  }
}

Result<void> attempt(const std::function<Result<void>()>& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::no_device, "memory", "is too little");
  } catch (const std::runtime_error& error) {
    return fail(ErrorKind::no_device, "device", error.what());
  }
}

std::string with_unit(double value, const std::string& unit) {
  const bool close = unit == "\u00D7" || unit.empty();
  return figure_text(value) + (close ? "" : " ") + unit;
}

Verdict judged(Verdict verdict, double ours, double paper, const std::string& unit, Better better) {
  verdict.ours = with_unit(ours, unit);
  verdict.paper = with_unit(paper, unit);
  verdict.finding = finding_of(ours, paper, better);
  return verdict;
}

Verdict judged(Verdict verdict, bool agrees) {
  verdict.finding = agrees ? Finding::agrees : Finding::differs;
  return verdict;
}

std::string on_device(const ExperimentContext& context, const std::string& why) {
  return context.device_info.type == "CPU" ? "the processor draws here, not a GPU; " + why : why;
}

std::string sized(const ExperimentContext& context, const std::string& what) {
  return context.quick ? what + " (small scenes)" : what;
}

void begin_step(const ExperimentContext& context, const std::string& what) {
  if (context.progress == nullptr) return;
  context.progress->stage(what);
  context.progress->advance(0);
}

}  // namespace scenegen::tools
