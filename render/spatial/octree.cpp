#include "render/spatial/octree.h"
#include "scene/held_bytes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace scenegen::render {
namespace {

/// Every third bit of 63, from 21.
std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 32) & 0x1F00000000FFFFULL;
  v = (v | v << 16) & 0x1F0000FF0000FFULL;
  v = (v | v << 8) & 0x100F00F00F00F00FULL;
  v = (v | v << 4) & 0x10C30C30C30C30C3ULL;
  return (v | v << 2) & 0x1249249249249249ULL;
}

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

Octree::Octree(const SlotBoxes& boxes, std::function<Work(std::uint32_t)> work_of_slot,
               const Options& options)
    : boxes_(boxes),
      work_of_slot_(std::move(work_of_slot)),
      options_(options),
      chunk_of_slot_(options.slots, kNone),
      fits_(options.slots, 0),
      dirty_nodes_(options.most_levels + 1) {
  assert(options.slots_per_node > 0);
  clear();
}

void Octree::clear() {
  // Chunk numbers are kept, so that their revisions go on: what others remember of a chunk never fits again.
  for (std::uint32_t i = 0; i < chunks_.size(); ++i) {
    if (chunks_[i].node != kNone) free_chunk(i);
  }
  std::fill(chunk_of_slot_.begin(), chunk_of_slot_.end(), kNone);
  nodes_.clear();
  free_children_.clear();
  dirty_chunks_.clear();
  for (auto& level : dirty_nodes_) level.clear();
  Node& root = nodes_.emplace_back();
  if (options_.root_m.empty()) return;
  root.centre_m = options_.root_m.centre();
  const glm::vec3 size = options_.root_m.size();
  root.half_m = 0.5F * std::max({size.x, size.y, size.z});
}

Octree::Place Octree::place_in(const Node& node, std::uint32_t slot) const {
  Place place{0, true};
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const bool upper = boxes_.lo[axis][slot] >= node.centre_m[static_cast<int>(axis)];
    const bool lower = boxes_.hi[axis][slot] <= node.centre_m[static_cast<int>(axis)];
    place.fits = place.fits && (upper || lower);
    place.child |= upper ? 1U << axis : 0U;
  }
  return place;
}

bool Octree::in_root(std::uint32_t slot) const {
  const Node& r = root();
  for (int axis = 0; axis < 3; ++axis) {
    if (!(boxes_.lo[axis][slot] >= r.centre_m[axis] - r.half_m) ||
        !(boxes_.hi[axis][slot] <= r.centre_m[axis] + r.half_m))
      return false;
  }
  return true;
}

std::uint64_t Octree::code_in(const Node& node, std::uint32_t slot) const {
  constexpr float kSide = 1U << 16;
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float centre = 0.5F * boxes_.lo[axis][slot] + 0.5F * boxes_.hi[axis][slot];
    const float at = node.half_m > 0.0F ? 0.5F + 0.5F * (centre - node.centre_m[axis]) / node.half_m : 0.0F;
    const auto step = static_cast<std::uint64_t>(std::clamp(at, 0.0F, 1.0F) * (kSide - 1.0F));
    code |= spread(step) << axis;
  }
  return code;
}

void Octree::insert(std::uint32_t slot) {
  assert(!contains(slot));
  if (boxes_.get(slot).empty()) return;
  if (in_root(slot)) {
    descend(0, slot);
  } else {
    ++nodes_[0].content.slots;
    add_to_node(0, slot, false);
  }
}

void Octree::descend(std::uint32_t number, std::uint32_t slot) {
  for (;;) {
    ++nodes_[number].content.slots;
    const Place place = place_in(nodes_[number], slot);
    if (!place.fits || nodes_[number].level == options_.most_levels) return add_to_node(number, slot, false);
    if (nodes_[number].leaf()) {
      if (nodes_[number].fitting < options_.slots_per_node) return add_to_node(number, slot, true);
      split_node(number);
    }
    number = nodes_[number].first_child + place.child;
  }
}

std::size_t Octree::chunk_for(const Node& node, std::uint64_t code) const {
  const auto after =
      std::upper_bound(node.chunks.begin(), node.chunks.end(), code,
                       [&](std::uint64_t c, std::uint32_t k) { return c < chunks_[k].first_code; });
  return after == node.chunks.begin() ? 0 : static_cast<std::size_t>(after - node.chunks.begin()) - 1;
}

void Octree::add_to_node(std::uint32_t number, std::uint32_t slot, bool fits) {
  Node& node = nodes_[number];
  const std::uint64_t code = code_in(node, slot);
  if (node.chunks.empty()) node.chunks.push_back(new_chunk(number, code));
  const std::size_t at = chunk_for(node, code);
  const std::uint32_t into = node.chunks[at];
  Chunk& chunk = chunks_[into];
  chunk.first_code = std::min(chunk.first_code, code);
  chunk.slots.push_back(slot);
  chunk_of_slot_[slot] = into;
  fits_[slot] = fits ? 1 : 0;
  node.fitting += fits ? 1 : 0;
  if (adding_ == Change::grown && !chunk.stale) add_to_content(chunk.content, slot);
  touch_chunk(into, adding_);
  if (chunk.slots.size() > options_.slots_per_node) split_chunk(number, at);
}

void Octree::split_chunk(std::uint32_t number, std::size_t at) {
  const std::uint32_t old = nodes_[number].chunks[at];
  coded_.clear();
  for (const std::uint32_t slot : chunks_[old].slots)
    coded_.emplace_back(code_in(nodes_[number], slot), slot);
  std::sort(coded_.begin(), coded_.end());
  const std::size_t half = coded_.size() / 2;
  const std::uint32_t made = new_chunk(number, coded_[half].first);
  nodes_[number].chunks.insert(nodes_[number].chunks.begin() + static_cast<std::ptrdiff_t>(at) + 1, made);
  chunks_[old].slots.clear();
  for (std::size_t i = 0; i < coded_.size(); ++i) {
    const std::uint32_t into = i < half ? old : made;
    chunks_[into].slots.push_back(coded_[i].second);
    chunk_of_slot_[coded_[i].second] = into;
  }
  touch_chunk(old, Change::stale);
  touch_chunk(made, Change::stale);
}

void Octree::join_chunks(std::uint32_t number, std::size_t at) {
  std::vector<std::uint32_t>& list = nodes_[number].chunks;
  if (at + 1 >= list.size()) return;
  const std::uint32_t keep = list[at];
  const std::uint32_t gone = list[at + 1];
  if (chunks_[keep].slots.size() + chunks_[gone].slots.size() > options_.slots_per_node / 2) return;
  for (const std::uint32_t slot : chunks_[gone].slots) {
    chunks_[keep].slots.push_back(slot);
    chunk_of_slot_[slot] = keep;
  }
  touch_chunk(keep, Change::stale);
  free_chunk(gone);
  list.erase(list.begin() + static_cast<std::ptrdiff_t>(at) + 1);
}

void Octree::split_node(std::uint32_t number) {
  std::vector<std::uint32_t> slots;
  const std::uint32_t first = new_children(number);
  for (const std::uint32_t chunk : nodes_[number].chunks) {
    slots.insert(slots.end(), chunks_[chunk].slots.begin(), chunks_[chunk].slots.end());
    free_chunk(chunk);
  }
  nodes_[number].chunks.clear();
  nodes_[number].fitting = 0;
  const Change before = std::exchange(adding_, Change::stale);  // one look at each slot, in the end
  const bool whole = number != 0;  // the root also holds what lies outside its cell
  for (const std::uint32_t slot : slots) {
    const Place place = place_in(nodes_[number], slot);
    if (place.fits && (whole || in_root(slot))) {
      descend(first + place.child, slot);
    } else {
      add_to_node(number, slot, false);
    }
  }
  adding_ = before;
}

void Octree::remove(std::uint32_t slot) {
  if (!contains(slot)) return;
  const std::uint32_t node = chunks_[chunk_of_slot_[slot]].node;
  remove_from_node(slot);
  for (std::uint32_t n = node; n != kNone; n = nodes_[n].parent) --nodes_[n].content.slots;
  join_small(node);
}

void Octree::remove_from_node(std::uint32_t slot) {
  const std::uint32_t number = chunk_of_slot_[slot];
  Chunk& chunk = chunks_[number];
  Node& node = nodes_[chunk.node];
  chunk.slots.erase(std::find(chunk.slots.begin(), chunk.slots.end(), slot));
  chunk_of_slot_[slot] = kNone;
  node.fitting -= fits_[slot];
  touch_chunk(number, Change::stale);
  const auto at = static_cast<std::size_t>(std::find(node.chunks.begin(), node.chunks.end(), number) -
                                           node.chunks.begin());
  if (chunk.slots.empty()) {
    free_chunk(number);
    node.chunks.erase(node.chunks.begin() + static_cast<std::ptrdiff_t>(at));
  } else {
    const std::uint32_t owner = chunk.node;
    join_chunks(owner, at);
    if (at > 0) join_chunks(owner, at - 1);
  }
}

/// The highest node on the way up whose subtree fits half a node swallows it.
void Octree::join_small(std::uint32_t number) {
  std::uint32_t top = kNone;
  for (std::uint32_t n = number; n != kNone; n = nodes_[n].parent) {
    if (nodes_[n].content.slots > options_.slots_per_node / 2) break;
    if (!nodes_[n].leaf()) top = n;
  }
  if (top == kNone) return;
  std::vector<std::uint32_t> slots;
  take_slots(top, slots);
  nodes_[top].fitting = 0;
  const Change before = std::exchange(adding_, Change::stale);
  for (const std::uint32_t slot : slots) {
    const bool fits = (top != 0 || in_root(slot)) && place_in(nodes_[top], slot).fits;
    add_to_node(top, slot, fits);
  }
  adding_ = before;
  touch_node(top);
}

void Octree::take_slots(std::uint32_t number, std::vector<std::uint32_t>& slots) {
  for (const std::uint32_t chunk : nodes_[number].chunks) {
    slots.insert(slots.end(), chunks_[chunk].slots.begin(), chunks_[chunk].slots.end());
    free_chunk(chunk);
  }
  nodes_[number].chunks.clear();
  if (nodes_[number].leaf()) return;
  const std::uint32_t first = nodes_[number].first_child;
  for (std::uint32_t i = 0; i < 8; ++i) take_slots(first + i, slots);
  free_children_.push_back(first);
  nodes_[number].first_child = kNone;
}

void Octree::move(std::uint32_t slot) {
  if (!contains(slot)) return insert(slot);
  const Chunk& chunk = chunks_[chunk_of_slot_[slot]];
  const Node& node = nodes_[chunk.node];
  // Still in the same chunk: only boxes change, what was recorded of the chunk stays good.
  bool same = !boxes_.get(slot).empty();
  for (int axis = 0; axis < 3 && same; ++axis) {
    same = boxes_.lo[axis][slot] >= node.centre_m[axis] - node.half_m &&
           boxes_.hi[axis][slot] <= node.centre_m[axis] + node.half_m;
  }
  if (same) {
    const bool fits = node.level < options_.most_levels && place_in(node, slot).fits;
    same = fits == (fits_[slot] != 0) && (!fits || node.leaf()) &&
           node.chunks[chunk_for(node, code_in(node, slot))] == chunk_of_slot_[slot];
  }
  if (!same) {
    remove(slot);
    return insert(slot);
  }
  Chunk& in = chunks_[chunk_of_slot_[slot]];
  if (!in.dirty) dirty_chunks_.push_back(chunk_of_slot_[slot]);
  in.dirty = in.stale = true;
  touch_node(in.node);
}

std::uint32_t Octree::new_chunk(std::uint32_t node, std::uint64_t first_code) {
  std::uint32_t number = 0;
  if (free_chunks_.empty()) {
    number = static_cast<std::uint32_t>(chunks_.size());
    chunks_.emplace_back().slots.reserve(options_.slots_per_node + 1);
  } else {
    number = free_chunks_.back();
    free_chunks_.pop_back();
  }
  chunks_[number].node = node;
  chunks_[number].first_code = first_code;
  return number;
}

void Octree::free_chunk(std::uint32_t number) {
  Chunk& chunk = chunks_[number];
  chunk.node = kNone;
  chunk.slots.clear();
  chunk.content = {};
  chunk.dirty = chunk.stale = false;
  chunk.revision = ++revisions_;
  free_chunks_.push_back(number);
}

std::uint32_t Octree::new_children(std::uint32_t number) {
  std::uint32_t first = 0;
  if (free_children_.empty()) {
    first = static_cast<std::uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 8);
  } else {
    first = free_children_.back();
    free_children_.pop_back();
  }
  Node& node = nodes_[number];
  node.first_child = first;
  for (std::uint32_t i = 0; i < 8; ++i) {
    Node& child = nodes_[first + i];
    child.content = {};
    child.half_m = 0.5F * node.half_m;
    for (int axis = 0; axis < 3; ++axis)
      child.centre_m[axis] = node.centre_m[axis] + ((i >> axis & 1U) != 0 ? child.half_m : -child.half_m);
    child.parent = number;
    child.first_child = kNone;
    child.fitting = 0;
    child.level = node.level + 1;
    child.dirty = false;
    assert(child.chunks.empty());
  }
  return first;
}

void Octree::touch_chunk(std::uint32_t number, Change change) {
  Chunk& chunk = chunks_[number];
  chunk.revision = ++revisions_;
  if (!chunk.dirty) dirty_chunks_.push_back(number);
  chunk.dirty = true;
  chunk.stale = chunk.stale || change == Change::stale;
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
    seen += chunk.stale ? chunk.slots.size() : 1;
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
    Content sum;
    for (const std::uint32_t slot : chunk.slots) add_to_content(sum, slot);
    chunk.content = sum;
    refreshed_.slots += chunk.slots.size();
  }
  ++refreshed_.chunks;
  chunk.dirty = chunk.stale = false;
}

void Octree::add_to_content(Content& content, std::uint32_t slot) const {
  const Box box = boxes_.get(slot);
  const Work work = work_of_slot_(slot);
  content.box_m.add(box);
  ++content.slots;
  content.vertices += work.vertices;
  content.triangles += work.triangles;
  content.area_m2 += surface_m2(box);
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

namespace {

/// The planes of `planes` in bits of `mask` that still cut the box; none and outside = false when it is
/// inside.
struct Cut {
  bool outside = false;
  std::uint32_t mask = 0;
};

Cut cut(const CullPlanes& planes, std::uint32_t mask, const Box& box) {
  Cut out;
  for (std::uint32_t k = 0; k < planes.count; ++k) {
    if ((mask >> k & 1U) == 0) continue;
    const Side side = side_of(planes.planes[k], box);
    if (side == Side::outside) return {true, 0};
    if (side == Side::across) out.mask |= 1U << k;
  }
  return out;
}

}  // namespace

void Octree::cull(const CullPlanes& planes, const glm::vec3& eye_m, std::vector<std::uint32_t>& chunks,
                  OctreeCounters& counters, std::vector<OctreeVisit>* visits) const {
  const auto count = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
  const auto visit = [&](const auto& self, std::uint32_t number, std::uint32_t mask) -> void {
    const Node& node = nodes_[number];
    if (node.content.slots == 0) return;
    ++counters.nodes;
    if (mask != 0) {
      ++counters.tests;
      const Cut node_cut = cut(planes, mask, node.content.box_m);
      if (node_cut.outside) return;
      mask = node_cut.mask;
    }
    const std::size_t visit_at = visits != nullptr ? visits->size() : 0;
    if (visits != nullptr) visits->push_back({number, count(chunks), 0, 0, 0});
    const bool alone = node.leaf() && node.chunks.size() == 1;  // its box is the node's
    for (const std::uint32_t chunk : node.chunks) {
      if (mask != 0 && !alone) {
        ++counters.tests;
        if (cut(planes, mask, chunks_[chunk].content.box_m).outside) continue;
      }
      chunks.push_back(chunk);
    }
    if (visits != nullptr) (*visits)[visit_at].own_end = count(chunks);
    const auto leave = [&] {
      if (visits == nullptr) return;
      (*visits)[visit_at].end_chunk = count(chunks);
      (*visits)[visit_at].end_visit = count(*visits);
    };
    if (node.leaf()) return leave();
    std::uint32_t nearest = 0;
    for (int axis = 0; axis < 3; ++axis) nearest |= eye_m[axis] > node.centre_m[axis] ? 1U << axis : 0U;
    for (const std::uint32_t i : {0U, 1U, 2U, 4U, 3U, 5U, 6U, 7U})
      self(self, node.first_child + (i ^ nearest), mask);
    leave();
  };
  visit(visit, 0, (1U << planes.count) - 1);
}

std::uint64_t Octree::bytes() const {
  std::uint64_t sum = held_bytes(nodes_, chunks_, free_children_, free_chunks_, chunk_of_slot_, fits_) +
                      held_bytes(dirty_chunks_, dirty_nodes_, coded_);
  for (const Node& node : nodes_) sum += held_bytes(node.chunks);
  for (const Chunk& chunk : chunks_) sum += held_bytes(chunk.slots);
  return sum;
}

}  // namespace scenegen::render
