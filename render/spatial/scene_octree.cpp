#include "render/spatial/scene_octree.h"

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

SceneOctree::SceneOctree(const DrawScene& scene, std::uint32_t slots_per_node)
    : scene_(scene),
      tree_(
          scene.boxes(), [&scene](std::uint32_t slot) { return scene.primitive(slot).vertices; },
          options_of(scene, slots_per_node)),
      mirrored_(scene.slot_count()) {
  for (std::uint32_t slot = 0; slot < scene.solid_end(); ++slot) follow(slot);
  tree_.refresh();
}

void SceneOctree::follow(std::uint32_t slot) {
  if (slot >= scene_.solid_end()) return;
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
  for (const std::span<const ObjectId> ids :
       {changes.shown, changes.hidden, changes.moved, changes.remeshed}) {
    for (const ObjectId id : ids) {
      for (const std::uint32_t slot : scene_.slots_of(id)) follow(slot);
    }
  }
  tree_.refresh();
}

}  // namespace scenegen::render
