// Where slots live: nodes, and the chunks that share a node's slots out. What is known of them all together
// is octree_content.cpp's.
#include "render/spatial/octree.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "scene/held_bytes.h"

namespace scenegen::render {
namespace {

// Among places of a node's slots: where the eight children come first.
constexpr std::size_t kStays = 8;

/// Every third bit of 63, from 21.
std::uint64_t spread(std::uint64_t v) {
  v = (v | v << 32) & 0x1F00000000FFFFULL;
  v = (v | v << 16) & 0x1F0000FF0000FFULL;
  v = (v | v << 8) & 0x100F00F00F00F00FULL;
  v = (v | v << 4) & 0x10C30C30C30C30C3ULL;
  return (v | v << 2) & 0x1249249249249249ULL;
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

void Octree::insert(std::span<const std::uint32_t> slots) {
  arriving_.clear();
  for (const std::uint32_t slot : slots) {
    assert(!contains(slot));
    if (!boxes_.get(slot).empty()) arriving_.push_back(slot);
  }
  if (!arriving_.empty()) settle(0, 0);
}

void Octree::find_places(std::uint32_t number, std::size_t first, Places& counts) {
  const Node& node = nodes_[number];
  const glm::vec3 centre = node.centre_m;
  const std::array lo{boxes_.lo[0].data(), boxes_.lo[1].data(), boxes_.lo[2].data()};
  const std::array hi{boxes_.hi[0].data(), boxes_.hi[1].data(), boxes_.hi[2].data()};
  const bool last = node.level == options_.most_levels;
  places_.resize(arriving_.size());
  for (std::size_t i = first; i < arriving_.size(); ++i) {
    const std::uint32_t slot = arriving_[i];
    std::uint32_t child = 0;
    bool fits = !last;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const bool upper = lo[axis][slot] >= centre[static_cast<int>(axis)];
      const bool lower = hi[axis][slot] <= centre[static_cast<int>(axis)];
      fits = fits & (upper | lower);
      child |= static_cast<std::uint32_t>(upper) << axis;
    }
    places_[i] = static_cast<std::uint8_t>(fits ? child : kStays);
  }
  for (std::size_t i = first; i < arriving_.size(); ++i) {
    if (number == 0 && !in_root(arriving_[i]))
      places_[i] = kStays;  // it holds what lies outside its cell too
    ++counts[places_[i]];
  }
}

void Octree::settle(std::uint32_t number, std::size_t first) {
  const std::size_t coming = arriving_.size() - first;
  nodes_[number].content.slots += static_cast<std::uint32_t>(coming);
  Places counts{};
  find_places(number, first, counts);
  if (nodes_[number].leaf()) {
    if (nodes_[number].fitting + coming - counts[kStays] <= options_.slots_per_node) {
      add_to_leaf(number, first);
      arriving_.resize(first);
      return;
    }
    // What is here already goes with them.
    (void)new_children(number);
    take_chunks(number);
    nodes_[number].fitting = 0;
    find_places(number, first + coming, counts);
  }
  std::array<std::size_t, 9> next{};
  for (std::size_t place = 1; place < next.size(); ++place) next[place] = next[place - 1] + counts[place - 1];
  const std::size_t all = arriving_.size() - first;
  sorted_.resize(std::max(sorted_.size(), all));
  for (std::size_t i = first; i < arriving_.size(); ++i) sorted_[next[places_[i]]++] = arriving_[i];
  const std::size_t going = all - counts[kStays];
  std::copy_n(sorted_.begin(), going, arriving_.begin() + static_cast<std::ptrdiff_t>(first));
  arriving_.resize(first + going);
  for (std::size_t i = going; i < all; ++i) add_to_node(number, sorted_[i], false);
  const std::uint32_t first_child = nodes_[number].first_child;
  for (std::uint32_t child = 8; child-- > 0;) {
    if (counts[child] > 0) settle(first_child + child, arriving_.size() - counts[child]);
  }
}

void Octree::add_to_leaf(std::uint32_t number, std::size_t first) {
  Node& node = nodes_[number];
  if (node.chunks.empty()) node.chunks.push_back(new_chunk(number, 0));
  const std::uint32_t into = node.chunks.front();
  Chunk& chunk = chunks_[into];
  const std::size_t coming = arriving_.size() - first;
  if (node.chunks.size() > 1 || chunk.slots.size() + coming > options_.slots_per_node) {
    for (std::size_t i = first; i < arriving_.size(); ++i)
      add_to_node(number, arriving_[i], places_[i] != kStays);
    return;
  }
  for (std::size_t i = first; i < arriving_.size(); ++i) {
    const std::uint32_t slot = arriving_[i];
    chunk.slots.push_back(slot);
    chunk_of_slot_[slot] = into;
    fits_[slot] = places_[i] != kStays ? 1 : 0;
    node.fitting += fits_[slot];
  }
  if (!chunk.stale) add_content(chunk.content, std::span(arriving_).subspan(first));
  touch_chunk(into);
}

std::size_t Octree::chunk_for(const Node& node, std::uint64_t code) const {
  const auto after =
      std::upper_bound(node.chunks.begin(), node.chunks.end(), code,
                       [&](std::uint64_t c, std::uint32_t k) { return c < chunks_[k].first_code; });
  return after == node.chunks.begin() ? 0 : static_cast<std::size_t>(after - node.chunks.begin()) - 1;
}

void Octree::add_to_node(std::uint32_t number, std::uint32_t slot, bool fits) {
  Node& node = nodes_[number];
  if (node.chunks.empty()) node.chunks.push_back(new_chunk(number, 0));
  const std::size_t at = node.chunks.size() > 1 ? chunk_for(node, code_in(node, slot)) : 0;
  const std::uint32_t into = node.chunks[at];
  Chunk& chunk = chunks_[into];
  chunk.slots.push_back(slot);
  chunk_of_slot_[slot] = into;
  fits_[slot] = fits ? 1 : 0;
  node.fitting += fits ? 1 : 0;
  if (!chunk.stale) add_content(chunk.content, std::span(&slot, 1));
  touch_chunk(into);
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
  // A first chunk takes what lies before it.
  chunks_[old].first_code = std::min(chunks_[old].first_code, coded_.front().first);
  chunks_[old].slots.clear();
  for (std::size_t i = 0; i < coded_.size(); ++i) {
    const std::uint32_t into = i < half ? old : made;
    chunks_[into].slots.push_back(coded_[i].second);
    chunk_of_slot_[coded_[i].second] = into;
  }
  chunks_[old].stale = chunks_[made].stale = true;
  touch_chunk(made);
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
  chunks_[keep].stale = true;
  touch_chunk(keep);
  free_chunk(gone);
  list.erase(list.begin() + static_cast<std::ptrdiff_t>(at) + 1);
}

void Octree::remove(std::span<const std::uint32_t> slots) {
  // A few are looked for one by one, of many the chunks are gone through once.
  const bool many = slots.size() > 4 * chunk_count();
  left_chunks_.clear();
  left_nodes_.clear();
  for (const std::uint32_t slot : slots) {
    const std::uint32_t number = chunk_of_slot_[slot];
    if (number == kNone) continue;
    Chunk& chunk = chunks_[number];
    if (chunk.leaving++ == 0) left_chunks_.push_back(number);
    nodes_[chunk.node].fitting -= fits_[slot];
    chunk_of_slot_[slot] = kNone;
    chunk.stale = chunk.stale || many;
    take_content(chunk, slot);
    if (!many) chunk.slots.erase(std::find(chunk.slots.begin(), chunk.slots.end(), slot));
  }
  for (const std::uint32_t number : left_chunks_) {
    Chunk& chunk = chunks_[number];
    if (many) std::erase_if(chunk.slots, [&](std::uint32_t slot) { return chunk_of_slot_[slot] != number; });
    for (std::uint32_t n = chunk.node; n != kNone; n = nodes_[n].parent)
      nodes_[n].content.slots -= chunk.leaving;
    chunk.leaving = 0;
    touch_chunk(number);
    left_nodes_.push_back(chunk.node);
  }
  for (const std::uint32_t number : left_chunks_) {
    if (chunks_[number].node != kNone) join_left(number);
  }
  for (const std::uint32_t number : left_nodes_) {
    if (number == 0 || nodes_[number].parent != kNone) join_small(number);  // else it was swallowed meanwhile
  }
}

void Octree::join_left(std::uint32_t number) {
  const std::uint32_t owner = chunks_[number].node;
  std::vector<std::uint32_t>& list = nodes_[owner].chunks;
  const auto at = static_cast<std::size_t>(std::find(list.begin(), list.end(), number) - list.begin());
  if (chunks_[number].slots.empty()) {
    free_chunk(number);
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(at));
    return;
  }
  join_chunks(owner, at);
  if (at > 0) join_chunks(owner, at - 1);
}

/// The highest node on the way up whose subtree fits half a node swallows it.
void Octree::join_small(std::uint32_t number) {
  std::uint32_t top = kNone;
  for (std::uint32_t n = number; n != kNone; n = nodes_[n].parent) {
    if (nodes_[n].content.slots > options_.slots_per_node / 2) break;
    if (!nodes_[n].leaf()) top = n;
  }
  if (top == kNone) return;
  arriving_.clear();
  take_slots(top);
  nodes_[top].fitting = 0;
  Places counts{};
  find_places(top, 0, counts);
  for (std::size_t i = 0; i < arriving_.size(); ++i) add_to_node(top, arriving_[i], places_[i] != kStays);
  arriving_.clear();
  touch_node(top);
}

void Octree::take_chunks(std::uint32_t number) {
  for (const std::uint32_t chunk : nodes_[number].chunks) {
    arriving_.insert(arriving_.end(), chunks_[chunk].slots.begin(), chunks_[chunk].slots.end());
    free_chunk(chunk);
  }
  nodes_[number].chunks.clear();
}

void Octree::take_slots(std::uint32_t number) {
  take_chunks(number);
  if (nodes_[number].leaf()) return;
  const std::uint32_t first = nodes_[number].first_child;
  for (std::uint32_t i = 0; i < 8; ++i) {
    take_slots(first + i);
    nodes_[first + i].parent = kNone;
  }
  free_children_.push_back(first);
  nodes_[number].first_child = kNone;
}

void Octree::move(std::uint32_t slot) {
  if (!contains(slot)) return insert(slot);
  if (move_within(slot)) return;
  forget_box(slot);
  remove(slot);
  insert(slot);
}

bool Octree::move_within(std::uint32_t slot) {
  const std::uint32_t number = chunk_of_slot_[slot];
  Chunk& chunk = chunks_[number];
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
           (node.chunks.size() == 1 || node.chunks[chunk_for(node, code_in(node, slot))] == number);
  }
  if (!same) return false;
  chunk.stale = true;
  if (!chunk.dirty) dirty_chunks_.push_back(number);
  chunk.dirty = true;
  touch_node(chunk.node);
  return true;
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
  chunk.loose = 0;
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

void Octree::forget_scratch() {
  for (std::vector<std::uint32_t>* list : {&arriving_, &sorted_, &left_chunks_, &left_nodes_}) *list = {};
  places_ = {};
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
  std::uint64_t sum =
      held_bytes(nodes_, chunks_, free_children_, free_chunks_, chunk_of_slot_, fits_) +
      held_bytes(dirty_chunks_, dirty_nodes_, coded_, arriving_, sorted_, places_, left_chunks_, left_nodes_);
  for (const Node& node : nodes_) sum += held_bytes(node.chunks);
  for (const Chunk& chunk : chunks_) sum += held_bytes(chunk.slots);
  return sum;
}

}  // namespace scenegen::render
