// Files of layout merged: objects out of what stands beside the merged meshes.
#include "scene/gltf/build.h"
#include "scene/limits.h"

namespace scenegen::gltf::reading {

namespace {

class MergedCheck {
 public:
  MergedCheck(const Document& document, Data& data, std::uint32_t meshes)
      : document_(document), data_(data), meshes_(meshes) {}
  /// Faults when the objects cannot be what the meshes were merged from.
  void run();

 private:
  void check_set(const Instances& set, const Place& at, bool counts);
  void check_components(std::uint32_t accessor, std::uint32_t components, std::uint64_t count,
                        const Place& at);

  const Document& document_;
  Data& data_;
  std::uint32_t meshes_;
  std::vector<std::uint32_t> ids_;
};

void MergedCheck::check_components(std::uint32_t index, std::uint32_t components, std::uint64_t count,
                                   const Place& at) {
  if (index == kNone) return;
  const Accessor& accessor = data_.accessor(index, at);
  if (accessor.components == components && accessor.count == count) return;
  reject(at, "accessor " + std::to_string(index) + " has " + std::to_string(accessor.count) +
                 " elements of " + std::to_string(accessor.components) + "; wanted " + std::to_string(count) +
                 " of " + std::to_string(components));
}

void MergedCheck::check_set(const Instances& set, const Place& at, bool counts) {
  check_index(set.mesh, meshes_, "meshes of objects", at.key("mesh"));
  const std::vector<std::uint32_t> ids = data_.integers(set.object_id, at.key("_OBJECT_ID"));
  if (ids.empty()) reject(at.key("_OBJECT_ID"), "no objects");
  if (set.translation == kNone) reject(at.key("TRANSLATION"), "missing");
  check_components(set.translation, 3, ids.size(), at.key("TRANSLATION"));
  check_components(set.rotation, 4, ids.size(), at.key("ROTATION"));
  check_components(set.scale, 3, ids.size(), at.key("SCALE"));
  if (counts) ids_.insert(ids_.end(), ids.begin(), ids.end());
}

void MergedCheck::run() {
  const Place root;
  const Place nodes = root.key("nodes");
  check_index(meshes_, document_.meshes.size() + 1, "meshes", root.key("meshes"));
  for (std::size_t n = 0; n < document_.nodes.size(); ++n) {
    const Node& node = document_.nodes[n];
    const NodeDetail* const detail = node.detail == kNone ? nullptr : &document_.node_details[node.detail];
    const Place here = nodes.at(n);
    if (detail == nullptr || detail->set_count == 0) {
      if (node.mesh != kNone) reject(here.key("mesh"), "a mesh that is none of the merged ones");
      continue;
    }
    if (detail->instanced) reject(here, "merged and instanced at once");
    if (detail->look != kNone) check_index(detail->shows, meshes_, "meshes of looks", here.key("extras"));
    const Place extras = here.key("extras");
    const Place ours = extras.key("scenegen");
    const Place objects = ours.key("objects");
    const bool counts = detail->look == kNone || detail->look == 0;
    for (std::uint32_t k = 0; k < detail->set_count; ++k)
      check_set(document_.instance_sets[detail->first_set + k], objects.at(k), counts);
  }
  std::vector<bool> taken(ids_.size());
  for (const std::uint32_t id : ids_) {
    if (id >= taken.size() || taken[id])
      reject(nodes,
             "object " + std::to_string(id) + " of " + std::to_string(taken.size()) + " is there twice");
    taken[id] = true;
  }
}

SceneExtras* extras_of(Document& document) {
  if (!document.ours || document.foreign || document.scenes.empty()) return nullptr;
  const std::uint32_t shown = document.scene == kNone ? 0 : document.scene;
  return shown < document.scene_extras.size() ? &document.scene_extras[shown] : nullptr;
}

}  // namespace

void settle_merged(Document& document, Data& data) {
  SceneExtras* const extras = extras_of(document);
  const bool merged = extras != nullptr && extras->merged_after != kNone;
  bool holds = merged;
  if (merged) {
    try {
      MergedCheck(document, data, extras->merged_after).run();
    } catch (const Fault& fault) {
      holds = false;
      extras->names.view = kNone;  // of objects that are not there
      document.ignored.add("/scenes/extras/scenegen/merged",
                           "what the file says of merged objects is damaged (" + fault.error.where + ": " +
                               fault.error.what + "); each merged mesh is read as one object");
    }
  }
  if (holds) document.meshes.resize(extras->merged_after);
  for (Node& node : document.nodes) {
    if (node.detail == kNone) continue;
    NodeDetail& detail = document.node_details[node.detail];
    if (detail.set_count == 0) continue;
    if (holds) {
      node.mesh = kNone;
      detail.instanced = true;
    } else {
      detail.set_count = 0;
      detail.look = kNone;
    }
  }
}

}  // namespace scenegen::gltf::reading
