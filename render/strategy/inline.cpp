// D method 1: frustum culling of every object (with SIMD), every visible object recorded each frame.
#include "render/strategy/list_strategy.h"

namespace scenegen::render {
namespace {

class Inline final : public ListStrategy {
 public:
  using ListStrategy::ListStrategy;
  void plan(const View& view) override {
    list_in_frustum(scene_, cull_planes(frustum_of(view.clip_from_world), scene_.bounds_m()), list_);
    finish_plan(view);
  }
  [[nodiscard]] model::FrameFacts facts() const override {
    model::FrameFacts facts = ListStrategy::facts();
    facts.in_frustum = load();
    facts.exact_inline = true;
    return facts;
  }
};

}  // namespace

std::unique_ptr<Strategy> make_inline(const StrategyContext& context) {
  return std::make_unique<Inline>(context);
}

}  // namespace scenegen::render
