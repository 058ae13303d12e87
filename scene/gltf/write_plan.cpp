#include "scene/gltf/write_plan.h"

#include <algorithm>
#include <charconv>
#include <numeric>

namespace scenegen::gltf {

namespace {

bool zero_scale(const Transform& transform) {
  return transform.scale == glm::vec3(0.0F);
}

/// Objects that cannot be in a group: on a frame or with looks.
std::vector<std::uint8_t> objects_apart(const Scene& scene) {
  std::vector<std::uint8_t> apart(scene.objects.size(), 0);
  for (std::size_t i = 0; i < apart.size(); ++i) apart[i] = scene.objects.frame[i].valid() ? 1 : 0;
  for (const ObjectMeshTrack& t : scene.object_mesh_tracks) apart[t.object.value] = 1;
  return apart;
}

/// Stable counting sort of `items` by key(item) in [0, keys).
template <class Key>
void sort_by_key(std::vector<std::uint32_t>& items, std::size_t keys, const Key& key) {
  std::vector<std::uint32_t> at(keys + 1, 0);
  for (const std::uint32_t item : items) ++at[key(item) + 1];
  std::partial_sum(at.begin(), at.end(), at.begin());
  std::vector<std::uint32_t> sorted(items.size());
  for (const std::uint32_t item : items) sorted[at[key(item)]++] = item;
  items = std::move(sorted);
}

/// Fills plan.groups and plan.grouped from the objects that are not apart. Without a track: key 0.
void make_groups(const Scene& scene, const std::vector<std::uint8_t>& apart, bool by_mesh, NodePlan& plan) {
  const Objects& objects = scene.objects;
  plan.groups.clear();
  plan.grouped.clear();
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    if (apart[i] == 0 && (by_mesh || objects.visibility[i].valid())) plan.grouped.push_back(i);
  }
  if (by_mesh) sort_by_key(plan.grouped, scene.meshes.size(), [&](auto i) { return objects.mesh[i].value; });
  sort_by_key(plan.grouped, scene.tracks.size() + 1,
              [&](auto i) { return objects.visibility[i].value + 1; });  // none wraps to 0
  for (std::uint32_t k = 0; k < plan.grouped.size(); ++k) {
    const std::uint32_t i = plan.grouped[k];
    const MeshId mesh = by_mesh ? objects.mesh[i] : MeshId{};
    if (plan.groups.empty() || plan.groups.back().track != objects.visibility[i] ||
        plan.groups.back().mesh != mesh) {
      plan.groups.push_back({objects.visibility[i], mesh, k, 0});
    }
    Group& group = plan.groups.back();
    ++group.count;
    const Transform& transform = objects.frame_from_object[i];
    group.rotated = group.rotated || transform.rotation != glm::quat(1.0F, 0.0F, 0.0F, 0.0F);
    group.scaled = group.scaled || transform.scale != glm::vec3(1.0F);
  }
  plan.single_object_groups = static_cast<std::uint64_t>(
      std::count_if(plan.groups.begin(), plan.groups.end(), [](const Group& g) { return g.count == 1; }));
}

void choose_layout(const Scene& scene, const WriteOptions& options, NodePlan& plan) {
  plan.layout = options.layout;
  if (plan.layout == Layout::automatic)
    plan.layout = scene.objects.size() >= kInstancesFrom ? Layout::instances : Layout::nodes;
  if (plan.layout == Layout::nodes) return;

  const std::vector<std::uint8_t> apart = objects_apart(scene);
  if (plan.layout == Layout::instances) {
    make_groups(scene, apart, true, plan);
    if (plan.single_object_groups * 2 > plan.groups.size()) {
      plan.notes.push_back(
          "instances: " + std::to_string(100 * plan.single_object_groups / plan.groups.size()) +
          " % of the groups hold one object; wrote layout groups instead");
      plan.layout = Layout::groups;
    }
  }
  if (plan.layout == Layout::groups) {
    make_groups(scene, apart, false, plan);
    if (!plan.scale())
      plan.notes.emplace_back(
          "groups with pointer visibility does not play in Babylon.js (it ignores it on nodes without a "
          "mesh)");
  }
  for (std::uint32_t i = 0; i < apart.size(); ++i) {
    const bool in_group =
        apart[i] == 0 && (plan.layout == Layout::instances || scene.objects.visibility[i].valid());
    if (!in_group) plan.single.push_back(i);
  }
}

/// Rows of the entries of `frame_of` by frame; entries without a frame are in none.
template <class Items>
Rows rows_by_frame(std::size_t frames, const Items& frame_of) {
  Rows rows;
  rows.begin.assign(frames + 1, 0);
  for (const FrameId frame : frame_of) {
    if (frame.valid()) ++rows.begin[frame.value + 1];
  }
  std::partial_sum(rows.begin.begin(), rows.begin.end(), rows.begin.begin());
  rows.items.resize(rows.begin.back());
  std::vector<std::uint32_t> at(rows.begin.begin(), rows.begin.end() - 1);
  for (std::uint32_t i = 0; i < frame_of.size(); ++i) {
    if (frame_of[i].valid()) rows.items[at[frame_of[i].value]++] = i;
  }
  return rows;
}

void plan_frames(const Scene& scene, NodePlan& plan) {
  const std::size_t count = scene.frames.size();
  std::vector<FrameId> of_frame(count), of_camera(scene.cameras.size());
  std::transform(scene.frames.begin(), scene.frames.end(), of_frame.begin(),
                 [](const Frame& f) { return f.parent; });
  std::transform(scene.cameras.begin(), scene.cameras.end(), of_camera.begin(),
                 [](const Camera& c) { return c.frame; });
  plan.objects_of_frame = rows_by_frame(count, scene.objects.frame);
  plan.frames_of_frame = rows_by_frame(count, of_frame);
  plan.cameras_of_frame = rows_by_frame(count, of_camera);
}

/// Written as they are (nothing is lost), but the specification wants matrices that decompose.
void note_sheared_frames(const Scene& scene, NodePlan& plan) {
  Transform ignored;
  for (const Frame& frame : scene.frames) {
    if (frame.has_matrix && !decompose(frame.matrix, ignored))
      plan.notes.push_back("frame '" + frame.name + "' has a matrix with shear, which validators object to");
  }
}

void plan_looks(const Scene& scene, NodePlan& plan) {
  std::vector<ObjectMeshTrack> by_object = scene.object_mesh_tracks;
  std::stable_sort(by_object.begin(), by_object.end(),
                   [](const auto& a, const auto& b) { return a.object < b.object; });
  for (const ObjectMeshTrack& t : by_object) {
    const std::size_t first = plan.looks.size();
    for (const float value : scene.values(t.track)) {
      const MeshId look(static_cast<std::uint64_t>(value));
      const auto known = std::find_if(plan.looks.begin() + static_cast<std::ptrdiff_t>(first),
                                      plan.looks.end(), [&](const LookNode& l) { return l.look == look; });
      if (known == plan.looks.end())
        plan.looks.push_back(
            {t.object.value, t.track, look, static_cast<std::uint32_t>(plan.looks.size() - first)});
    }
  }
}

void plan_wrappers(const Scene& scene, NodePlan& plan) {
  if (!plan.scale()) return;
  const auto in_group_node = [&](std::uint32_t object) {
    return plan.layout == Layout::groups &&
           !std::binary_search(plan.single.begin(), plan.single.end(), object);
  };
  for (std::uint32_t k = 0; k < plan.object_node_count(scene); ++k) {
    const std::uint32_t i = plan.object_at(k);
    if (scene.objects.visibility[i].valid() && zero_scale(scene.objects.frame_from_object[i]) &&
        !in_group_node(i))
      plan.wrapped.push_back(i);
  }
}

void number_nodes(const Scene& scene, NodePlan& plan) {
  const auto groups = static_cast<std::uint32_t>(plan.groups.size());
  const auto objects = static_cast<std::uint32_t>(plan.object_node_count(scene));
  plan.first_object = plan.layout == Layout::instances ? groups : 0;
  plan.first_group = plan.layout == Layout::instances ? 0 : objects;
  plan.first_frame = groups + objects;
  plan.first_camera = plan.first_frame + static_cast<std::uint32_t>(scene.frames.size());
  plan.first_wrapper = plan.first_camera + static_cast<std::uint32_t>(scene.cameras.size());
  plan.first_look = plan.first_wrapper + static_cast<std::uint32_t>(plan.wrapped.size());
  plan.node_count = plan.first_look + static_cast<std::uint32_t>(plan.looks.size());
}

void name_nodes(const Scene& scene, NodePlan& plan) {
  for (const Group& group : plan.groups) {
    std::string name = group.track.valid() ? "appear_" + std::to_string(group.track.value) : "static";
    if (group.mesh.valid()) name += "_mesh_" + std::to_string(group.mesh.value);
    plan.names.wish(name);
  }
  for (std::size_t i = 0; i < scene.frames.size(); ++i)
    plan.names.wish(scene.frames[i].name.empty() ? "frame_" + std::to_string(i) : scene.frames[i].name);
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    plan.names.wish(scene.cameras[i].name.empty() ? "camera_" + std::to_string(i) : scene.cameras[i].name);
  for (const std::uint32_t i : plan.wrapped)
    plan.names.wish(std::string(scene.objects.names[i]) + "/visible");
  for (const LookNode& look : plan.looks)
    plan.names.wish(std::string(scene.objects.names[look.object]) + "/look_" + std::to_string(look.number));
  plan.names.settle(scene.objects.names);
}

}  // namespace

std::uint32_t NodePlan::node_of(std::uint32_t object) const {
  if (layout != Layout::instances) return object;
  const auto at = std::lower_bound(single.begin(), single.end(), object);
  return first_object + static_cast<std::uint32_t>(at - single.begin());
}

NodePlan plan_nodes(const Scene& scene, const WriteOptions& options) {
  NodePlan plan;
  plan.visibility = options.visibility;
  choose_layout(scene, options, plan);
  plan_frames(scene, plan);
  note_sheared_frames(scene, plan);
  plan_looks(scene, plan);
  plan_wrappers(scene, plan);
  number_nodes(scene, plan);
  name_nodes(scene, plan);
  return plan;
}

}  // namespace scenegen::gltf
