#include "render/strategy/touched_chunks.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace scenegen::render {

model::TouchedChunks ChunksTouched::count(const timeline::ChangeSet& changes) {
  if (changes.count() == 0) return {};
  set_cells();
  return {different({changes.shown, changes.hidden, changes.remeshed}),
          different({changes.shown, changes.hidden, changes.remeshed, changes.moved}),
          different({changes.hidden, changes.moved})};
}

void ChunksTouched::set_cells() {
  const Box& all = scene_.bounds_m();
  const glm::dvec3 size = glm::max(glm::dvec3(all.size()), glm::dvec3(1e-3));
  const double visible = static_cast<double>(scene_.visible_object_count()) /
                         std::max(1.0, static_cast<double>(scene_.object_count()));
  const double cells = std::max(1.0, visible * static_cast<double>(scene_.solid_end()) / (0.7 * per_node_));
  per_m_ = std::cbrt(cells / (size.x * size.y * size.z));
  lo_ = all.lo;
}

/// 0: it is nowhere.
std::uint64_t ChunksTouched::cell_of(ObjectId id) const {
  const auto slots = scene_.slots_of(id);
  if (slots.empty()) return 0;
  const Box box = scene_.boxes().get(slots.front());
  if (box.empty()) return 0;
  const glm::dvec3 at = (glm::dvec3(box.centre()) - lo_) * per_m_;
  std::uint64_t cell = 1;
  for (int axis = 0; axis < 3; ++axis)
    cell = cell << 21U | static_cast<std::uint64_t>(std::clamp(at[axis], 0.0, 2e6));
  return cell;
}

double ChunksTouched::different(std::initializer_list<Ids> lists) const {
  std::size_t all = 0;
  for (const Ids& list : lists) all += list.size();
  if (all == 0) return 0.0;
  const std::size_t sampled = std::min(all, kSampled);
  std::array<std::uint64_t, kSampled> cells{};
  for (std::size_t i = 0; i < sampled; ++i) {
    std::size_t at = (2 * i + 1) * all / (2 * sampled);
    for (const Ids& list : lists) {
      if (at < list.size()) {
        cells[i] = cell_of(list[at]);
        break;
      }
      at -= list.size();
    }
  }
  std::array<std::uint64_t, kSampled>::iterator end = cells.begin() + static_cast<std::ptrdiff_t>(sampled);
  std::sort(cells.begin(), end);
  const auto found = std::unique(cells.begin(), end) - cells.begin() - (cells[0] == 0 ? 1 : 0);
  return model::different_among(static_cast<double>(all), static_cast<double>(sampled),
                                static_cast<double>(found));
}

}  // namespace scenegen::render
