#include "tools/experiments/flat_tree.h"

#include <algorithm>

namespace scenegen::tools {
namespace {

class Flattening {
 public:
  Flattening(const render::Octree& tree, OctreeUnits units, std::vector<std::uint32_t>* node_of)
      : tree_(tree), units_(units), node_of_(node_of) {}

  void add(std::uint32_t number) {
    const render::Octree::Node& node = tree_.node(number);
    if (node.content.slots == 0) return;
    const auto at = static_cast<std::uint32_t>(out_.nodes.size());
    open(node.content.box_m, number);
    for (const std::uint32_t c : node.chunks) {
      const render::Octree::Chunk& chunk = tree_.chunk(c);
      const bool apart = units_ == OctreeUnits::chunks && (node.chunks.size() > 1 || !node.leaf());
      if (apart) open(chunk.content.box_m, number);
      out_.objects.insert(out_.objects.end(), chunk.slots.begin(), chunk.slots.end());
      FlatTree::Node& holder = apart ? out_.nodes.back() : out_.nodes[at];
      holder.own_end = static_cast<std::uint32_t>(out_.objects.size());
      if (apart) holder.end = static_cast<std::uint32_t>(out_.nodes.size());
    }
    if (!node.leaf()) {
      for (std::uint32_t k = 0; k < 8; ++k) add(node.first_child + k);
    }
    out_.nodes[at].end = static_cast<std::uint32_t>(out_.nodes.size());
  }
  FlatTree take() { return std::move(out_); }

 private:
  void open(const Box& box, std::uint32_t number) {
    const auto first = static_cast<std::uint32_t>(out_.objects.size());
    out_.nodes.push_back({box, 0, first, first});
    if (node_of_ != nullptr) node_of_->push_back(number);
  }

  const render::Octree& tree_;
  OctreeUnits units_;
  std::vector<std::uint32_t>* node_of_;
  FlatTree out_;
};

}  // namespace

std::vector<std::uint32_t> FlatTree::parents() const {
  std::vector<std::uint32_t> out(nodes.size(), 0);
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    while (!open.empty() && nodes[open.back()].end <= i) open.pop_back();
    out[i] = open.empty() ? i : open.back();
    open.push_back(i);
  }
  return out;
}

bool in_frustum(const render::CullPlanes& planes, const Box& box) {
  if (box.empty()) return false;
  return std::none_of(planes.all().begin(), planes.all().end(), [&](const render::CullPlane& plane) {
    return render::side_of(plane, box) == render::Side::outside;
  });
}

Walked count_in_frustum(const FlatTree& tree, const render::CullPlanes& planes) {
  Walked out;
  walk(
      tree, [&](std::uint32_t i) { return in_frustum(planes, tree.nodes[i].box_m); },
      [&](std::uint32_t i) {
        ++out.nodes;
        out.objects += tree.nodes[i].own_end - tree.nodes[i].first;
      });
  return out;
}

FlatTree flatten(const render::Octree& tree, OctreeUnits units, std::vector<std::uint32_t>* node_of) {
  Flattening flattening(tree, units, node_of);
  if (tree.node_count() > 0) flattening.add(0);
  return flattening.take();
}

}  // namespace scenegen::tools
