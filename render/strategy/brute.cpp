// The reference: draws everything that is visible by timeline, and leaves the rest to the device.
#include "render/strategy/list_strategy.h"

namespace scenegen::render {
namespace {

class Brute final : public ListStrategy {
 public:
  using ListStrategy::ListStrategy;
  PlanCounters plan(const View& view) override {
    list_visible(scene_, list_);
    return finish_plan(view);
  }
};

}  // namespace

std::unique_ptr<Strategy> make_brute(const DrawScene& scene, const StrategyOptions& options) {
  return std::make_unique<Brute>(scene, options);
}

}  // namespace scenegen::render
