// The octree of what is visible of a scene, kept up to date from ChangeSets.
#pragma once

#include "render/draw_scene.h"
#include "render/spatial/octree.h"
#include "timeline/player.h"

namespace scenegen::render {

/// Holds the visible opaque and masked slots. Blended ones are sorted every frame and live in no tree.
class SceneOctree {
 public:
  /// Takes the scene's present state; the root is round everything, hidden or not.
  SceneOctree(const DrawScene& scene, std::uint32_t slots_per_node);

  /// After the scene took the changes. O(changes * height).
  void update(const timeline::ChangeSet& changes);
  [[nodiscard]] const Octree& tree() const { return tree_; }

 private:
  void follow(std::uint32_t slot);

  const DrawScene& scene_;
  Octree tree_;
  BitSet mirrored_;  // as recorded: which way a slot's faces wind is part of its commands
};

}  // namespace scenegen::render
