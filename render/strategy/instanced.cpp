// Frustum culling of every object, then one instanced draw for all that share state and geometry, whatever
// their materials. Which objects those are stands in a list of slots that is written each frame and read by
// the device once an instance.
#include "render/passes/instance_list.h"
#include "render/passes/pass_recording.h"
#include "render/strategy/list_strategy.h"

namespace scenegen::render {
namespace {

class Instanced final : public ListStrategy {
 public:
  using ListStrategy::ListStrategy;

  void plan(const View& view) override {
    list_in_frustum(scene_, cull_planes(frustum_of(view.clip_from_world), scene_.bounds_m()), list_);
    finish_plan(view);
    group();
    counters_.list_bytes = slots_.size() * sizeof(slots_[0]);
    written_ = false;
  }

  void draw_solid(PassRecording& pass) override {
    if (!std::exchange(written_, true)) on_device_.write(pass.context(), slots_);
    DrawRecorder& recorder = pass.draws();
    recorder.read_slots_from(on_device_.buffer(pass.context()));
    for (const Draw& draw : draws_) recorder.draw_listed(slots_[draw.first], draw.first, draw.count);
  }

  [[nodiscard]] model::FrameFacts facts() const override {
    model::FrameFacts facts = ListStrategy::facts();
    facts.in_frustum = load();
    facts.exact_inline = true;
    return facts;
  }

  void add_memory(MemoryAccount& to) const override {
    ListStrategy::add_memory(to);
    to.add_host(MemoryKind::lists, held_bytes(slots_, mirrored_, draws_));
  }

 private:
  struct Draw {
    std::uint32_t first, count;  // of slots_
  };

  /// Slots are sorted by state and geometry, so equal ones stand together already; only those that are wound
  /// the other way go to the end of their group.
  void group() {
    slots_.clear();
    draws_.clear();
    const DrawPrimitive* before = nullptr;
    for (const std::uint32_t slot : list_.solid) {
      const DrawPrimitive& primitive = scene_.primitive(slot);
      if (before != &primitive && before != nullptr &&
          (before->batch != primitive.batch || before->geometry != primitive.geometry))
        end_group();
      before = &primitive;
      (scene_.mirrored(slot) ? mirrored_ : slots_).push_back(slot);
    }
    end_group();
  }

  void end_group() {
    end_draw();
    slots_.insert(slots_.end(), mirrored_.begin(), mirrored_.end());
    mirrored_.clear();
    end_draw();
  }

  void end_draw() {
    const auto end = static_cast<std::uint32_t>(slots_.size());
    const std::uint32_t first = draws_.empty() ? 0 : draws_.back().first + draws_.back().count;
    if (end > first) draws_.push_back({first, end - first});
  }

  std::vector<std::uint32_t> slots_;     // in the order in which they are drawn
  std::vector<std::uint32_t> mirrored_;  // scratch
  std::vector<Draw> draws_;
  InstanceList on_device_;
  bool written_ = false;  // the list of this frame
};

}  // namespace

std::unique_ptr<Strategy> make_instanced(const StrategyContext& context) {
  return std::make_unique<Instanced>(context);
}

}  // namespace scenegen::render
