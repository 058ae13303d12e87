// What strategies that keep the commands of octree chunks have in common.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/passes/command_cache.h"
#include "render/spatial/scene_octree.h"
#include "render/strategy/draw_list.h"
#include "render/strategy/strategy.h"

namespace scenegen::render {

/// Chunks of the octree are culled, and each has its draw commands in a secondary command buffer that is kept
/// until its slots change. Without memory for that it goes on as `inline`. Derived classes say what is done
/// with the chunks in the frustum.
class CachedOctree : public Strategy {
 public:
  explicit CachedOctree(const StrategyContext& context);
  void update(const timeline::ChangeSet& changes) override;
  void plan(const View& view) override;
  void draw_solid(PassRecording& pass) override;
  void draw_blended(DrawRecorder& recorder) override;
  void resized(glm::uvec2 size) override;

  // For a strategy that draws some frames in another way; in the others it calls update() and plan() as
  // usual.
  /// Instead of update(), in a frame that is drawn otherwise: the changes are put off.
  void note(const timeline::ChangeSet& changes);
  /// Does about `slots` slots' worth of what was put off, or of building the tree; true when nothing is left.
  /// Only then may plan() be called.
  bool catch_up(std::size_t slots);
  /// False: there was no memory for it, plan() goes on as `inline`.
  [[nodiscard]] bool available() const { return !inline_; }
  /// Objects a node holds.
  [[nodiscard]] std::uint32_t objects_per_node() const { return objects_per_node_; }
  [[nodiscard]] bool behind() const { return octree_ && octree_->behind(); }
  [[nodiscard]] std::size_t pending() const { return octree_ ? octree_->pending() : 0; }
  /// After plan(), before anything is drawn: what drawing the octree would find. All of it is exact but the
  /// fragments. Fills the octree's part of `facts`.
  void foresee(model::FrameFacts& facts) const;

 protected:
  /// Draws the chunks in the frustum, `chunks_`. What needs memory comes first: when it throws for want of
  /// it, the pass must not have begun.
  virtual void draw_chunks(PassRecording& pass) = 0;
  /// The kept commands of a chunk; counts them.
  [[nodiscard]] const CommandCache::Entry& commands(PassRecording& pass, std::uint32_t chunk,
                                                    vk::Buffer predicates = {});
  [[nodiscard]] const Octree& tree() const { return octree_->tree(); }
  [[nodiscard]] const View& view() const { return view_; }

  StrategyContext context_;
  const DrawScene& scene_;
  std::vector<std::uint32_t> chunks_;

 private:
  void give_up(const std::string& why);
  void plan_inline();

  View view_;
  std::uint32_t objects_per_node_ = 0;
  OctreeCounters found_;
  std::optional<SceneOctree> octree_;
  std::optional<CommandCache> cache_;
  std::unique_ptr<Strategy> inline_;  // when there is no memory for the rest
  DrawList list_;                     // blended only
  std::vector<std::uint32_t> reversed_;
};

}  // namespace scenegen::render
