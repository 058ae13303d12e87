// How large an octree gets, and how many objects a node should hold (D 3.1.3).
#pragma once

#include <cstdint>
#include <optional>

namespace scenegen::render::model {

/// What one unit costs in memory, bytes.
struct CommandMemory {
  std::uint64_t node = 0;       ///< M_node, chunk included
  std::uint64_t secondary = 0;  ///< M_sec: the least that a secondary command buffer takes
  std::uint64_t command = 0;    ///< M_cmd: a recorded draw
};

/// (3.1) h = log8(objects / per node), not below 0.
[[nodiscard]] double octree_height(std::uint64_t objects, std::uint32_t per_node);
/// (3.2) |H| = sum over i < floor(h) of 8^i, + objects / per node; not below 1.
[[nodiscard]] double octree_nodes(std::uint64_t objects, std::uint32_t per_node);
/// Left side of (3.3): |H| (M_node + max(M_sec, per node * M_cmd)).
[[nodiscard]] double octree_bytes(std::uint64_t objects, std::uint32_t per_node, const CommandMemory& units);
/// The smallest of 5, 10, 20, 50, 100, 200, 500, 1000 that is at least `least` and fits into `available`
/// bytes; none when not even the largest does. D takes the smallest from 5 on.
[[nodiscard]] std::optional<std::uint32_t> objects_per_node(std::uint64_t objects, std::uint64_t available,
                                                            const CommandMemory& units, std::uint32_t least);

}  // namespace scenegen::render::model
