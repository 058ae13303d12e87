// Draws the steps of a test scene over and over, and keeps the medians of what each took.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "render/calibration/test_scene.h"
#include "render/renderer.h"

namespace scenegen::render::calibration {

/// Medians over frames, seconds.
struct Stages {
  double update_s = 0;
  double update_octree_s = 0;  ///< of it
  double plan_s = 0;
  double record_s = 0;  ///< and submitting
  double keep_s = 0;    ///< of it recording what is kept, and finding what was
  double device_s = 0;  ///< what the processor waits for one frame, nothing else in flight
  double readback_s = 0;
  double gpu_s = -1;  ///< between the frame's timestamps; -1: none
  [[nodiscard]] double cpu_s() const { return update_s + plan_s + record_s + readback_s; }
};

struct Measured {
  Stages steady;              ///< of frames that are like the one before
  Stages first;               ///< of frames that come from the empty step, or Step::from
  double leave_record_s = 0;  ///< of the empty frame after them: what is read late is read there
  double period_s = 0;        ///< from frame to frame, two in flight; 0: not measured
  FrameReport report;  ///< counts of a steady frame; with RendererOptions::predictions of one that has them
  FrameReport first_report;
  CommandMemoryReport commands;  ///< of all steps together, at the end
  std::size_t samples = 0;
};

struct MeasureOptions {
  /// Steps are measured as long as this is not spent, setting up included, and each in `least_rounds`.
  double budget_s = 5;
  std::size_t least_rounds = 3, most_rounds = 40;
  std::size_t settle = 1;  ///< frames after the first one until they are steady
  std::size_t frames = 2;  ///< steady ones a round
  /// Steps that are expected to take longer are left out.
  double longest_frame_s = 1;
  /// Called after each round with the share of the budget that is spent.
  std::function<void(double)> progress;
};

/// One result a step, in their order; `samples` 0: left out. Steps are visited in turn, so what disturbs the
/// machine for a while disturbs all alike; those of boxes are come to from the empty step. `wanted` says
/// which are measured.
[[nodiscard]] Result<std::vector<Measured>> measure(const TestScene& test, const RendererOptions& options,
                                                    const MeasureOptions& how,
                                                    const std::function<bool(const Step&)>& wanted);

/// 0 of nothing.
[[nodiscard]] double median(std::vector<double> values);
/// The lower of the middle two of an even number. For times that are taken once a visit, so of two or three:
/// the first visit is a cold one, and the upper of two doubled the units of the octree's updates.
[[nodiscard]] double lower_median(std::vector<double> values);

/// Least squares through points (x, y): y = offset + slope x. All of one x: slope 0.
struct Line {
  double offset = 0, slope = 0;
};
[[nodiscard]] Line fit_line(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace scenegen::render::calibration
