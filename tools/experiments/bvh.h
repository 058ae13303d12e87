// Hierarchies of boxes that the dissertation compares its octree with (D 5.2). Experiment code: the renderer
// has an octree.
#pragma once

#include <span>

#include "tools/experiments/flat_tree.h"

namespace scenegen::tools {

/// Top down by the surface area heuristic over 16 bins an axis (Wald 2007, "On fast construction of SAH-based
/// bounding volume hierarchies"); a node of at most `per_leaf` objects is a leaf. `objects` index `boxes`.
[[nodiscard]] FlatTree build_bvh_sah(std::span<const Box> boxes, std::span<const std::uint32_t> objects,
                                     std::uint32_t per_leaf);

/// Objects sorted along a Morton curve of 2^10 cells an axis, split where the highest bit of their codes
/// changes (Lauterbach et al. 2009, "Fast BVH construction on GPUs").
[[nodiscard]] FlatTree build_lbvh(std::span<const Box> boxes, std::span<const std::uint32_t> objects,
                                  std::uint32_t per_leaf);

/// A hierarchy over all objects that will ever be there, of which only some are: what appears or vanishes
/// changes the boxes above it and no node goes away. What can be done instead of building anew when the
/// future is known, as it is in a plan.
class RefitBvh {
 public:
  RefitBvh(std::span<const Box> boxes, std::uint32_t per_leaf);
  void show(std::uint32_t object) { set(object, true); }
  void hide(std::uint32_t object) { set(object, false); }
  /// Boxes of what was touched, and of what is above it. O(touched leaves * height).
  void refit();
  /// Its objects are all there are; those that are not there must be left out by whoever walks it.
  [[nodiscard]] const FlatTree& tree() const { return tree_; }
  [[nodiscard]] bool there(std::uint32_t object) const { return there_[object] != 0; }

 private:
  void set(std::uint32_t object, bool there);
  std::span<const Box> boxes_;
  FlatTree tree_;
  std::vector<std::uint32_t> parents_;
  std::vector<std::uint32_t> leaf_of_;
  std::vector<std::uint8_t> there_;
  std::vector<std::uint32_t> touched_;
  std::vector<std::uint8_t> is_touched_;
};

}  // namespace scenegen::tools
