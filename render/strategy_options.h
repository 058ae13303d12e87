// What can be chosen about strategies, without Vulkan's headers.
#pragma once

#include <cstdint>

namespace scenegen::render {

/// How the draws of an octree's chunk are kept.
enum class NodeForm : std::uint8_t {
  automatic,    ///< what costs less on the device
  secondaries,  ///< a secondary command buffer
  indirect      ///< commands in device memory, drawn by one indirect draw for each pipeline state
};

struct StrategyOptions {
  bool reversed = false;  ///< draw solid slots in reverse order: finds pixels where equal depths meet
  std::uint32_t objects_per_node = 0;  ///< of the octree; 0: chosen so that it fits, from 200 on
  /// What the octree and its command buffers may take (3.3); when it does not fit, `inline` is used.
  std::uint64_t octree_bytes = 1ULL << 30;
  /// Believe old results of occlusion queries instead of checking them in the same frame (as the dissertation
  /// does): saves work, and objects that come into view appear some frames too late.
  bool late_visibility = false;
  NodeForm node_form = NodeForm::automatic;
  /// For calibration: indirect draws are one a slot, though neighbours may be instances of one.
  bool single_draws = false;
  /// For tests: as if the device had no indirect draws with a count.
  bool no_indirect_draws = false;
  /// For tests: as if the device had no conditional rendering.
  bool no_conditional_rendering = false;
  /// How the process grows while commands are kept is measured: some microseconds a frame.
  bool measure_commands = false;
  /// `adaptive`: predictions are corrected, slowly, by what frames took.
  bool correction = true;
  /// For tests: `adaptive` takes another way every so many frames, whatever it costs; 0: never.
  std::uint32_t change_every = 0;
  /// For tests: keeping the commands of more chunks than this fails as if memory were out; 0: never.
  std::uint64_t fail_after_buffers = 0;
};

}  // namespace scenegen::render
