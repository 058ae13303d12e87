#include "gen/extras.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace scenegen::gen {
namespace {
constexpr double kSpare = 1.15;  ///< cell over object: room to stand askew
}

ExtraPlacer::ExtraPlacer(const Layout& layout, std::uint32_t storeys, std::uint32_t count,
                         const glm::dvec3& size_m, std::uint64_t seed)
    : storeys_(storeys),
      count_(count),
      size_m_(glm::max(size_m, glm::dvec3(1e-6))),
      random_(seed, "extra objects") {
  slots_.resize(storeys);
  for (std::uint32_t s = 0; s < storeys && count > 0; ++s) {
    // A common scale: what storey s needs holds for all, so those before are laid again.
    while (!fit(layout, s, scale_, slots_[s])) {
      scale_ *= 0.8;
      for (std::uint32_t t = 0; t < s; ++t) fit(layout, t, scale_, slots_[t]);
    }
  }
}

bool ExtraPlacer::fit(const Layout& layout, std::uint32_t storey, double scale,
                      std::vector<Slot>& slots) const {
  slots.clear();
  const glm::dvec3 size = size_m_ * scale;
  const glm::dvec2 cell = glm::dvec2(size) * kSpare;
  double least_layers = 1e9;
  for (const Room& room : layout.rooms) {
    if (room.storey != storey) continue;
    const glm::dvec3 lo = glm::dvec3(room.box.lo_mm) * 0.001,
                     room_size = glm::dvec3(room.box.hi_mm) * 0.001 - lo;
    const double nx = std::floor(room_size.x / cell.x), ny = std::floor(room_size.y / cell.y);
    if (nx < 1 || ny < 1) continue;
    if (nx * ny > 4.0 * count_ + 64) {
      // More cells than are needed: wider ones, so that the objects spread over the room.
      const double wider = std::sqrt(nx * ny / (4.0 * count_ + 64));
      const double mx = std::max(1.0, std::floor(nx / wider)), my = std::max(1.0, std::floor(ny / wider));
      for (int j = 0; j < static_cast<int>(my); ++j) {
        for (int i = 0; i < static_cast<int>(mx); ++i) {
          const glm::dvec2 wide(room_size.x / mx, room_size.y / my);
          slots.push_back({{lo.x + i * wide.x, lo.y + j * wide.y, lo.z}, wide - glm::dvec2(size)});
        }
      }
    } else {
      const glm::dvec2 wide(room_size.x / nx, room_size.y / ny);
      for (int j = 0; j < static_cast<int>(ny); ++j) {
        for (int i = 0; i < static_cast<int>(nx); ++i) {
          slots.push_back({{lo.x + i * wide.x, lo.y + j * wide.y, lo.z}, wide - glm::dvec2(size)});
        }
      }
    }
    least_layers = std::min(least_layers, std::floor(room_size.z / size.z));
  }
  return !slots.empty() && static_cast<double>(slots.size()) * least_layers >= count_;
}

void ExtraPlacer::place(std::uint64_t building, std::uint32_t storey, std::vector<ExtraPlace>& out) {
  out.clear();
  const std::vector<Slot>& slots = slots_[storey];
  if (slots.empty()) return;
  order_.resize(slots.size());
  std::iota(order_.begin(), order_.end(), 0U);
  const std::uint64_t first = (building * storeys_ + storey) * 4 * (std::uint64_t{count_} + 1);
  const std::size_t drawn = std::min<std::size_t>(count_, slots.size());
  for (std::size_t k = 0; k < drawn; ++k)
    std::swap(order_[k], order_[k + random_.below(first + 4 * k, slots.size() - k)]);
  const glm::dvec3 size = size_m_ * scale_;
  for (std::size_t k = 0; k < count_; ++k) {
    const std::size_t in_layer = k % slots.size(), layer = k / slots.size();
    const Slot& slot = slots[order_[in_layer]];
    // A pile stands straight: its objects share the offset of the lowest.
    const glm::dvec2 askew(random_.unit(first + 4 * in_layer + 1), random_.unit(first + 4 * in_layer + 2));
    const double z = slot.lo_m.z + static_cast<double>(layer) * size.z;
    out.push_back({{slot.lo_m.x + slot.slack_m.x * askew.x + 0.5 * size.x,
                    slot.lo_m.y + slot.slack_m.y * askew.y + 0.5 * size.y, z}});
  }
}

}  // namespace scenegen::gen
