// What `adaptive` knows of culling on the device.
#pragma once

#include "render/strategy/list_strategy.h"

namespace scenegen::render {

/// Draws what the device finds not hidden; what that was is known when the frame is done.
class DeviceCulled : public ListStrategy {
 public:
  using ListStrategy::ListStrategy;
  /// false: it draws as `inline`, since the device cannot, or memory ran out.
  [[nodiscard]] virtual bool available() const = 0;
  /// Blocks of slots that it has the device look at.
  [[nodiscard]] virtual double blocks() const = 0;
  /// facts() in little time, for decisions: what is in the frustum is estimated from a sample of all.
  [[nodiscard]] virtual model::FrameFacts estimated_facts() const = 0;
  /// What the last frame that is done drew, if it is known, into `facts`, whose in_frustum must be.
  virtual void add_seen(model::FrameFacts& facts) const = 0;
};

/// Never null.
[[nodiscard]] std::unique_ptr<DeviceCulled> make_device_culled(const StrategyContext& context);

}  // namespace scenegen::render
