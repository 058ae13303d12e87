// Sorts points along the Hilbert curve: keys, then a radix sort of (key, index).
#include <algorithm>
#include <cassert>
#include <memory>

#include "scene/transform.h"
#include "timeline/curves.h"

namespace scenegen::timeline {
namespace {

constexpr unsigned kBits = 21;  // 63-bit keys; a float32 coordinate has 24 bits

struct Keyed {
  std::uint64_t key;
  std::uint32_t index;
};

/// Least significant digit first, 11 bits a pass: six passes for 63 bits, histograms of 8 KiB. All histograms
/// are counted in one sweep; a pass whose digit is the same everywhere is left out. Stable.
class RadixSort {
 public:
  static constexpr unsigned kDigitBits = 11;
  static constexpr unsigned kPasses = (3 * kBits + kDigitBits - 1) / kDigitBits;

  void count(std::uint64_t key) {
    for (unsigned pass = 0; pass < kPasses; ++pass) ++histogram_[pass][digit(key, pass)];
  }
  /// Sorts `items` by key, with `spare` of the same length; returns the one of the two that is sorted.
  Keyed* sort(Keyed* items, Keyed* spare, std::size_t size) {
    for (unsigned pass = 0; pass < kPasses; ++pass) {
      auto& place = histogram_[pass];
      if (place[digit(items[0].key, pass)] == size) continue;
      std::uint32_t next = 0;
      for (std::uint32_t& p : place) next += std::exchange(p, next);
      for (std::size_t i = 0; i < size; ++i) spare[place[digit(items[i].key, pass)]++] = items[i];
      std::swap(items, spare);
    }
    return items;
  }

 private:
  static std::size_t digit(std::uint64_t key, unsigned pass) {
    return key >> (pass * kDigitBits) & ((1U << kDigitBits) - 1);
  }
  std::array<std::array<std::uint32_t, 1U << kDigitBits>, kPasses> histogram_{};
};

}  // namespace

std::vector<std::uint32_t> hilbert_order(std::span<const glm::vec3> points_m) {
  if (points_m.empty()) return {};
  assert(points_m.size() <= std::numeric_limits<std::uint32_t>::max());
  Box box;
  for (const glm::vec3& p : points_m) box.add(p);
  const glm::dvec3 lo(box.lo);
  const glm::dvec3 side = glm::dvec3(box.hi) - lo;
  const double longest = std::max({side.x, side.y, side.z});
  // The last cell reaches up to and includes the box's far faces.
  const double scale = longest > 0 ? ((1U << kBits) - 1) / longest : 0.0;

  const std::size_t size = points_m.size();
  const auto items = std::make_unique_for_overwrite<Keyed[]>(size);
  const auto spare = std::make_unique_for_overwrite<Keyed[]>(size);
  const auto sort = std::make_unique<RadixSort>();
  constexpr std::size_t kBlock = 512;
  std::array<glm::uvec3, kBlock> cells;
  std::array<std::uint64_t, kBlock> keys;
  for (std::size_t begin = 0; begin < size; begin += kBlock) {
    const std::size_t count = std::min(kBlock, size - begin);
    for (std::size_t i = 0; i < count; ++i) {
      cells[i] = glm::uvec3((glm::dvec3(points_m[begin + i]) - lo) * scale);
    }
    hilbert_keys(cells.data(), count, kBits, keys.data());
    for (std::size_t i = 0; i < count; ++i) {
      items[begin + i] = {keys[i], static_cast<std::uint32_t>(begin + i)};
      sort->count(keys[i]);
    }
  }
  const Keyed* sorted = sort->sort(items.get(), spare.get(), size);
  std::vector<std::uint32_t> order(size);
  for (std::size_t i = 0; i < size; ++i) order[i] = sorted[i].index;
  return order;
}

}  // namespace scenegen::timeline
