// Culling on the device: what was seen in the frame before is drawn first, then what else is not hidden
// behind the depth that this leaves (Greene, Kass and Miller 1993; in two parts as Haar and Aaltonen 2015).
// The processor touches nothing but what changed.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <new>

#include "render/passes/hi_z.h"
#include "render/passes/pass_recording.h"
#include "render/strategy/device_culled.h"
#include "render/strategy/estimate_load.h"
#include "render/strategy/picture.h"

namespace scenegen::render {
namespace {

class HiZStrategy final : public DeviceCulled {
 public:
  explicit HiZStrategy(const StrategyContext& context)
      : DeviceCulled(context),
        frames_in_flight_(context.frames_in_flight),
        blocks_(static_cast<double>(HiZCut(context.scene).blocks())) {
    if (!context.device.indirect_nodes) {
      go_on_as_inline("the device has no indirect draws with a first instance");
    } else if (!vkr::can_sample_depth(context.device, vk::SampleCountFlagBits::e4)) {
      go_on_as_inline("the device cannot read depths of several samples in shaders");
    }
  }

  void update(const timeline::ChangeSet& changes) override {
    ListStrategy::update(changes);
    if (!changes.shown.empty() || !changes.hidden.empty() || !changes.remeshed.empty()) ++revision_;
    if (changes.moved.empty() || !order_) return;
    for (const ObjectId id : changes.moved) {
      for (const std::uint32_t slot : scene_.slots_of(id)) {
        order_->moved(slot, scene_.boxes().get(slot));
        turned_over_ = turned_over_ || (scene_.mirrored(slot) && !layout_->draws_mirrored(slot));
      }
    }
    if (layout_->mirrored || turned_over_) ++revision_;
  }

  void plan(const View& view) override {
    view_ = view;
    const CullPlanes planes = cull_planes(frustum_of(view.clip_from_world), scene_.bounds_m());
    inline_ ? list_in_frustum(scene_, planes, list_) : list_blended_in_frustum(scene_, planes, list_);
    finish_plan(view);
    if (order_ && !inline_) order_->rank(view);
  }

  void draw_solid(PassRecording& pass) override {
    if (inline_) return ListStrategy::draw_solid(pass);
    HiZ* culling = nullptr;
    try {
      culling = &prepared(pass);
    } catch (const vk::OutOfDeviceMemoryError& e) {
      give_up(e);
    } catch (const vk::OutOfHostMemoryError& e) {
      give_up(e);
    } catch (const std::bad_alloc& e) {
      give_up(e);
    }
    if (culling == nullptr) return ListStrategy::draw_solid(pass);

    drawn_[pass.context().frame.serial % drawn_.size()] = {pass.context().frame.serial,
                                                           picture_of(view_, scene_)};
    pass.in_two_parts();
    culling->cull(pass.context(), pass.target(), 0);
    culling->draw(pass.draws(), *order_, 0);
    pass.end_first_part();
    culling->cull(pass.context(), pass.target(), 1);
    DrawRecorder& second = pass.draws();
    if (!options_.late_visibility) culling->draw(second, *order_, 1);
  }

  [[nodiscard]] DeviceCounts device_counts(std::uint64_t serial) const override {
    DeviceCounts out;
    for (const Kind kind : {color, ids}) {
      for (const HiZ* culling : {culling_[kind].get(), old_[kind].get()}) {
        if (culling == nullptr) continue;
        const HiZCounts counts = culling->counts(serial, frames_in_flight_);
        const auto& [first, second] = counts.parts;
        const std::uint64_t exact = options_.late_visibility ? 0 : 1;
        const std::uint64_t triangles = first.triangles + exact * second.triangles;
        out.reveals += exact * second.drawn;
        if (kind == color) out.drawn += first.drawn + exact * second.drawn;
        (kind == color ? out.triangles : out.ids_triangles) += triangles;
      }
    }
    return out;
  }

  void finished(const FrameTimes& measured) override {
    const DeviceCounts counts = device_counts(measured.serial);
    const Drawn& drawn = drawn_[measured.serial % drawn_.size()];
    if (counts.drawn == 0 || drawn.serial != measured.serial) return;
    last_ = counts;
    last_picture_ = drawn.picture;
  }

  [[nodiscard]] bool available() const override { return !inline_; }
  [[nodiscard]] double blocks() const override { return blocks_; }
  void add_seen(model::FrameFacts& facts) const override {
    facts.hi_z_blocks = blocks_;
    if (inline_ || last_.drawn == 0 || !alike(last_picture_, picture_of(view_, scene_), scene_.bounds_m()))
      return;
    const model::Load& all = facts.in_frustum;
    facts.seen.draws = std::min(static_cast<double>(last_.drawn), all.draws);
    facts.seen.triangles = std::min(static_cast<double>(last_.triangles), all.triangles);
    facts.seen.vertices =
        all.triangles > 0.0 ? all.vertices * facts.seen.triangles / all.triangles : facts.seen.draws;
    facts.exact_seen = true;
  }
  [[nodiscard]] model::FrameFacts facts() const override {
    list_in_frustum(scene_, planes(), in_frustum_);  // the device does not tell
    return facts_of(load_of_slots(scene_, in_frustum_.solid, ScreenArea(view_, size_)));
  }
  [[nodiscard]] model::FrameFacts estimated_facts() const override {
    return facts_of(estimated_in_frustum(scene_, planes(), ScreenArea(view_, size_), in_frustum_));
  }

  void resized(glm::uvec2 size) override {
    ListStrategy::resized(size);
    stale_ = {true, true};
  }

  void add_memory(MemoryAccount& to) const override {
    ListStrategy::add_memory(to);
    to.add_host(MemoryKind::lists, in_frustum_.memory_bytes());
    if (layout_) to.add_host(MemoryKind::lists, layout_->memory_bytes());
    if (order_) to.add_host(MemoryKind::lists, order_->memory_bytes());
  }

 private:
  enum Kind : std::size_t { color, ids };
  struct Drawn {
    std::uint64_t serial = 0;
    Picture picture;
  };

  [[nodiscard]] CullPlanes planes() const {
    return cull_planes(frustum_of(view_.clip_from_world), scene_.bounds_m());
  }
  [[nodiscard]] model::FrameFacts facts_of(const model::Load& in_frustum) const {
    model::FrameFacts facts = ListStrategy::facts();
    facts.in_frustum = in_frustum;
    facts.exact_inline = true;
    add_seen(facts);
    return facts;
  }

  HiZ& prepared(PassRecording& pass) {
    const PassContext& context = pass.context();
    const Kind kind = pass.target().pass == vkr::PassKind::color ? color : ids;
    if (!layout_ || turned_over_) {
      // Frames in flight may still draw by the old one: it is kept. This happens once at most.
      if (layout_) {
        old_ = std::move(culling_);
        old_layout_ = std::move(layout_);
      }
      layout_ = std::make_unique<HiZLayout>(scene_, context.gpu.ranges(), std::exchange(turned_over_, false));
      order_ = std::make_unique<HiZOrder>(*layout_, scene_);
      order_->rank(view_);
    }
    std::unique_ptr<HiZ>& culling = culling_[kind];
    if (!culling) {
      culling = std::make_unique<HiZ>(context, pass.target(), *layout_);
    } else if (stale_[kind]) {
      culling->resized(context, pass.target());
    }
    stale_[kind] = false;
    counters_.list_bytes += culling->write_slots(context, revision_);
    counters_.list_bytes += culling->write_order(context, *order_);
    return *culling;
  }

  void go_on_as_inline(const std::string& why) {
    inline_ = true;
    warnings_.push_back(why + "; drawn as --strategy inline");
  }

  void give_up(const std::exception& e) {
    go_on_as_inline(std::string("no memory for culling on the device (") + e.what() + ")");
    plan(view_);
  }

  std::uint32_t frames_in_flight_;
  double blocks_;
  std::array<Drawn, 8> drawn_;  // more than can be in flight
  DeviceCounts last_;
  Picture last_picture_;
  bool inline_ = false;
  mutable DrawList in_frustum_;  // scratch of facts()
  std::uint64_t revision_ = 1;   // of the sets of visible and mirrored slots
  bool turned_over_ = false;     // a slot became mirrored that no command draws
  std::unique_ptr<HiZLayout> layout_, old_layout_;
  std::unique_ptr<HiZOrder> order_;
  std::array<std::unique_ptr<HiZ>, 2> culling_, old_;
  std::array<bool, 2> stale_{};
};

}  // namespace

std::unique_ptr<DeviceCulled> make_device_culled(const StrategyContext& context) {
  return std::make_unique<HiZStrategy>(context);
}

std::unique_ptr<Strategy> make_hi_z(const StrategyContext& context) {
  return make_device_culled(context);
}

}  // namespace scenegen::render
