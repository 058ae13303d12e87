// D method 2: chunks of the octree are culled, and each has its draw commands in a secondary command buffer
// that is kept until its slots change. Without memory for that it goes on as `inline`.
#include <algorithm>

#include "render/passes/command_cache.h"
#include "render/spatial/scene_octree.h"
#include "render/strategy/draw_list.h"
#include "render/strategy/octree_choice.h"

namespace scenegen::render {

std::unique_ptr<Strategy> make_inline(const StrategyContext& context);

namespace {

class CachedOctree final : public Strategy {
 public:
  explicit CachedOctree(const StrategyContext& context) : context_(context), scene_(context.scene) {
    if (const auto fitting = choose_objects_per_node(context)) {
      octree_.emplace(scene_, *fitting);
      cache_.emplace(context.device, context.options.fail_after_buffers);
    } else {
      give_up("an octree with cached command buffers does not fit into " +
              std::to_string(context.options.octree_bytes >> 20) + " MiB (--octree-memory)");
    }
  }

  void update(const timeline::ChangeSet& changes) override {
    inline_ ? inline_->update(changes) : octree_->update(changes);
  }

  void plan(const View& view) override {
    view_ = view;
    counters_ = {};
    if (inline_) return plan_inline();
    const CullPlanes planes = cull_planes(frustum_of(view.clip_from_world), scene_.bounds_m());
    list_blended_in_frustum(scene_, planes, list_);
    sort_back_to_front(scene_, view, list_.blended);
    chunks_.clear();
    OctreeCounters found;
    octree_->tree().cull(planes, view.eye_m(), chunks_, found);
    if (context_.options.reversed) std::reverse(chunks_.begin(), chunks_.end());
    counters_.nodes = found.nodes;
    counters_.tested = list_.tested + found.tests;
    counters_.drawn = list_.blended.size();
    for (const std::uint32_t chunk : chunks_) counters_.drawn += octree_->tree().chunk(chunk).slots.size();
  }

  void draw_solid(PassRecording& pass) override {
    if (!inline_) {
      try {
        return draw_cached(pass);
      } catch (const vk::OutOfHostMemoryError& e) {
        lost_memory_ = e.what();
      } catch (const vk::OutOfDeviceMemoryError& e) {
        lost_memory_ = e.what();
      }
      // The pass has not begun. What the cache holds may still be running: it stays until the end.
      octree_.reset();
      give_up("no memory for cached command buffers (" + lost_memory_ + ")");
      plan_inline();
    }
    inline_->draw_solid(pass);
  }

  void draw_blended(DrawRecorder& recorder) override {
    if (inline_) return inline_->draw_blended(recorder);
    for (const std::uint32_t slot : list_.blended) recorder.draw(slot);
  }

  void resized() override {
    if (cache_) cache_->forget();
  }

 private:
  void give_up(const std::string& why) {
    inline_ = make_inline(context_);
    warnings_.push_back(why + "; drawn as --strategy inline");
  }

  void plan_inline() {
    inline_->plan(view_);
    counters_ = inline_->counters();
  }

  void draw_cached(PassRecording& pass) {
    buffers_.clear();
    std::uint64_t draws = 0;
    std::uint64_t triangles = 0;
    for (const std::uint32_t number : chunks_) {
      const Octree::Chunk& chunk = octree_->tree().chunk(number);
      std::span<const std::uint32_t> slots = chunk.slots;
      if (context_.options.reversed) {
        reversed_.assign(slots.rbegin(), slots.rend());
        slots = reversed_;
      }
      const CommandCache::Entry& entry = cache_->get(pass, number, chunk.revision, slots);
      buffers_.push_back(entry.commands);
      draws += entry.draws;
      triangles += entry.triangles;
    }
    pass.execute(buffers_, draws, triangles);
    const CommandCache::Counters recorded = cache_->take_counters();
    counters_.secondaries += buffers_.size();
    counters_.recorded += recorded.recorded;
    counters_.recorded_draws += recorded.recorded_draws;
  }

  StrategyContext context_;
  const DrawScene& scene_;
  View view_;
  std::optional<SceneOctree> octree_;
  std::optional<CommandCache> cache_;
  std::unique_ptr<Strategy> inline_;  // when there is no memory for the rest
  std::string lost_memory_;
  DrawList list_;  // blended only
  std::vector<std::uint32_t> chunks_;
  std::vector<std::uint32_t> reversed_;
  std::vector<vk::CommandBuffer> buffers_;
};

}  // namespace

std::unique_ptr<Strategy> make_octree(const StrategyContext& context) {
  return std::make_unique<CachedOctree>(context);
}

}  // namespace scenegen::render
