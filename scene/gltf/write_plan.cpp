#include "scene/gltf/write_plan.h"

#include <algorithm>
#include <charconv>
#include <numeric>

namespace scenegen::gltf {

namespace {

bool zero_scale(const Transform& transform) {
  return transform.scale == glm::vec3(0.0F);
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
  if (plan.layout == Layout::nodes) {
    plan.objects_of_frame = rows_by_frame(count, scene.objects.frame);
  } else {
    std::vector<FrameId> of_group_node(plan.group_nodes.size());
    std::transform(plan.group_nodes.begin(), plan.group_nodes.end(), of_group_node.begin(),
                   [&](const GroupNode& n) { return plan.groups[n.group].frame; });
    plan.groups_of_frame = rows_by_frame(count, of_group_node);
    std::vector<FrameId> of_single(plan.single.size());
    std::transform(plan.single.begin(), plan.single.end(), of_single.begin(),
                   [&](std::uint32_t i) { return scene.objects.frame[i]; });
    plan.objects_of_frame = rows_by_frame(count, of_single);
    for (std::uint32_t& item : plan.objects_of_frame.items) item = plan.single[item];
  }
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
    if (!plan.is_single(t.object.value)) continue;
    const std::vector<MeshId> looks = looks_of(scene, t.track);
    for (std::uint32_t k = 0; k < looks.size(); ++k)
      plan.looks.push_back({t.object.value, t.track, looks[k], k});
  }
}

void plan_wrappers(const Scene& scene, NodePlan& plan) {
  if (!plan.scale()) return;
  for (std::uint32_t k = 0; k < plan.object_node_count(scene); ++k) {
    const std::uint32_t i = plan.object_at(k);
    if (scene.objects.visibility[i].valid() && zero_scale(scene.objects.frame_from_object[i]) &&
        plan.is_single(i))
      plan.wrapped.push_back(i);
  }
}

void number_nodes(const Scene& scene, NodePlan& plan) {
  const auto groups = static_cast<std::uint32_t>(plan.group_nodes.size());
  const auto objects = static_cast<std::uint32_t>(plan.object_node_count(scene));
  plan.first_object = plan.compact() ? groups : 0;
  plan.first_group = plan.compact() ? 0 : objects;
  plan.first_frame = groups + objects;
  plan.first_camera = plan.first_frame + static_cast<std::uint32_t>(scene.frames.size());
  plan.first_wrapper = plan.first_camera + static_cast<std::uint32_t>(scene.cameras.size());
  plan.first_look = plan.first_wrapper + static_cast<std::uint32_t>(plan.wrapped.size());
  plan.first_leaf = plan.first_look + static_cast<std::uint32_t>(plan.looks.size());
  plan.node_count = plan.first_leaf + plan.leaf_count();
}

/// Unique, but for names of objects.
std::string group_name(const Group& group, const GroupNode& node) {
  const auto part = [](const char* word, std::uint32_t number) { return word + std::to_string(number); };
  std::string name = group.track.valid() ? part("appear_", group.track.value) : "static";
  if (group.looks.valid()) name += part("_looks_", group.looks.value);
  if (group.mesh.valid()) name += part("_mesh_", group.mesh.value);
  if (group.looks.valid()) name += part("_look_", node.number);
  if (group.frame.valid()) name += part("_frame_", group.frame.value);
  return name;
}

std::string look_name(const Scene& scene, std::uint32_t object, std::uint32_t number) {
  return std::string(scene.objects.names[object]) + "/look_" + std::to_string(number);
}

void name_nodes(const Scene& scene, NodePlan& plan) {
  for (const GroupNode& node : plan.group_nodes) plan.names.wish(group_name(plan.groups[node.group], node));
  for (std::size_t i = 0; i < scene.frames.size(); ++i)
    plan.names.wish(scene.frames[i].name.empty() ? "frame_" + std::to_string(i) : scene.frames[i].name);
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    plan.names.wish(scene.cameras[i].name.empty() ? "camera_" + std::to_string(i) : scene.cameras[i].name);
  for (const std::uint32_t i : plan.wrapped)
    plan.names.wish(std::string(scene.objects.names[i]) + "/visible");
  for (const LookNode& look : plan.looks) plan.names.wish(look_name(scene, look.object, look.number));
  for (const Group& group : plan.groups) {
    if (plan.layout != Layout::groups) break;
    for (std::uint32_t number = 1; number < group.node_count; ++number) {
      for (std::uint32_t k = group.first; k < group.first + group.count; ++k)
        plan.names.wish(look_name(scene, plan.grouped[k], number));
    }
  }
  plan.names.settle(scene.objects.names);
}

}  // namespace

std::uint32_t NodePlan::node_of(std::uint32_t object) const {
  if (!compact()) return object;
  const auto at = std::lower_bound(single.begin(), single.end(), object);
  return first_object + static_cast<std::uint32_t>(at - single.begin());
}

bool NodePlan::is_single(std::uint32_t object) const {
  return layout == Layout::nodes || std::binary_search(single.begin(), single.end(), object);
}

std::uint32_t NodePlan::leaf_count() const {
  if (layout != Layout::groups || groups.empty()) return 0;
  const Group& last = groups.back();
  return last.first_leaf + last.count * (last.node_count - 1);
}

NodePlan plan_nodes(const Scene& scene, const WriteOptions& options) {
  NodePlan plan(scene);
  plan.visibility = options.visibility;
  plan_groups(scene, options, plan);
  plan_frames(scene, plan);
  note_sheared_frames(scene, plan);
  plan_looks(scene, plan);
  plan_wrappers(scene, plan);
  number_nodes(scene, plan);
  name_nodes(scene, plan);
  return plan;
}

}  // namespace scenegen::gltf
