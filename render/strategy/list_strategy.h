// What strategies that record a list of slots each frame have in common.
#pragma once

#include "render/strategy/draw_list.h"
#include "render/strategy/strategy.h"

namespace scenegen::render {

/// Derived classes fill `list_` in plan() and end with finish_plan().
class ListStrategy : public Strategy {
 public:
  explicit ListStrategy(const StrategyContext& context) : scene_(context.scene), options_(context.options) {}
  void update(const timeline::ChangeSet& /*changes*/) override {}  // DrawScene's visible set is all it needs
  void draw_solid(PassRecording& pass) override;
  void draw_blended(DrawRecorder& recorder) override;

 protected:
  /// Sorts, and counts what the list holds.
  void finish_plan(const View& view);

  const DrawScene& scene_;
  StrategyOptions options_;
  DrawList list_;
};

}  // namespace scenegen::render
