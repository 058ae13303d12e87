// Accessors of the placements of objects in instancing and merged nodes.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/gltf/write_plan.h"
#include "scene/gltf/write_sink.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// Of one set: TRANSLATION, ROTATION if rotated, SCALE if scaled, _OBJECT_ID but with an id table. Sets
/// whose instances have equal rotations (scales), in the order of the set, share one accessor.
struct InstanceAccessors {
  std::uint32_t translation = 0, rotation = 0, scale = 0, object_id = 0;
  bool own_rotation = false;  ///< the first set that has it: its data are written
  bool own_scale = false;
};

/// Numbered from `first` on: set by set, in the order of the members. Puts the number behind the last
/// into `first`.
[[nodiscard]] std::vector<InstanceAccessors> number_instance_accessors(const Scene& scene,
                                                                       const NodePlan& nodes,
                                                                       std::uint32_t& first);

/// The objects of NodePlan::grouped as LEB128 of the zigzag-coded difference to the one before (the first: to
/// 0).
void write_id_table(const NodePlan& nodes, ByteSink& sink);

}  // namespace scenegen::gltf
