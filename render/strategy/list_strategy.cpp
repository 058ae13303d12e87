#include "render/strategy/list_strategy.h"

#include <algorithm>

#include "render/passes/pass_recording.h"
#include "render/strategy/estimate_load.h"

namespace scenegen::render {

void ListStrategy::update(const timeline::ChangeSet& changes) {
  changed_ = changes.count();
}

void ListStrategy::finish_plan(const View& view) {
  view_ = view;
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

model::Load ListStrategy::load() const {
  return load_of_slots(scene_, list_.solid, ScreenArea(view_, size_));
}

model::FrameFacts ListStrategy::facts() const {
  model::FrameFacts facts;
  const ScreenArea screen(view_, size_);
  add_scene_facts(scene_, screen, facts);
  facts.changed = static_cast<double>(changed_);
  facts.blended = load_of_slots(scene_, list_.blended, screen);
  return facts;
}

}  // namespace scenegen::render
