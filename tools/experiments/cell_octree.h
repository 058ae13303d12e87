// Octrees of a given height, with one reference to an object or many (D 5.2, figures 5.12 to 5.15).
#pragma once

#include <optional>

#include "tools/experiments/flat_tree.h"

namespace scenegen::tools {

enum class References : std::uint8_t {
  single,   ///< an object lives in the deepest cell that contains its box
  multiple  ///< in every cell of the last level that its box touches
};

/// The root's cell is the cube round all boxes; cells with objects are divided down to `height` levels below
/// it. None when it would hold more than `most_references`.
[[nodiscard]] std::optional<FlatTree> build_cell_octree(std::span<const Box> boxes, std::uint32_t height,
                                                        References references,
                                                        std::uint64_t most_references = 1ULL << 26);

}  // namespace scenegen::tools
