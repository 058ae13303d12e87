#include "render/strategy/cached_octree.h"

#include <algorithm>

#include "render/strategy/estimate_load.h"
#include "render/strategy/octree_choice.h"

namespace scenegen::render {

std::unique_ptr<Strategy> make_inline(const StrategyContext& context);

CachedOctree::CachedOctree(const StrategyContext& context) : context_(context), scene_(context.scene) {
  if (const auto fitting = choose_objects_per_node(context)) {
    objects_per_node_ = *fitting;
    octree_.emplace(scene_, *fitting,
                    context.octree_in_slices ? SceneOctree::Build::in_slices : SceneOctree::Build::at_once);
    cache_.emplace(context.device, context.options.fail_after_buffers);
  } else {
    give_up("an octree with cached command buffers does not fit into " +
            std::to_string(context.options.octree_bytes >> 20) + " MiB (--octree-memory)");
  }
}

void CachedOctree::update(const timeline::ChangeSet& changes) {
  inline_ ? inline_->update(changes) : octree_->update(changes);
}

void CachedOctree::note(const timeline::ChangeSet& changes) {
  inline_ ? inline_->update(changes) : octree_->note(changes);
}

bool CachedOctree::catch_up(std::size_t slots) {
  return inline_ || octree_->catch_up(slots);
}

void CachedOctree::plan(const View& view) {
  view_ = view;
  counters_ = {};
  if (inline_) return plan_inline();
  const CullPlanes planes = cull_planes(frustum_of(view.clip_from_world), scene_.bounds_m());
  list_blended_in_frustum(scene_, planes, list_);
  sort_back_to_front(scene_, view, list_.blended);
  chunks_.clear();
  found_ = {};
  tree().cull(planes, view.eye_m(), chunks_, found_);
  if (context_.options.reversed) std::reverse(chunks_.begin(), chunks_.end());
  counters_.nodes = found_.nodes;
  counters_.tested = list_.tested + found_.tests;
  counters_.drawn = list_.blended.size();
  for (const std::uint32_t chunk : chunks_) counters_.drawn += tree().chunk(chunk).slots.size();
}

void CachedOctree::foresee(model::FrameFacts& facts) const {
  if (inline_) return;
  facts.height = model::octree_height(tree().root().content.slots, objects_per_node_);
  facts.nodes_visited = static_cast<double>(found_.nodes);
  facts.boxes_tested = static_cast<double>(found_.tests);
  facts.chunks = static_cast<double>(chunks_.size());
  facts.in_chunks = load_of_chunks(scene_, tree(), chunks_, ScreenArea(view_, context_.size));
  facts.chunks_rerecorded = facts.draws_rerecorded = 0;
  for (const std::uint32_t number : chunks_) {
    const Octree::Chunk& chunk = tree().chunk(number);
    if (cache_->fresh(number, chunk.revision)) continue;
    facts.chunks_rerecorded += 1;
    facts.draws_rerecorded += static_cast<double>(chunk.slots.size());
  }
}

void CachedOctree::draw_solid(PassRecording& pass) {
  if (!inline_) {
    std::string why;
    try {
      return draw_chunks(pass);
    } catch (const vk::OutOfHostMemoryError& e) {
      why = e.what();
    } catch (const vk::OutOfDeviceMemoryError& e) {
      why = e.what();
    }
    // What the cache holds may still be running: it stays until the end.
    octree_.reset();
    give_up("no memory for cached command buffers (" + why + ")");
    plan_inline();
  }
  inline_->draw_solid(pass);
}

void CachedOctree::draw_blended(DrawRecorder& recorder) {
  if (inline_) return inline_->draw_blended(recorder);
  for (const std::uint32_t slot : list_.blended) recorder.draw(slot);
}

void CachedOctree::resized(glm::uvec2 size) {
  context_.size = size;
  if (inline_) inline_->resized(size);
  if (cache_) cache_->forget();
}

void CachedOctree::give_up(const std::string& why) {
  inline_ = make_inline(context_);
  warnings_.push_back(why + "; drawn as --strategy inline");
}

void CachedOctree::plan_inline() {
  inline_->plan(view_);
  counters_ = inline_->counters();
}

const CommandCache::Entry& CachedOctree::commands(PassRecording& pass, std::uint32_t number,
                                                  vk::Buffer predicates) {
  const Octree::Chunk& chunk = tree().chunk(number);
  std::span<const std::uint32_t> slots = chunk.slots;
  if (context_.options.reversed) {
    reversed_.assign(slots.rbegin(), slots.rend());
    slots = reversed_;
  }
  const CommandCache::Entry& entry = cache_->get(pass, number, chunk.revision, slots, predicates);
  const CommandCache::Counters recorded = cache_->take_counters();
  ++counters_.secondaries;
  counters_.recorded += recorded.recorded;
  counters_.recorded_draws += recorded.recorded_draws;
  return entry;
}

}  // namespace scenegen::render
