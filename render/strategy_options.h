// What can be chosen about strategies, without Vulkan's headers.
#pragma once

#include <cstdint>

namespace scenegen::render {

struct StrategyOptions {
  bool reversed = false;  ///< draw solid slots in reverse order: finds pixels where equal depths meet
  std::uint32_t objects_per_node = 0;  ///< of the octree; 0: chosen so that it fits, from 100 on
  /// What the octree and its command buffers may take (3.3); when it does not fit, `inline` is used.
  std::uint64_t octree_bytes = 1ULL << 30;
  /// For tests: allocating more cached command buffers than this fails as if memory were out; 0: never.
  std::uint64_t fail_after_buffers = 0;
};

}  // namespace scenegen::render
