#include "render/strategy/list_strategy.h"

#include <algorithm>

#include "render/passes/pass_recording.h"

namespace scenegen::render {

void ListStrategy::finish_plan(const View& view) {
  if (options_.reversed) std::reverse(list_.solid.begin(), list_.solid.end());
  sort_back_to_front(scene_, view, list_.blended);
  counters_ = {};
  counters_.tested = list_.tested;
  counters_.drawn = list_.solid.size() + list_.blended.size();
}

void ListStrategy::draw_solid(PassRecording& pass) {
  DrawRecorder& recorder = pass.draws();
  for (const std::uint32_t slot : list_.solid) recorder.draw(slot);
}

void ListStrategy::draw_blended(DrawRecorder& recorder) {
  for (const std::uint32_t slot : list_.blended) recorder.draw(slot);
}

}  // namespace scenegen::render
