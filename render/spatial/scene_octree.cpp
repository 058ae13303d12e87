#include "render/spatial/scene_octree.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace scenegen::render {
namespace {

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

void SceneOctree::follow(std::uint32_t slot) {
  const bool wanted = scene_.visible().test(slot);
  if (wanted && !tree_.contains(slot)) {
    tree_.insert(slot);
  } else if (!wanted) {
    tree_.remove(slot);
  } else {
    tree_.move(slot);
    if (mirrored_.test(slot) != scene_.mirrored(slot)) tree_.renew(slot);
  }
  scene_.mirrored(slot) ? mirrored_.set(slot) : mirrored_.reset(slot);
}

void SceneOctree::update(const timeline::ChangeSet& changes) {
  note(changes);
  (void)catch_up(std::numeric_limits<std::size_t>::max());
}

void SceneOctree::note(const timeline::ChangeSet& changes) {
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
  const auto words = pending_.words();
  std::size_t left = slots;
  while (pending_slots_ > 0 && left > 0) {
    const std::uint64_t bits = words[cursor_];
    if (bits == 0) {
      ++cursor_;
      continue;
    }
    const auto slot =
        static_cast<std::uint32_t>(64 * cursor_ + static_cast<unsigned>(std::countr_zero(bits)));
    pending_.reset(slot);
    --pending_slots_;
    --left;
    follow(slot);
    refreshed_ = false;
  }
  if (pending_slots_ > 0) return false;
  refreshed_ = refreshed_ || tree_.refresh(left);
  return refreshed_;
}

}  // namespace scenegen::render
