// Sorting events by time.
#pragma once

#include <cstdint>
#include <vector>

namespace scenegen::timeline {

struct TimedItem {
  float time_s = 0;
  std::uint32_t item = 0;
};

/// By time, stably (equal times keep their order). Radix sort, 3 passes of 11 bits; nothing for input that is
/// in order already. Times must not be NaN.
void sort_by_time(std::vector<TimedItem>& events);

}  // namespace scenegen::timeline
