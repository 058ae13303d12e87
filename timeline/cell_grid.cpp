#include "timeline/cell_grid.h"

namespace scenegen::timeline {

Box z_up_from_y_up(const Box& b) {
  // z changes sign, so its ends change places; + 0 turns -0 into 0.
  return {scenegen::z_up_from_y_up({b.lo.x, b.lo.y, b.hi.z}) + 0.0F,
          scenegen::z_up_from_y_up({b.hi.x, b.hi.y, b.lo.z}) + 0.0F};
}

CellGrid::CellGrid(glm::uvec3 cells, const Box& box_z_up_m) : cells_(cells), lo_(box_z_up_m.lo) {
  const glm::dvec3 size = glm::dvec3(box_z_up_m.hi) - lo_;
  for (int i = 0; i < 3; ++i) per_m_[i] = size[i] > 0 ? cells[i] / size[i] : 0.0;
}

std::size_t CellGrid::cell(const Box& world_y_up_m) const {
  const glm::dvec3 twice = glm::dvec3(world_y_up_m.lo) + glm::dvec3(world_y_up_m.hi);
  const glm::dvec3 centre(0.5 * twice.x, -0.5 * twice.z, 0.5 * twice.y);
  glm::uvec3 at;
  for (int i = 0; i < 3; ++i) {
    const double u = (centre[i] - lo_[i]) * per_m_[i] + cells_[i] * 0x1p-21;
    at[i] = !(u > 0) ? 0U : u >= cells_[i] ? cells_[i] - 1 : static_cast<std::uint32_t>(u);
  }
  return at.x + std::size_t{cells_.x} * (at.y + std::size_t{cells_.y} * at.z);
}

std::vector<Box> placed_bounds(const Scene& scene, unsigned threads) {
  std::vector<Box> bounds = object_bounds(scene, threads);
  std::vector<glm::mat4> frames;
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    if (!bounds[i].empty()) continue;
    if (frames.empty()) frames = rest_frame_matrices(scene);
    bounds[i] = {};
    bounds[i].add(glm::vec3(rest_world_from_object(scene, frames, ObjectId(i))[3]));
  }
  return bounds;
}

}  // namespace scenegen::timeline
