// A spatial index in one common form, so that octrees and hierarchies of boxes are walked by the same code.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/spatial/frustum_cull.h"
#include "render/spatial/octree.h"
#include "scene/transform.h"

namespace scenegen::tools {

/// Nodes in the order of a walk from the root, what is below a node directly after it. Whole when moved.
struct FlatTree {
  struct Node {
    Box box_m;                             ///< round all that is below
    std::uint32_t end = 0;                 ///< the first node that is not below
    std::uint32_t first = 0, own_end = 0;  ///< of `objects`: those that this node itself shows
  };
  std::vector<Node> nodes;
  std::vector<std::uint32_t> objects;

  /// Indices into `nodes`.
  [[nodiscard]] std::vector<std::uint32_t> parents() const;
};

/// Number of the nodes that are below none hidden or outside.
struct Walked {
  std::uint64_t nodes = 0;    ///< visited
  std::uint64_t objects = 0;  ///< references to objects in them
};

/// Visits nodes from the root; where `enter` says no, what is below is left out.
template <class Enter, class Visit>
void walk(const FlatTree& tree, const Enter& enter, const Visit& visit) {
  for (std::uint32_t i = 0; i < tree.nodes.size();) {
    if (enter(i)) {
      visit(i);
      ++i;
    } else {
      i = tree.nodes[i].end;
    }
  }
}

/// No plane has the box outside; empty boxes are outside.
[[nodiscard]] bool in_frustum(const render::CullPlanes& planes, const Box& box);
/// All that is in the frustum is walked.
[[nodiscard]] Walked count_in_frustum(const FlatTree& tree, const render::CullPlanes& planes);

/// How an octree's objects are shown and asked about: a node's own objects at once, as in the dissertation,
/// or in chunks with boxes of their own, as in the renderer.
enum class OctreeUnits : std::uint8_t { nodes, chunks };
/// `node_of`, if given: the octree's node that each flat node stands for.
[[nodiscard]] FlatTree flatten(const render::Octree& tree, OctreeUnits units,
                               std::vector<std::uint32_t>* node_of = nullptr);

}  // namespace scenegen::tools
