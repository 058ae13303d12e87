// Parts of the experiment octree-or-bvh that its file is too small for.
#pragma once

#include <string>
#include <vector>

#include "render/view.h"
#include "scene/scene.h"
#include "tools/experiments/flat_tree.h"

namespace scenegen::tools {

/// Boxes for an octree that is filled by hand.
struct BoxedObjects {
  std::vector<Box> boxes;
  render::SlotBoxes slots;
  render::Octree::Options options;  ///< the root round all boxes
};
[[nodiscard]] BoxedObjects boxed(const Scene& scene, std::uint32_t per_node);

enum class Height : std::uint8_t { street, roofs };
/// A camera that goes round `bounds` close by, at eye height or above all.
[[nodiscard]] std::vector<render::View> camera_round(const Box& bounds, Height height, std::uint32_t frames);

}  // namespace scenegen::tools
