// The grid of cells that a curve runs through, over the objects of a scene.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace scenegen::timeline {

[[nodiscard]] Box z_up_from_y_up(const Box& box_y_up_m);

/// The grid of cells over a box, author's frame.
class CellGrid {
 public:
  CellGrid(glm::uvec3 cells, const Box& box_z_up_m);
  /// Index x + cells.x * (y + cells.y * z) of the cell that holds the centre of a world box. What lies on the
  /// border of two cells is of the upper one. Bricks stand in rows, so centres on borders are common, and in
  /// float32 they lie a few ulp to either side: a centre within 2^-21 of the grid's size below a border (4
  /// ulp) counts as on it, so that a row does not fall apart, however the file spells its transforms.
  [[nodiscard]] std::size_t cell(const Box& world_y_up_m) const;

 private:
  glm::uvec3 cells_;
  glm::dvec3 lo_;
  glm::dvec3 per_m_{};
};

/// World boxes at rest; an object without vertices is a point at its origin.
[[nodiscard]] std::vector<Box> placed_bounds(const Scene& scene, unsigned threads);

}  // namespace scenegen::timeline
