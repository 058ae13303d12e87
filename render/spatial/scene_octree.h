// The octree of what is visible of a scene, kept up to date from ChangeSets.
#pragma once

#include "render/draw_scene.h"
#include "render/spatial/octree.h"
#include "timeline/player.h"

namespace scenegen::render {

/// Holds the visible opaque and masked slots. Blended ones are sorted every frame and live in no tree.
class SceneOctree {
 public:
  /// `in_slices`: nothing is in the tree before catch_up().
  enum class Build : std::uint8_t { at_once, in_slices };
  /// Takes the scene's present state; the root is round everything, hidden or not.
  SceneOctree(const DrawScene& scene, std::uint32_t slots_per_node, Build build = Build::at_once);

  /// After the scene took the changes. O(changes * height + slots / 64 + Octree::refresh()).
  void update(const timeline::ChangeSet& changes);
  /// The same put off. What is in the tree is compared with what is visible, 64 slots at a time, and only
  /// what moved is remembered: O(moved + slots / 64).
  void note(const timeline::ChangeSet& changes);
  /// Does about `slots` slots' worth of what was put off; true when nothing is left. Until then the tree is
  /// of no use. All changes of the scene must have been noted; what happened to a slot in between does not
  /// matter: it is compared with the scene as it is now.
  bool catch_up(std::size_t slots);
  [[nodiscard]] bool behind() const { return pending_slots_ > 0 || !refreshed_; }
  /// Slots put off.
  [[nodiscard]] std::size_t pending() const { return pending_slots_; }
  [[nodiscard]] const Octree& tree() const { return tree_; }
  /// Host memory held.
  [[nodiscard]] std::uint64_t memory_bytes() const {
    return tree_.bytes() + mirrored_.memory_bytes() + followed_.memory_bytes() + moved_.memory_bytes() +
           held_bytes(gone_, come_);
  }

 private:
  /// The next `count` slots of those put off.
  void follow(std::size_t count);
  /// Slots of a word that are put off.
  [[nodiscard]] std::uint64_t pending_in(std::size_t word) const;
  void count_pending();

  const DrawScene& scene_;
  Octree tree_;
  BitSet mirrored_;  // as recorded: which way a slot's faces wind is part of its commands
  BitSet followed_;  // visible when the tree last followed
  BitSet moved_;     // since then
  std::size_t pending_slots_ = 0;
  std::size_t cursor_ = 0;  // word to look at next
  bool refreshed_ = true;
  std::vector<std::uint32_t> gone_, come_;  // scratch
};

}  // namespace scenegen::render
