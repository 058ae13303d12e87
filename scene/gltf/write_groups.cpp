// Which objects share nodes: those that move, come, go and change their look together.
#include <algorithm>
#include <numeric>
#include <tuple>

#include "scene/gltf/write_plan.h"

namespace scenegen::gltf {

namespace {

/// Mesh track of every object; empty when no object has one.
std::vector<TrackId> mesh_tracks(const Scene& scene) {
  std::vector<TrackId> out(scene.object_mesh_tracks.empty() ? 0 : scene.objects.size());
  for (const ObjectMeshTrack& t : scene.object_mesh_tracks) out[t.object.value] = t.track;
  return out;
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

/// Fills plan.groups and plan.grouped. Frames first, so that what is nowhere special comes first (an id that
/// is none wraps to 0).
void make_groups(const Scene& scene, const std::vector<TrackId>& looks, NodePlan& plan) {
  const Objects& objects = scene.objects;
  const bool all = plan.compact();  // in layout groups what neither comes, goes nor changes needs no parent
  const bool by_mesh = plan.layout == Layout::instances;
  const auto looks_at = [&](std::uint32_t i) { return looks.empty() ? TrackId() : looks[i]; };
  plan.groups.clear();
  plan.grouped.clear();
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    if (all || objects.visibility[i].valid() || looks_at(i).valid()) plan.grouped.push_back(i);
  }
  if (all) sort_by_key(plan.grouped, scene.meshes.size(), [&](auto i) { return objects.mesh[i].value; });
  if (!looks.empty())
    sort_by_key(plan.grouped, scene.tracks.size() + 1, [&](auto i) { return looks[i].value + 1; });
  sort_by_key(plan.grouped, scene.tracks.size() + 1, [&](auto i) { return objects.visibility[i].value + 1; });
  if (!scene.frames.empty())
    sort_by_key(plan.grouped, scene.frames.size() + 1, [&](auto i) { return objects.frame[i].value + 1; });
  for (std::uint32_t k = 0; k < plan.grouped.size(); ++k) {
    const std::uint32_t i = plan.grouped[k];
    const MeshId mesh = by_mesh ? objects.mesh[i] : MeshId{};
    const bool same = !plan.groups.empty() && plan.groups.back().frame == objects.frame[i] &&
                      plan.groups.back().track == objects.visibility[i] &&
                      plan.groups.back().looks == looks_at(i) && plan.groups.back().mesh == mesh;
    if (!same) plan.groups.push_back({objects.frame[i], objects.visibility[i], looks_at(i), mesh, k, 0});
    ++plan.groups.back().count;
  }
}

/// By rotation and scale, then index: so groups of bricks that are laid alike have equal lists of rotations
/// and scales, which are then written once (scene/gltf/write_instances.h).
void order_instances(const Scene& scene, NodePlan& plan) {
  const auto key = [&](std::uint32_t i) {
    const Transform& t = scene.objects.frame_from_object[i];
    return std::tuple(t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w, t.scale.x, t.scale.y, t.scale.z,
                      i);
  };
  for (const Group& group : plan.groups) {
    const auto first = plan.grouped.begin() + group.first;
    std::sort(first, first + group.count, [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  }
}

/// Objects alone in their group get nodes of their own, as in layout nodes. In layout groups those of the
/// world keep their parent: a program that looks for `appear_…` finds every moment.
void dissolve_single_groups(NodePlan& plan) {
  const auto alone = [&](const Group& g) {
    return g.count == 1 && (plan.layout == Layout::instances || g.frame.valid() || g.looks.valid());
  };
  std::vector<std::uint32_t> grouped;
  grouped.reserve(plan.grouped.size());
  for (Group& group : plan.groups) {
    const auto first = static_cast<std::uint32_t>(grouped.size());
    if (alone(group)) continue;
    const auto begin = plan.grouped.begin() + group.first;
    grouped.insert(grouped.end(), begin, begin + group.count);
    group.first = first;
  }
  std::erase_if(plan.groups, alone);
  plan.grouped = std::move(grouped);
}

void find_singles(std::size_t objects, NodePlan& plan) {
  std::vector<bool> in_group(objects);
  for (const std::uint32_t i : plan.grouped) in_group[i] = true;
  for (std::uint32_t i = 0; i < objects; ++i) {
    if (!in_group[i]) plan.single.push_back(i);
  }
}

/// Instances are worth their extension when they save nodes.
bool degenerate(const NodePlan& plan) {
  const std::size_t groups = plan.groups.size();
  return plan.single_object_groups * 2 > groups && groups * 2 > plan.grouped.size();
}

void make_sets(const Scene& scene, NodePlan& plan) {
  const Objects& objects = scene.objects;
  for (Group& group : plan.groups) {
    group.first_set = static_cast<std::uint32_t>(plan.sets.size());
    for (std::uint32_t k = group.first; k < group.first + group.count; ++k) {
      const std::uint32_t i = plan.grouped[k];
      if (k == group.first || plan.sets.back().mesh != objects.mesh[i])
        plan.sets.push_back({objects.mesh[i], k, 0});
      InstanceSet& set = plan.sets.back();
      ++set.count;
      const Transform& transform = objects.frame_from_object[i];
      set.rotated = set.rotated || transform.rotation != glm::quat(1.0F, 0.0F, 0.0F, 0.0F);
      set.scaled = set.scaled || transform.scale != glm::vec3(1.0F);
    }
    group.set_count = static_cast<std::uint32_t>(plan.sets.size()) - group.first_set;
  }
}

std::uint32_t timeline_of(const Scene& scene, TrackId track, NodePlan& plan) {
  constexpr std::uint32_t kNone = TrackId::kNone;
  if (plan.timeline_of_track.empty()) plan.timeline_of_track.assign(scene.tracks.size(), kNone);
  std::uint32_t& slot = plan.timeline_of_track[track.value];
  if (slot == kNone) {
    slot = static_cast<std::uint32_t>(plan.timelines.size());
    plan.timelines.push_back(track);
  }
  return slot;
}

void make_group_nodes(const Scene& scene, NodePlan& plan) {
  std::uint32_t leaves = 0;
  for (std::uint32_t g = 0; g < plan.groups.size(); ++g) {
    Group& group = plan.groups[g];
    group.first_node = static_cast<std::uint32_t>(plan.group_nodes.size());
    group.first_leaf = leaves;
    if (!group.looks.valid()) {
      GroupNode node{g, 0, {}, {}, {}};
      if (plan.scale()) node.by_scale.track = group.track;
      if (plan.pointer()) node.by_pointer.track = group.track;
      plan.group_nodes.push_back(node);
      continue;
    }
    if (group.track.valid()) (void)timeline_of(scene, group.track, plan);
    (void)timeline_of(scene, group.looks, plan);
    const TrackId shown_by = plan.tracks.combine(group.track, group.looks);  // visible and in a look
    for (const MeshId look : looks_of(scene, group.looks)) {
      const auto number = static_cast<std::uint32_t>(plan.group_nodes.size()) - group.first_node;
      if (!plan.scale()) {
        plan.group_nodes.push_back({g, number, look, {group.looks, look}, {group.track, {}}});
      } else {
        const Pattern pattern{shown_by, look};
        plan.group_nodes.push_back({g, number, look, pattern, plan.pointer() ? pattern : Pattern{}});
      }
    }
    group.node_count = static_cast<std::uint32_t>(plan.group_nodes.size()) - group.first_node;
    if (plan.layout != Layout::groups) continue;
    leaves += group.count * (group.node_count - 1);
    plan.look_groups.resize(scene.objects.size(), NodePlan::kNoGroup);
    for (std::uint32_t k = group.first; k < group.first + group.count; ++k)
      plan.look_groups[plan.grouped[k]] = g;
  }
}

}  // namespace

std::vector<MeshId> looks_of(const Scene& scene, TrackId mesh_track) {
  std::vector<MeshId> looks;
  for (const float value : scene.values(mesh_track)) {
    const MeshId look(static_cast<std::uint64_t>(value));
    if (std::find(looks.begin(), looks.end(), look) == looks.end()) looks.push_back(look);
  }
  return looks;
}

void plan_groups(const Scene& scene, const WriteOptions& options, NodePlan& plan) {
  plan.layout = options.layout;
  if (plan.layout == Layout::automatic)
    plan.layout = scene.objects.size() >= kInstancesFrom ? Layout::instances : Layout::nodes;
  if (plan.layout == Layout::nodes) return;

  const std::vector<TrackId> looks = mesh_tracks(scene);
  if (plan.layout == Layout::instances) {
    make_groups(scene, looks, plan);
    plan.single_object_groups = static_cast<std::uint64_t>(
        std::count_if(plan.groups.begin(), plan.groups.end(), [](const Group& g) { return g.count == 1; }));
    if (degenerate(plan)) {
      plan.notes.push_back(
          "instances: " + std::to_string(100 * plan.single_object_groups / plan.groups.size()) +
          " % of the groups hold one object; wrote layout groups instead");
      plan.layout = Layout::groups;
    }
  }
  if (plan.layout == Layout::merged) make_groups(scene, looks, plan);
  if (plan.layout == Layout::groups) {
    make_groups(scene, looks, plan);
    if (!plan.scale())
      plan.notes.emplace_back(
          "groups with pointer visibility does not play in Babylon.js (it ignores it on nodes without a "
          "mesh)");
  }
  if (plan.layout != Layout::merged) dissolve_single_groups(plan);
  if (plan.layout == Layout::instances) order_instances(scene, plan);
  if (plan.compact()) make_sets(scene, plan);
  find_singles(scene.objects.size(), plan);
  make_group_nodes(scene, plan);
  // Looks of one object must find each other even when a tool has lost the table.
  plan.id_table = options.id_table && plan.layout == Layout::instances && plan.timelines.empty();
}

}  // namespace scenegen::gltf
