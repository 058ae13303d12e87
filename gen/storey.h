// Parts of a building: a ring of four walls with interlocking corners, rooms, openings.
#pragma once

#include <array>
#include <vector>

#include "gen/joinery.h"
#include "gen/plan.h"
#include "gen/wall.h"

namespace scenegen::gen {

/// Walls of a ring: y = 0, y = length, x = 0, x = width.
constexpr std::size_t kFront = 0, kBack = 1, kLeft = 2, kRight = 3;

/// Outer rectangle of a ring of walls, and its courses.
struct Ring {
  glm::ivec2 lo_mm{0}, hi_mm{0};
  int bottom_mm = 0;
  int courses = 0;
};

/// The four walls (front, back, left, right): front and back take the corners in even courses, left and right
/// in odd ones; joints of odd courses are half a brick off those of even ones.
[[nodiscard]] std::array<Wall, 4> ring_walls(const BuildingPlan& plan, const Ring& ring);

/// How a floor is divided: lines of partitions (their lower faces) and their thickness.
struct Division {
  std::vector<int> spines_x_mm;   ///< walls along y at these x, from front to back wall
  std::vector<int> crosses_y_mm;  ///< walls along x at these y, between the spines
  int thickness_mm = 0;
  glm::ivec2 inner_lo_mm{0}, inner_hi_mm{0};

  /// Clear spans between walls along one axis.
  [[nodiscard]] std::vector<Interval> spans(bool along_y) const;
};
[[nodiscard]] Division divide_floor(const BuildingPlan& plan);

/// Slab, outer walls with openings, partitions and rooms of floor `floor`, standing at `bottom_mm`.
void build_storey(const BuildingPlan& plan, int floor, int bottom_mm, LayoutSink& sink);

[[nodiscard]] JoinerySizes joinery_sizes(const BuildingPlan& plan);

}  // namespace scenegen::gen
