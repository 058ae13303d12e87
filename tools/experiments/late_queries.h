// What an index shows when its nodes are asked about by occlusion queries whose answers come frames later
// (D 5.2), with the processor's depth pictures in the place of a device's.
#pragma once

#include <vector>

#include "tools/experiments/flat_tree.h"
#include "tools/experiments/software_depth.h"

namespace scenegen::tools {

/// Means over the frames that count.
struct LateWalk {
  double shown = 0;    ///< objects of nodes that are in the frustum and not below one believed hidden
  double missed = 0;   ///< objects that a pixel shows and that were not among them: answers came too late
  double queries = 0;  ///< nodes asked about
};

struct LateWalkOptions {
  std::uint32_t latency = 2;  ///< frames until an answer is read
  std::uint32_t warm_up = 4;  ///< first frames that do not count
};

/// `depths`: of all objects, one a frame. `objects`: how many there are.
[[nodiscard]] LateWalk walk_with_late_queries(const FlatTree& tree, std::span<const render::View> views,
                                              std::span<const SoftwareDepth> depths, std::size_t objects,
                                              const LateWalkOptions& options);

}  // namespace scenegen::tools
