// How many objects a node of the octree holds, whether the octree fits into memory (D 3.1.3), and in which
// form the commands of a chunk are kept.
#pragma once

#include <cstdint>
#include <optional>

#include "render/model/octree_size.h"
#include "render/spatial/octree.h"
#include "render/strategy/strategy.h"

namespace scenegen::render {

/// What a kept command buffer should hold at least. lavapipe: 20.9 us a draw with one in it, 2.6 with 10, 1.6
/// with 100, 1.4 with 1000. NVIDIA H100: 0.7 to 1.8 us of the processor's time for every one executed, most
/// of it in vkQueueSubmit, whatever is in it; but a change records all of a chunk again (docs/BENCHMARKS.md).
constexpr std::uint32_t kObjectsPerNode = 200;

/// The same of indirect draws: each run of one state is a command of the processor, 0.2 us of an NVIDIA
/// H200's time whatever is in it, and larger chunks have longer runs of instances. From above test set 32
/// takes it 13.8 ms with 200, 12.9 with 500; queries lose nothing (docs/BENCHMARKS.md).
constexpr std::uint32_t kObjectsPerIndirectNode = 500;

/// M_node: a node and a chunk of it.
constexpr std::uint64_t kNodeBytes = sizeof(Octree::Node) + sizeof(Octree::Chunk);
/// What an octree with kept command buffers takes, by the unit costs.
[[nodiscard]] inline model::CommandMemory secondary_memory(const model::UnitCosts& costs) {
  return {kNodeBytes, static_cast<std::uint64_t>(costs.secondary_bytes),
          static_cast<std::uint64_t>(costs.command_bytes)};
}
/// Indirect draws: 20 B each, in places that are a sixteenth too large in the mean.
constexpr model::CommandMemory kIndirectMemory{kNodeBytes, 0, 22};

/// Can this device draw chunks by indirect draws, and is it to?
[[nodiscard]] bool can_draw_indirect(const StrategyContext& context);
/// The form of a chunk that was asked for; `automatic` takes the one that costs less by the unit costs there
/// are at the start, and indirect draws where exact queries would not be possible otherwise.
[[nodiscard]] bool indirect_nodes(const StrategyContext& context);

/// The number asked for, or the smallest from those above on that fits; none when it does not fit.
[[nodiscard]] inline std::optional<std::uint32_t> choose_objects_per_node(const StrategyContext& context) {
  const StrategyOptions& o = context.options;
  const std::uint64_t objects = context.scene.solid_end();
  const model::CommandMemory units =
      indirect_nodes(context) ? kIndirectMemory : secondary_memory(context.costs);
  if (o.objects_per_node == 0)
    return model::objects_per_node(objects, o.octree_bytes, units,
                                   indirect_nodes(context) ? kObjectsPerIndirectNode : kObjectsPerNode);
  const double bytes = model::octree_bytes(objects, o.objects_per_node, units);
  return bytes <= static_cast<double>(o.octree_bytes) ? std::optional(o.objects_per_node) : std::nullopt;
}

}  // namespace scenegen::render
