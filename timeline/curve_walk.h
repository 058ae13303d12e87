// Visits the cells of a grid in the order of a curve, without keys, sorting or memory.
#pragma once

#include <algorithm>
#include <bit>

#include "timeline/curves.h"
#include "timeline/hilbert_states.h"

namespace scenegen::timeline {

/// Turns cells of the author's grid into the curve's own axes: axis j of the curve is the j-th named axis,
/// counted from the other end when reversed.
class CurveAxes {
 public:
  CurveAxes(glm::uvec3 cells, const AxisOrder& order) : order_(order) {
    for (int j = 0; j < 3; ++j) size_[j] = cells[order.axis[static_cast<std::size_t>(j)]];
  }
  [[nodiscard]] glm::uvec3 size() const { return size_; }
  [[nodiscard]] glm::uvec3 cell_from_curve(glm::uvec3 on_curve) const {
    glm::uvec3 cell;
    for (int j = 0; j < 3; ++j) {
      const auto k = static_cast<std::size_t>(j);
      cell[order_.axis[k]] = order_.reversed[k] ? size_[j] - 1 - on_curve[j] : on_curve[j];
    }
    return cell;
  }

 private:
  AxisOrder order_;
  glm::uvec3 size_{};
};

namespace walk_detail {

/// Descends the enclosing cube's octree in curve order and leaves out octants that miss the grid, so a walk
/// costs O(cells) on elongated grids too: a level has at most as many nodes as the grid has cells.
template <bool kHilbert, class Visit>
class OctantWalk {
 public:
  OctantWalk(glm::uvec3 size, const Visit& visit) : size_(size), visit_(visit) {}

  void run(unsigned level, unsigned state, glm::uvec3 origin) const {  // recursion: at most 32 deep
    if (level == 0) return visit_(origin);
    --level;
    for (unsigned digit = 0; digit < 8; ++digit) {
      const unsigned octant = kHilbert ? kHilbertStates.octant[state][digit] : digit;
      const glm::uvec3 corner =
          origin + glm::uvec3((octant & 1U) << level, (octant >> 1 & 1U) << level, (octant >> 2) << level);
      if (corner.x >= size_.x || corner.y >= size_.y || corner.z >= size_.z) continue;
      if (level == 0) {
        visit_(corner);
      } else {
        run(level, kHilbert ? kHilbertStates.next[state][octant] : 0, corner);
      }
    }
  }

 private:
  glm::uvec3 size_;
  const Visit& visit_;
};

template <class Visit>
void walk_rows(glm::uvec3 size, const Visit& visit) {
  bool backwards = false;  // of the running row, whatever its layer: odd grids have no jump between layers
  for (std::uint32_t z = 0; z < size.z; ++z) {
    for (std::uint32_t row = 0; row < size.y; ++row) {
      const std::uint32_t y = z % 2 == 0 ? row : size.y - 1 - row;
      for (std::uint32_t i = 0; i < size.x; ++i) visit(glm::uvec3(backwards ? size.x - 1 - i : i, y, z));
      backwards = !backwards;
    }
  }
}

}  // namespace walk_detail

/// Calls visit(cell) for every cell of the grid, in author's coordinates, in the order of the curve.
template <class Visit>
void walk_curve(CurveKind kind, glm::uvec3 cells, const AxisOrder& order, const Visit& visit) {
  const CurveAxes axes(cells, order);
  const auto in_grid = [&](glm::uvec3 on_curve) { visit(axes.cell_from_curve(on_curve)); };
  const glm::uvec3 size = axes.size();
  const std::uint32_t longest = std::max({size.x, size.y, size.z});
  if (std::min({size.x, size.y, size.z}) == 0) return;
  const auto bits = static_cast<unsigned>(std::bit_width(longest - 1));
  switch (kind) {
    case CurveKind::hilbert:
      return walk_detail::OctantWalk<true, decltype(in_grid)>(size, in_grid).run(bits, 0, glm::uvec3(0U));
    case CurveKind::morton:
      return walk_detail::OctantWalk<false, decltype(in_grid)>(size, in_grid).run(bits, 0, glm::uvec3(0U));
    case CurveKind::row_prime:
      return walk_detail::walk_rows(size, in_grid);
  }
}

}  // namespace scenegen::timeline
