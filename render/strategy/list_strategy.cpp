#include "render/strategy/list_strategy.h"

#include <algorithm>

#include "render/passes/draw_recorder.h"

namespace scenegen::render {

PlanCounters ListStrategy::finish_plan(const View& view) {
  if (options_.reversed) std::reverse(list_.solid.begin(), list_.solid.end());
  sort_back_to_front(scene_, view, list_.blended);
  return {list_.tested, list_.solid.size() + list_.blended.size()};
}

void ListStrategy::record(DrawRecorder& recorder, DrawPart part) {
  for (const std::uint32_t slot : part == DrawPart::solid ? list_.solid : list_.blended) recorder.draw(slot);
}

}  // namespace scenegen::render
