#include "render/spatial/scene_octree.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace scenegen::render {
namespace {

// Slots that the tree takes at a time: the more, the fewer nodes are split when they have become too large.
// 17 B each while that goes on, of which this many are kept.
constexpr std::size_t kAtOnce = std::size_t{1} << 18;
constexpr std::size_t kKept = std::size_t{1} << 14;

Octree::Options options_of(const DrawScene& scene, std::uint32_t slots_per_node) {
  Octree::Options options;
  options.root_m = scene.bounds_m();
  options.slots = scene.slot_count();
  options.slots_per_node = slots_per_node;
  return options;
}

}  // namespace

SceneOctree::SceneOctree(const DrawScene& scene, std::uint32_t slots_per_node, Build build)
    : scene_(scene),
      tree_(
          scene.boxes(),
          [&scene](std::uint32_t slot) {
            const DrawWork& work = scene.primitive(slot).work;
            return Octree::Work{work.vertices, work.triangles};
          },
          options_of(scene, slots_per_node)),
      mirrored_(scene.slot_count()),
      pending_(scene.solid_end()) {
  // What is hidden now will be noted when it appears.
  for (std::uint32_t slot = 0; slot < scene.solid_end(); ++slot) {
    if (!scene.visible().test(slot)) continue;
    pending_.set(slot);
    ++pending_slots_;
  }
  if (build == Build::at_once) (void)catch_up(std::numeric_limits<std::size_t>::max());
}

void SceneOctree::follow(std::size_t count) {
  gone_.clear();
  come_.clear();
  const auto words = pending_.words();
  for (; count > 0; --count) {
    while (words[cursor_] == 0) ++cursor_;
    const auto slot =
        static_cast<std::uint32_t>(64 * cursor_ + static_cast<unsigned>(std::countr_zero(words[cursor_])));
    pending_.reset(slot);
    --pending_slots_;
    const bool wanted = scene_.visible().test(slot);
    const bool there = tree_.contains(slot);
    const bool stays = wanted && there && tree_.move_within(slot);
    if (there && !stays) gone_.push_back(slot);
    if (wanted && !stays) come_.push_back(slot);
    if (stays && mirrored_.test(slot) != scene_.mirrored(slot)) tree_.renew(slot);
    scene_.mirrored(slot) ? mirrored_.set(slot) : mirrored_.reset(slot);
  }
  tree_.remove(gone_);
  tree_.insert(come_);
  if (gone_.size() + come_.size() <= kKept) return;
  tree_.forget_scratch();
  for (std::vector<std::uint32_t>* list : {&gone_, &come_}) *list = {};
}

void SceneOctree::update(const timeline::ChangeSet& changes) {
  note(changes);
  (void)catch_up(std::numeric_limits<std::size_t>::max());
}

void SceneOctree::note(const timeline::ChangeSet& changes) {
  for (const ObjectId id : changes.moved) {
    for (const std::uint32_t slot : scene_.slots_of(id)) {
      if (slot < scene_.solid_end()) tree_.forget_box(slot);
    }
  }
  for (const std::span<const ObjectId> ids :
       {changes.shown, changes.hidden, changes.moved, changes.remeshed}) {
    for (const ObjectId id : ids) {
      for (const std::uint32_t slot : scene_.slots_of(id)) {
        if (slot >= scene_.solid_end() || pending_.test(slot)) continue;
        pending_.set(slot);
        ++pending_slots_;
        cursor_ = std::min<std::size_t>(cursor_, slot / 64);
      }
    }
  }
}

bool SceneOctree::catch_up(std::size_t slots) {
  while (pending_slots_ > 0 && slots > 0) {
    const std::size_t some = std::min({pending_slots_, slots, kAtOnce});
    follow(some);
    slots -= some;
    refreshed_ = false;
  }
  if (pending_slots_ > 0) return false;
  refreshed_ = refreshed_ || tree_.refresh(slots);
  return refreshed_;
}

}  // namespace scenegen::render
