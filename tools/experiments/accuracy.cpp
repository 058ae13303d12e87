#include "tools/experiments/accuracy.h"

#include <algorithm>
#include <cmath>

#include "timeline/timeline.h"
#include "tools/drawing_options.h"
#include "tools/experiments/measures.h"

namespace scenegen::tools {
namespace {

using render::model::Method;

constexpr std::size_t kWarm = 6;   // frames until what is kept is recorded and what is hidden is known
constexpr std::size_t kLeast = 3;  // measured, however long they take
constexpr std::size_t kPredicted = 3;

/// A renderer before a scene that stands still at the end of its time.
class StillScene {
 public:
  StillScene(const Scene& scene, render::Renderer& renderer, timeline::Player& player,
             const render::View& view)
      : renderer_(renderer), player_(player), view_(view), end_s_(static_cast<double>(scene.duration_s)) {}

  Result<void> submit() { return renderer_.submit(player_.seek(end_s_), player_, view_); }
  /// Milliseconds of submitting one and finishing one.
  Result<double> frame() {
    const Stopwatch watch;
    if (auto done = submit(); !done) return forward_error(done);
    if (auto done = renderer_.finish(result_); !done) return forward_error(done);
    return watch.seconds() * 1e3;
  }
  Result<void> finish() { return renderer_.finish(result_); }
  /// A frame with predictions, whose time does not count (Renderer::set_predictions).
  Result<void> predict() {
    renderer_.set_predictions(true);
    Result<double> ms = frame();
    renderer_.set_predictions(false);
    return ms ? Result<void>() : forward_error(ms);
  }
  [[nodiscard]] const render::FrameReport& report() const { return result_.report; }

 private:
  render::Renderer& renderer_;
  timeline::Player& player_;
  render::View view_;
  double end_s_;
  render::FrameResult result_;
};

void tell(const AccuracyRequest& request, const render::FrameReport& report, bool two) {
  if (request.on_frame) request.on_frame(report, two);
}

Result<void> measure_one(StillScene& still, Method method, const render::model::UnitCosts& costs,
                         const AccuracyRequest& request, AccuracyRun& out) {
  const Stopwatch all;
  const auto more = [&] { return out.one_ms.size() < request.frames && all.seconds() < request.seconds; };
  for (std::size_t i = 0; i < kWarm + kLeast || more(); ++i) {
    auto ms = still.frame();
    if (!ms) return forward_error(ms);
    if (i < kWarm) continue;
    out.one_ms.push_back(*ms);
    tell(request, still.report(), false);
  }
  std::vector<double> predicted_ms;
  for (std::size_t i = 0; i < kPredicted; ++i) {
    if (auto done = still.predict(); !done) return done;
    predicted_ms.push_back(
        render::model::predict(method, still.report().facts, costs, {.frames_in_flight = 1}).frame_s * 1e3);
  }
  out.predicted_one_ms = spread_of(std::move(predicted_ms)).median;
  return {};
}

Result<void> measure_two(StillScene& still, const AccuracyRequest& request, AccuracyRun& out) {
  if (auto done = still.submit(); !done) return done;
  const std::size_t frames = std::max<std::size_t>(kLeast + 1, out.one_ms.size());
  for (std::size_t i = 0; i < frames; ++i) {
    auto ms = still.frame();
    if (!ms) return forward_error(ms);
    if (i == 0) continue;
    out.two_ms.push_back(*ms);
    tell(request, still.report(), true);
  }
  return still.finish();
}

}  // namespace

render::RendererOptions accuracy_options(render::RendererOptions options, Method method) {
  options.strategy = std::string(name_of(method));
  options.how.node_form = render::NodeForm::secondaries;
  options.outputs.readback = true;  // calibration's T_0 has copying the picture out in it
  return options;
}

Result<AccuracyRun> measure_accuracy(const Scene& scene, Method method,
                                     const render::RendererOptions& options, const AccuracyRequest& request) {
  auto camera = CameraMan::of_scene(scene, "", options.size);
  if (!camera) return forward_error(camera);
  timeline::Player player(timeline::compile(scene));
  player.seek(static_cast<double>(scene.duration_s));
  auto renderer = render::Renderer::create(scene, player, options);
  if (!renderer) return forward_error(renderer);
  renderer->set_predictions(false);  // but for frames of their own
  const bool software = options.shared_device && render::info_of(*options.shared_device).type == "CPU";
  const render::model::UnitCosts costs = options.costs.value_or(render::model::rough_costs(software));
  StillScene still(scene, *renderer, player, camera->view(player));
  AccuracyRun out;
  if (auto done = measure_one(still, method, costs, request, out); !done) return forward_error(done);
  if (request.two_in_flight) {
    if (auto done = measure_two(still, request, out); !done) return forward_error(done);
  }
  if (auto done = still.predict(); !done) return forward_error(done);
  out.last = still.report();
  return out;
}

double deviation_percent(double predicted, double measured) {
  return 100.0 * std::abs(predicted - measured) / measured;
}

DeviationSummary summarize_deviations(std::vector<double> percent) {
  if (percent.empty()) return {};
  std::sort(percent.begin(), percent.end());
  const std::size_t n = percent.size();
  return {n, mean_of(percent), spread_of(percent).median, percent[std::min(n - 1, n * 9 / 10)],
          percent.back()};
}

}  // namespace scenegen::tools
