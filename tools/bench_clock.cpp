#include "tools/bench_clock.h"

#include <algorithm>
#include <utility>

namespace scenegen::tools {

std::optional<double> seconds_left(std::size_t runs, std::size_t ended, double spent_s, double run_s,
                                   double share) {
  const double done = static_cast<double>(ended) + share;
  if (runs == 0) return 0.0;
  if (!(done > 0)) return std::nullopt;
  return (spent_s + run_s) / done * std::max(0.0, static_cast<double>(runs) - share);
}

BenchClock::BenchClock(std::string label, std::size_t runs, bool quiet)
    : progress_(std::move(label), 0, quiet), runs_(runs) {}

void BenchClock::begin() {
  watch_ = Stopwatch();
}

void BenchClock::within(double share) {
  const double run_s = watch_.seconds();
  if (const auto left_s = seconds_left(runs_, ended_, spent_s_, run_s, share))
    progress_.show(spent_s_ + run_s, *left_s);
}

void BenchClock::end() {
  spent_s_ += watch_.seconds();
  ++ended_;
  skip(1);
}

void BenchClock::skip(std::size_t runs) {
  runs_ -= std::min(runs_, runs);
}

}  // namespace scenegen::tools
