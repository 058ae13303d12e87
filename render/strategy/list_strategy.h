// What strategies that record a list of slots each frame have in common.
#pragma once

#include "render/strategy/draw_list.h"
#include "render/strategy/strategy.h"

namespace scenegen::render {

/// Derived classes fill `list_` in plan() and end with finish_plan().
class ListStrategy : public Strategy {
 public:
  explicit ListStrategy(const StrategyContext& context)
      : scene_(context.scene), options_(context.options), size_(context.size) {}
  // DrawScene's visible set is all it needs.
  void update(const timeline::ChangeSet& changes) override;
  void draw_solid(PassRecording& pass) override;
  void draw_blended(DrawRecorder& recorder) override;
  void resized(glm::uvec2 size) override { size_ = size; }
  [[nodiscard]] model::FrameFacts facts() const override;
  void add_memory(MemoryAccount& to) const override { to.add_host(MemoryKind::lists, list_.memory_bytes()); }

 protected:
  /// Sorts, and counts what the list holds.
  void finish_plan(const View& view);
  /// What the list holds, for facts of derived classes.
  [[nodiscard]] model::Load load() const;

  const DrawScene& scene_;
  StrategyOptions options_;
  glm::uvec2 size_;
  View view_;  ///< of the last plan
  DrawList list_;
  std::size_t changed_ = 0;  ///< in the last update
};

}  // namespace scenegen::render
