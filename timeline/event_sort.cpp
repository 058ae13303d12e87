#include "timeline/event_sort.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace scenegen::timeline {

namespace {
/// Unsigned integer in the order of the floats.
std::uint32_t ordered_bits(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}
}  // namespace

void sort_by_time(std::vector<TimedItem>& events) {
  const auto earlier = [](const TimedItem& a, const TimedItem& b) { return a.time_s < b.time_s; };
  if (std::is_sorted(events.begin(), events.end(), earlier)) return;
  constexpr unsigned kBits = 11;
  constexpr std::size_t kBuckets = 1U << kBits;
  if (events.size() < kBuckets) {
    std::stable_sort(events.begin(), events.end(), earlier);
    return;
  }
  std::vector<TimedItem> scratch(events.size());
  for (unsigned shift = 0; shift < 32; shift += kBits) {
    std::array<std::size_t, kBuckets> begin{};
    const auto bucket = [shift](const TimedItem& e) {
      return (ordered_bits(e.time_s + 0.0F) >> shift) & (kBuckets - 1);  // + 0: -0 is 0
    };
    for (const TimedItem& e : events) ++begin[bucket(e)];
    std::size_t sum = 0;
    for (std::size_t& b : begin) sum += std::exchange(b, sum);
    for (const TimedItem& e : events) scratch[begin[bucket(e)]++] = e;
    events.swap(scratch);
  }
}

}  // namespace scenegen::timeline
