// How far predictions of the model are from what frames take (D 5.5): what the experiment model-accuracy and
// the program bench_accuracy measure alike.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "render/renderer.h"
#include "scene/scene.h"

namespace scenegen::tools {

/// The dissertation's four, in its order.
inline constexpr std::array kAccuracyMethods{
    render::model::Method::inline_frustum, render::model::Method::inline_queries,
    render::model::Method::octree, render::model::Method::queries_all};

struct AccuracyRequest {
  std::size_t frames = 100;    ///< at most
  double seconds = 1.0;        ///< after which no further frame begins, once three are measured
  bool two_in_flight = false;  ///< measured after those of one; needs a renderer with two
  /// Is told of every frame that counts.
  std::function<void(const render::FrameReport& report, bool two)> on_frame = {};
};

struct AccuracyRun {
  std::vector<double> one_ms, two_ms;  ///< a frame, with one and with two in flight
  double predicted_one_ms = 0;         ///< with one in flight; median over frames of its own
  render::FrameReport last;            ///< of one with predictions
};

/// What they are drawn with: kept command buffers, as the dissertation does.
[[nodiscard]] render::RendererOptions accuracy_options(render::RendererOptions options,
                                                       render::model::Method method);

/// Frames of the scene at the end of its time, seen from its first camera, one after the other; then two in
/// flight. The first ones, which record what is kept and learn what is hidden, do not count.
[[nodiscard]] Result<AccuracyRun> measure_accuracy(const Scene& scene, render::model::Method method,
                                                   const render::RendererOptions& options,
                                                   const AccuracyRequest& request);

/// In percent of what was measured.
[[nodiscard]] double deviation_percent(double predicted, double measured);

struct DeviationSummary {
  std::size_t count = 0;
  double mean = 0, median = 0, p90 = 0, worst = 0;
};
/// Zeros of nothing.
[[nodiscard]] DeviationSummary summarize_deviations(std::vector<double> percent);

}  // namespace scenegen::tools
