// Single-reference octree over slots (D 3.1.3), with the objects of a node in chunks of bounded size.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "render/spatial/frustum_cull.h"
#include "render/spatial/slot_boxes.h"

namespace scenegen::render {

/// What a culling walk did.
struct OctreeCounters {
  std::uint64_t nodes = 0;  ///< nodes visited
  std::uint64_t tests = 0;  ///< boxes (of nodes and chunks) tested against the frustum
};

/// A node that touches the frustum, in the order of a culling walk: what is below it follows it directly, in
/// visits as in chunks.
struct OctreeVisit {
  std::uint32_t node = 0;
  std::uint32_t first_chunk = 0;  ///< of the chunks found: its own, then those of nodes below
  std::uint32_t own_end = 0;
  std::uint32_t end_chunk = 0;
  std::uint32_t end_visit = 0;  ///< of the visits
};

/// A slot lives in the deepest node whose cell contains its box: crossing one of a cell's dividing planes
/// keeps it there, so no slot is in two places. What lies outside the root's cell lives in the root. A node
/// that holds more than `slots_per_node` slots which would fit a child is split; a subtree that shrinks to
/// half of that becomes one node again. Slots that cross planes pile up in high nodes, so a node keeps its
/// slots in *chunks* of at most `slots_per_node`, neighbours along the Morton curve together, each with a box
/// of its own: a chunk is what gets drawn, cached, culled and asked about.
///
/// insert, remove and move change the tree at once; boxes and sums are right after refresh(). Many slots at a
/// time take less than one after the other: each node sorts those that arrive among its children once, and a
/// chunk is looked at once. About 12 B a slot, 120 B a chunk and 150 B a node. Nothing is allocated while the
/// tree keeps its size.
class Octree {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  /// What drawing a slot takes.
  struct Work {
    std::uint32_t vertices = 0, triangles = 0;
  };

  struct Options {
    Box root_m;             ///< the root's cell is the cube round it
    std::size_t slots = 0;  ///< slots are numbered below this
    std::uint32_t slots_per_node = 100;
    std::uint32_t most_levels = 16;  ///< nodes at the last level are not split
  };

  /// What both chunks and nodes know of all that is in them.
  struct Content {
    Box box_m;  ///< tight
    std::uint32_t slots = 0;
    std::uint64_t vertices = 0;  ///< drawn
    std::uint64_t triangles = 0;
    double area_m2 = 0;  ///< sum of the boxes' surfaces, not clamped (METHODS 4)
  };

  struct Chunk {
    Content content;
    std::uint32_t node = kNone;    ///< none: this number is free
    std::uint64_t revision = 0;    ///< changes with the chunk's set of slots; never the same twice
    std::uint64_t first_code = 0;  ///< Morton code from which on slots of the node belong here
    std::vector<std::uint32_t> slots;
    std::uint32_t leaving = 0;  ///< slots, while many are removed
    bool dirty = false;
    bool stale = false;  ///< box and sums are to be made anew, from all slots
    std::uint8_t loose =
        0;  ///< sides of the box that a slot touched which has left: lower 1, 2, 4, upper 8, 16, 32
  };

  struct Node {
    Content content;  ///< of the subtree; `slots` is right at once, the rest after refresh()
    glm::vec3 centre_m{0.0F};
    float half_m = 0;
    std::uint32_t parent = kNone;
    std::uint32_t first_child =
        kNone;                  ///< eight in a row; child i lies on the far side of axis a if bit a of i
    std::uint32_t fitting = 0;  ///< own slots that would fit a child
    std::uint32_t level = 0;
    std::uint64_t revision = 0;         ///< changes with all that is in the subtree; never the same twice
    std::vector<std::uint32_t> chunks;  ///< along the Morton curve
    bool dirty = false;
    [[nodiscard]] bool leaf() const { return first_child == kNone; }
  };

  /// `boxes` must outlive the tree and be up to date whenever a slot is inserted or moved and at refresh(). A
  /// slot whose box has changed since must be moved, or forgotten with forget_box(), before it is removed.
  Octree(const SlotBoxes& boxes, std::function<Work(std::uint32_t)> work_of_slot, const Options& options);

  /// Slots that are not in the tree, each once. One with an empty box is left out.
  void insert(std::span<const std::uint32_t> slots);
  void insert(std::uint32_t slot) { insert(std::span(&slot, 1)); }
  /// Each once; those that are not in the tree do not matter.
  void remove(std::span<const std::uint32_t> slots);
  void remove(std::uint32_t slot) { remove(std::span(&slot, 1)); }
  /// The slot's box changed.
  void move(std::uint32_t slot);
  /// The same of a slot in the tree, as far as it stays in its chunk; false: it has to be removed and
  /// inserted again.
  [[nodiscard]] bool move_within(std::uint32_t slot);
  /// The slot's box changed, and it will be removed.
  void forget_box(std::uint32_t slot) {
    if (contains(slot)) chunks_[chunk_of_slot_[slot]].stale = true;
  }
  /// What is recorded of the slot's chunk is no longer right, for a reason other than its slots.
  void renew(std::uint32_t slot) {
    if (contains(slot)) touch_chunk(chunk_of_slot_[slot]);
  }
  [[nodiscard]] bool contains(std::uint32_t slot) const { return chunk_of_slot_[slot] != kNone; }
  void clear();
  /// Gives back what many slots at a time took beside the tree.
  void forget_scratch();
  /// Recomputes boxes and sums of what changed. O(chunks touched * slots in them + their ancestors). Goes on
  /// until it has seen about `most_slots` slots; false when something is left for the next call.
  bool refresh(std::size_t most_slots = std::numeric_limits<std::size_t>::max());
  /// What refresh() did so far.
  struct Refreshed {
    std::uint64_t chunks = 0;  ///< that changed
    std::uint64_t slots = 0;   ///< of those whose sums were made anew
    [[nodiscard]] Refreshed since(const Refreshed& before) const {
      return {chunks - before.chunks, slots - before.slots};
    }
  };
  [[nodiscard]] const Refreshed& refreshed() const { return refreshed_; }

  /// Appends the chunks that touch the frustum, those nearer to `eye_m` first, roughly. A node that is wholly
  /// inside a plane hands that on: its subtree is not tested against it. `visits`, if wanted, and `chunks`
  /// start empty then.
  void cull(const CullPlanes& planes, const glm::vec3& eye_m, std::vector<std::uint32_t>& chunks,
            OctreeCounters& counters, std::vector<OctreeVisit>* visits = nullptr) const;

  [[nodiscard]] std::uint32_t slots_per_node() const { return options_.slots_per_node; }
  /// Numbers below this may be chunks; those whose node is kNone are free.
  [[nodiscard]] std::size_t chunk_numbers() const { return chunks_.size(); }
  [[nodiscard]] const Chunk& chunk(std::uint32_t number) const { return chunks_[number]; }
  [[nodiscard]] std::uint32_t chunk_of(std::uint32_t slot) const { return chunk_of_slot_[slot]; }
  [[nodiscard]] std::size_t chunk_count() const { return chunks_.size() - free_chunks_.size(); }
  [[nodiscard]] std::size_t node_count() const { return nodes_.size() - 8 * free_children_.size(); }
  /// Numbers below this may be nodes.
  [[nodiscard]] std::size_t node_numbers() const { return nodes_.size(); }
  [[nodiscard]] const Node& node(std::uint32_t number) const { return nodes_[number]; }
  [[nodiscard]] const Node& root() const { return nodes_[0]; }
  /// Host memory held.
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  struct Place {
    std::uint32_t child;
    bool fits;
  };
  [[nodiscard]] Place place_in(const Node& node, std::uint32_t slot) const;
  [[nodiscard]] bool in_root(std::uint32_t slot) const;
  [[nodiscard]] std::uint64_t code_in(const Node& node, std::uint32_t slot) const;
  /// Puts arriving_ from `first` to its end into the subtree of `node`, whose cell contains them; takes them
  /// off arriving_.
  void settle(std::uint32_t node, std::size_t first);
  /// Where each of arriving_ from `first` on goes, into places_, and how many where: into one of the eight
  /// children, or nowhere.
  using Places = std::array<std::uint32_t, 9>;
  void find_places(std::uint32_t node, std::size_t first, Places& counts);
  void add_to_leaf(std::uint32_t node, std::size_t first);
  /// Index into the node's chunks, which must not be empty.
  [[nodiscard]] std::size_t chunk_for(const Node& node, std::uint64_t code) const;
  void add_to_node(std::uint32_t node, std::uint32_t slot, bool fits);
  /// Takes the slot's share out of the chunk's box and sums.
  void take_content(Chunk& chunk, std::uint32_t slot);
  void add_content(Content& to, std::span<const std::uint32_t> slots) const;
  /// After slots have left a chunk: it goes, or becomes one with a neighbour.
  void join_left(std::uint32_t chunk);
  void join_small(std::uint32_t node);
  /// Appends to arriving_.
  void take_slots(std::uint32_t node);
  void take_chunks(std::uint32_t node);
  void split_chunk(std::uint32_t node, std::size_t at);
  void join_chunks(std::uint32_t node, std::size_t at);
  std::uint32_t new_chunk(std::uint32_t node, std::uint64_t first_code);
  void free_chunk(std::uint32_t chunk);
  std::uint32_t new_children(std::uint32_t node);
  void touch_chunk(std::uint32_t chunk);
  void touch_node(std::uint32_t node);
  void refresh_chunk(Chunk& chunk);
  void tighten(Chunk& chunk) const;
  void refresh_node(Node& node);

  const SlotBoxes& boxes_;
  std::function<Work(std::uint32_t)> work_of_slot_;
  Options options_;
  std::vector<Node> nodes_;
  std::vector<Chunk> chunks_;
  std::vector<std::uint32_t> free_children_;  // first of eight
  std::vector<std::uint32_t> free_chunks_;
  std::vector<std::uint32_t> chunk_of_slot_;
  std::vector<std::uint8_t> fits_;  // per slot: counted in its node's `fitting`
  std::uint64_t revisions_ = 0;
  Refreshed refreshed_;
  std::vector<std::uint32_t> dirty_chunks_;
  std::vector<std::vector<std::uint32_t>> dirty_nodes_;  // by level
  // Scratch.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> coded_;  // of split_chunk
  std::vector<std::uint32_t> arriving_, sorted_;                // a stack, and what is sorted of it
  std::vector<std::uint8_t> places_;                            // child of each of arriving_; 8: it stays
  std::vector<std::uint32_t> left_chunks_, left_nodes_;
};

}  // namespace scenegen::render
