#include "render/model/octree_size.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace scenegen::render::model {

double octree_height(std::uint64_t objects, std::uint32_t per_node) {
  if (objects <= per_node) return 0.0;
  return std::log2(static_cast<double>(objects) / per_node) / 3.0;
}

double octree_nodes(std::uint64_t objects, std::uint32_t per_node) {
  const auto full_levels = static_cast<int>(std::floor(octree_height(objects, per_node)));
  double inner = 0.0;
  double level = 1.0;
  for (int i = 0; i < full_levels; ++i, level *= 8.0) inner += level;
  return std::max(1.0, inner + static_cast<double>(objects) / per_node);
}

double octree_bytes(std::uint64_t objects, std::uint32_t per_node, const CommandMemory& units) {
  const std::uint64_t commands = std::max(units.secondary, per_node * units.command);
  return octree_nodes(objects, per_node) * static_cast<double>(units.node + commands);
}

std::optional<std::uint32_t> objects_per_node(std::uint64_t objects, std::uint64_t available,
                                              const CommandMemory& units, std::uint32_t least) {
  for (const std::uint32_t n : std::array{5U, 10U, 20U, 50U, 100U, 200U, 500U, 1000U}) {
    if (n >= least && octree_bytes(objects, n, units) <= static_cast<double>(available)) return n;
  }
  return std::nullopt;
}

}  // namespace scenegen::render::model
