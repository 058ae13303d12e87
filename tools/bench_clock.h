// How far a benchmark is, and how long the rest will take. Runs that are already there (--resume) or that
// cannot be made take no time and so say nothing of the others.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "tools/output.h"

namespace scenegen::tools {

/// Seconds that `runs` take of which one was at `share` after `run_s`, when `ended` others took `spent_s`
/// together. None as long as nothing is known.
[[nodiscard]] std::optional<double> seconds_left(std::size_t runs, std::size_t ended, double spent_s,
                                                 double run_s, double share);

class BenchClock {
 public:
  BenchClock(std::string label, std::size_t runs, bool quiet);

  void begin();
  void within(double share);  ///< of the run that has begun
  void end();
  void skip(std::size_t runs);
  void clear() { progress_.clear(); }

 private:
  Progress progress_;
  std::size_t runs_;  ///< that have not ended
  std::size_t ended_ = 0;
  double spent_s_ = 0;  ///< in those that have
  Stopwatch watch_;
};

}  // namespace scenegen::tools
