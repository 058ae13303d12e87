// Boxes and sums of an octree's chunks and nodes, kept up to date as slots come and go (octree.cpp puts them
// where they belong).
#include <algorithm>
#include <functional>

#include "render/spatial/octree.h"

namespace scenegen::render {
namespace {

double surface_m2(const Box& b) {
  const glm::dvec3 s(b.size());
  return 2.0 * (s.x * s.y + s.y * s.z + s.z * s.x);
}

void add(Octree::Content& sum, const Octree::Content& part) {
  sum.box_m.add(part.box_m);
  sum.vertices += part.vertices;
  sum.triangles += part.triangles;
  sum.area_m2 += part.area_m2;
}

}  // namespace

void Octree::touch_chunk(std::uint32_t number) {
  Chunk& chunk = chunks_[number];
  chunk.revision = ++revisions_;
  if (!chunk.dirty) dirty_chunks_.push_back(number);
  chunk.dirty = true;
  touch_node(chunk.node);
}

void Octree::touch_node(std::uint32_t number) {
  for (; number != kNone && !nodes_[number].dirty; number = nodes_[number].parent) {
    nodes_[number].dirty = true;
    dirty_nodes_[nodes_[number].level].push_back(number);
  }
}

bool Octree::refresh(std::size_t most_slots) {
  std::size_t seen = 0;
  while (!dirty_chunks_.empty()) {
    Chunk& chunk = chunks_[dirty_chunks_.back()];
    if (seen >= most_slots) return false;
    dirty_chunks_.pop_back();
    if (!chunk.dirty) continue;
    seen += chunk.slots.size();
    refresh_chunk(chunk);
  }
  for (std::size_t level = dirty_nodes_.size(); level-- > 0;) {
    for (const std::uint32_t number : dirty_nodes_[level]) {
      // A number may have been freed, or be in use again at another level, where it is listed too.
      if (nodes_[number].dirty && nodes_[number].level == level) refresh_node(nodes_[number]);
    }
    dirty_nodes_[level].clear();
  }
  return true;
}

void Octree::refresh_chunk(Chunk& chunk) {
  // The order in which slots are drawn. All but those that were added since are in it.
  const auto added = std::is_sorted_until(chunk.slots.begin(), chunk.slots.end());
  if (chunk.slots.end() - added > 16) {
    std::sort(chunk.slots.begin(), chunk.slots.end());
  } else {
    for (auto i = added; i != chunk.slots.end(); ++i)
      std::rotate(std::upper_bound(chunk.slots.begin(), i, *i), i, i + 1);
  }
  if (chunk.stale) {
    chunk.content = {};
    add_content(chunk.content, chunk.slots);
    refreshed_.slots += chunk.slots.size();
  } else if (chunk.loose != 0) {
    tighten(chunk);
  }
  ++refreshed_.chunks;
  chunk.content.slots = static_cast<std::uint32_t>(chunk.slots.size());
  chunk.dirty = chunk.stale = false;
  chunk.loose = 0;
}

void Octree::add_content(Content& to, std::span<const std::uint32_t> slots) const {
  Content sum = to;
  for (const std::uint32_t slot : slots) {
    const Box box = boxes_.get(slot);
    sum.box_m.add(box);
    const Work work = work_of_slot_(slot);
    sum.vertices += work.vertices;
    sum.triangles += work.triangles;
    sum.area_m2 += surface_m2(box);
  }
  to = sum;
}

/// Where something that touched a side has left, another slot may touch it too: in walls the first one looked
/// at.
void Octree::tighten(Chunk& chunk) const {
  Box& box = chunk.content.box_m;
  for (int axis = 0; axis < 3; ++axis) {
    const auto farthest = [&](const std::vector<float>& values, float side, const auto& beyond) {
      float best = values[chunk.slots.front()];
      for (const std::uint32_t slot : chunk.slots) {
        if (values[slot] == side) return side;
        if (beyond(values[slot], best)) best = values[slot];
      }
      return best;
    };
    if ((chunk.loose >> axis & 1) != 0) box.lo[axis] = farthest(boxes_.lo[axis], box.lo[axis], std::less<>());
    if ((chunk.loose >> axis & 8) != 0)
      box.hi[axis] = farthest(boxes_.hi[axis], box.hi[axis], std::greater<>());
  }
}

void Octree::take_content(Chunk& chunk, std::uint32_t slot) {
  if (chunk.stale) return;
  const Box box = boxes_.get(slot);
  Content& sum = chunk.content;
  const Work work = work_of_slot_(slot);
  sum.vertices -= work.vertices;
  sum.triangles -= work.triangles;
  sum.area_m2 = std::max(0.0, sum.area_m2 - surface_m2(box));
  for (int axis = 0; axis < 3; ++axis) {
    if (box.lo[axis] <= sum.box_m.lo[axis]) chunk.loose |= static_cast<std::uint8_t>(1U << axis);
    if (box.hi[axis] >= sum.box_m.hi[axis]) chunk.loose |= static_cast<std::uint8_t>(8U << axis);
  }
}

void Octree::refresh_node(Node& node) {
  Content sum;
  sum.slots = node.content.slots;
  for (const std::uint32_t chunk : node.chunks) add(sum, chunks_[chunk].content);
  if (!node.leaf()) {
    for (std::uint32_t i = 0; i < 8; ++i) add(sum, nodes_[node.first_child + i].content);
  }
  node.content = sum;
  node.revision = ++revisions_;
  node.dirty = false;
}

}  // namespace scenegen::render
