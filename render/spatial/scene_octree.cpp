#include "render/spatial/scene_octree.h"

#include <algorithm>
#include <bit>
#include <cassert>
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
      followed_(scene.solid_end()),
      moved_(scene.solid_end()) {
  count_pending();
  if (build == Build::at_once) (void)catch_up(std::numeric_limits<std::size_t>::max());
}

std::uint64_t SceneOctree::pending_in(std::size_t word) const {
  const std::uint64_t pending =
      (scene_.visible().words()[word] ^ followed_.words()[word]) | moved_.words()[word];
  const std::size_t end = scene_.solid_end();
  return 64 * word + 64 <= end ? pending : pending & ~(~std::uint64_t{0} << (end % 64));
}

void SceneOctree::count_pending() {
  pending_slots_ = 0;
  cursor_ = 0;
  for (std::size_t word = 0; word < moved_.words().size(); ++word)
    pending_slots_ += static_cast<std::size_t>(std::popcount(pending_in(word)));
}

void SceneOctree::follow(std::size_t count) {
  gone_.clear();
  come_.clear();
  for (; count > 0; --count) {
    std::uint64_t pending = pending_in(cursor_);
    while (pending == 0) {
      assert(cursor_ + 1 < moved_.words().size());
      pending = pending_in(++cursor_);
    }
    const auto slot =
        static_cast<std::uint32_t>(64 * cursor_ + static_cast<unsigned>(std::countr_zero(pending)));
    const bool wanted = scene_.visible().test(slot);
    wanted ? followed_.set(slot) : followed_.reset(slot);
    moved_.reset(slot);
    --pending_slots_;
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
      if (slot >= scene_.solid_end()) continue;
      tree_.forget_box(slot);
      moved_.set(slot);
    }
  }
  if (changes.count() > 0) count_pending();
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
