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
  std::optional<SceneOctree> octree_;
  std::optional<CommandCache> cache_;
  std::unique_ptr<Strategy> inline_;  // when there is no memory for the rest
  DrawList list_;                     // blended only
  std::vector<std::uint32_t> reversed_;
};

}  // namespace scenegen::render
