// The reference: draws everything that is visible by timeline, and leaves the rest to the device.
#include "render/strategy/list_strategy.h"

namespace scenegen::render {
namespace {

class Brute final : public ListStrategy {
 public:
  using ListStrategy::ListStrategy;
  void plan(const View& view) override {
    list_visible(scene_, list_);
    finish_plan(view);
  }
};

}  // namespace

std::unique_ptr<Strategy> make_brute(const StrategyContext& context) {
  return std::make_unique<Brute>(context);
}

}  // namespace scenegen::render
