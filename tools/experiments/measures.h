// What experiments share: medians with spread, cells of tables, runs of several ways of drawing in turn,
// pictures.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "tools/bench_case.h"
#include "tools/experiments/experiment.h"

namespace scenegen::tools {

/// Of repetitions.
struct Spread {
  double median = 0, low = 0, high = 0;
  std::size_t count = 0;
  /// Half of the range in percent of the median.
  [[nodiscard]] double percent() const { return median > 0 ? 50.0 * (high - low) / median : 0; }
};
/// Median, least and greatest. Not of nothing.
[[nodiscard]] Spread spread_of(std::vector<double> values);
/// The largest of some percent(); empty when one was measured only once: it has no spread.
[[nodiscard]] Cell spread_cell(std::initializer_list<Spread> spreads);
[[nodiscard]] double mean_of(const std::vector<double>& values);

/// Milliseconds of the processor's time that `work` takes on this thread: not disturbed by others.
[[nodiscard]] double cpu_milliseconds(const std::function<void()>& work);

/// Empty for what is negative: not measured.
[[nodiscard]] Cell known(double value);
[[nodiscard]] ChartPoint point(double x, const Spread& y);
/// "1.6", "0.012", for sentences: about two significant digits and no exponent.
[[nodiscard]] std::string in_words(double ratio);

/// How often each case is measured.
[[nodiscard]] std::uint32_t repetitions(const ExperimentContext& context, std::uint32_t full,
                                        std::uint32_t quick);
/// What the scene's first camera sees, as it stands in the file, in pictures of the context's shape.
[[nodiscard]] render::View first_camera(const ExperimentContext& context, const Scene& scene);
/// What all drawing in experiments has in common: the context's device, size, samples and costs; no shadows,
/// no picture read back.
[[nodiscard]] render::RendererOptions drawing(const ExperimentContext& context);

/// A way of drawing to be compared.
struct Way {
  std::string label;
  std::string strategy;
  bool late = false;
};

struct WayRuns {
  Way way;
  std::vector<BenchRun> runs;  ///< one a repetition

  /// Of the mean frame times of the repetitions, ms.
  [[nodiscard]] Spread frame_ms() const;
  /// Of the means of a stage of BenchRun::stages; low and high too.
  [[nodiscard]] Spread stage_ms(std::string_view stage) const;
  /// Of frame `frame`.
  [[nodiscard]] Spread frame_ms(std::size_t frame) const;
};

struct Turns {
  std::vector<double> moments;
  std::uint32_t warm_up = 6;
  std::uint32_t repeat = 3;
  std::uint32_t frames_in_flight = 2;
  std::optional<CameraMan> camera = {};  ///< else the scene's first
};
/// Every way over all moments, `repeat` times, another one first each time.
[[nodiscard]] Result<std::vector<WayRuns>> compare_ways(const ExperimentContext& context, const Scene& scene,
                                                        const std::vector<Way>& ways, const Turns& turns);
/// Evenly from `from` to `to`, both included.
[[nodiscard]] std::vector<double> moments_between(double from_s, double to_s, std::uint32_t count);

/// Draws the scene at a time as a PNG into the context's folder.
[[nodiscard]] Result<Picture> take_picture(const ExperimentContext& context, const Scene& scene,
                                           double time_s, const std::string& id, const std::string& title);

/// One that cannot be made (a full disk) is a failure of its own, so that what was measured is kept.
void keep_picture(Result<Picture> picture, std::vector<Picture>& pictures, std::vector<Failure>& failures);

/// `work`, with what it throws as an error: too little memory, a limit of the device. A case that fails so is
/// one that failed; the rest of its experiment goes on.
[[nodiscard]] Result<void> attempt(const std::function<Result<void>()>& work);

/// `verdict` (source, what and why) with both figures and how they stand.
[[nodiscard]] Verdict judged(Verdict verdict, double ours, double paper, const std::string& unit,
                             Better better);
/// `verdict` (source, what, paper, ours and why): whether what the paper says in words is so here.
[[nodiscard]] Verdict judged(Verdict verdict, bool agrees);
/// "12.9 ms", "1.8×", for sentences.
[[nodiscard]] std::string with_unit(double value, const std::string& unit);
/// A reason of device times: that no GPU draws here, where none does.
[[nodiscard]] std::string on_device(const ExperimentContext& context, const std::string& why);
/// What a verdict compares, with " (small scenes)" when --quick made them so.
[[nodiscard]] std::string sized(const ExperimentContext& context, const std::string& what);

/// A step of an experiment's progress line begins.
void begin_step(const ExperimentContext& context, const std::string& what);

}  // namespace scenegen::tools
