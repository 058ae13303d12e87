// Where the processor's time goes inside a stage: a clock read at each end, so for parts of a frame, not for
// single objects.
#pragma once

#include <chrono>

namespace scenegen::render {

/// Adds its lifetime to `sum_ms`.
class StageTimer {
 public:
  explicit StageTimer(double& sum_ms) : sum_ms_(sum_ms) {}
  ~StageTimer() {
    sum_ms_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  double& sum_ms_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace scenegen::render
