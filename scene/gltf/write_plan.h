// What nodes and channels the file will have, and where: decided before a byte is written.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/write.h"
#include "scene/gltf/write_names.h"
#include "scene/gltf/write_tracks.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// Objects that move, come, go and change their look together. Its nodes are one animated parent (layout
/// groups) or one instancing node (layout instances), or one for each look.
struct Group {
  FrameId frame;  ///< none: the world
  TrackId track;  ///< visibility; none: always visible
  TrackId looks;  ///< mesh track; none: no looks
  MeshId mesh;    ///< Objects::mesh in layout instances; in others objects of several meshes share a node
  std::uint32_t first = 0;  ///< into NodePlan::grouped
  std::uint32_t count = 0;
  std::uint32_t first_set = 0;   ///< into NodePlan::sets
  std::uint32_t set_count = 0;   ///< layout instances: 1; layout merged: one for each Objects::mesh
  std::uint32_t first_node = 0;  ///< into NodePlan::group_nodes
  std::uint32_t node_count = 1;
  std::uint32_t first_leaf = 0;  ///< layout groups: nodes of its objects in the looks behind the first
};
/// Objects of one group and one mesh whose placements stand in accessors.
struct InstanceSet {
  MeshId mesh;              ///< Objects::mesh
  std::uint32_t first = 0;  ///< into NodePlan::grouped
  std::uint32_t count = 0;
  bool rotated = false;  ///< some instance has a rotation
  bool scaled = false;
};
struct GroupNode {
  std::uint32_t group = 0;
  std::uint32_t number = 0;  ///< of the look
  MeshId look;               ///< none: the group has no looks
  /// When it is shown, as each encoding has it; a pattern without a track: always. With visibility `pointer`
  /// the look goes by scale and visibility by pointer: a viewer that knows no pointers shows the right look.
  Pattern by_scale, by_pointer;
};

/// One child of an object with a mesh track and a node of its own.
struct LookNode {
  std::uint32_t object = 0;
  TrackId track;
  MeshId look;
  std::uint32_t number = 0;  ///< k of `<name>/look_<k>`
};

/// Lists of children in one array (compressed rows).
struct Rows {
  std::vector<std::uint32_t> begin;  ///< rows + 1
  std::vector<std::uint32_t> items;
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t row) const {
    return std::span(items).subspan(begin[row], begin[row + 1] - begin[row]);
  }
};

/// Memory: 8 bytes an object in `groups` and `instances`, 0 in `nodes`; 4 more for objects with nodes of
/// their own beside groups.
struct NodePlan {
  static constexpr std::uint32_t kNoGroup = 0xFFFFFFFF;
  explicit NodePlan(const Scene& scene) : tracks(scene) {}

  Layout layout = Layout::nodes;
  VisibilityEncoding visibility = VisibilityEncoding::scale;
  bool id_table = false;  ///< as in WriteOptions

  FileTracks tracks;
  std::vector<Group> groups;
  std::vector<InstanceSet> sets;       ///< by group; none in layout groups
  std::vector<GroupNode> group_nodes;  ///< by group, then look
  std::vector<std::uint32_t> grouped;  ///< objects, group by group; by index, or in instances by placement
  /// The tracks behind combined ones, for scenes[0].extras.scenegen.timelines: from the animation alone
  /// nobody could tell what a hidden object looks like.
  std::vector<TrackId> timelines;
  std::vector<std::uint32_t> timeline_of_track;  ///< empty when there are none
  /// Objects with nodes of their own beside the groups, ascending; in layout nodes it is empty and means all.
  std::vector<std::uint32_t> single;
  std::vector<std::uint32_t> look_groups;  ///< by object, kNoGroup; empty when there are none
  std::vector<std::uint32_t> wrapped;      ///< objects under an inserted `<name>/visible`, ascending
  std::vector<LookNode> looks;             ///< by object, then number
  Rows objects_of_frame;                   ///< without those in groups
  Rows groups_of_frame;                    ///< group nodes
  Rows frames_of_frame, cameras_of_frame;

  // Node indices of the first of each kind.
  std::uint32_t first_object = 0, first_group = 0, first_frame = 0, first_camera = 0, first_wrapper = 0,
                first_look = 0, first_leaf = 0, node_count = 0;
  /// Of group nodes, frames, cameras, wrappers, looks and leaves, in this order.
  UniqueNames names;

  std::uint64_t single_object_groups = 0;
  std::vector<std::string> notes;

  [[nodiscard]] bool pointer() const { return visibility != VisibilityEncoding::scale; }
  [[nodiscard]] bool scale() const { return visibility != VisibilityEncoding::pointer; }
  /// Objects in groups have no nodes.
  [[nodiscard]] bool compact() const { return layout == Layout::instances || layout == Layout::merged; }
  /// Objects that have nodes: all, or in compact layouts the single ones.
  [[nodiscard]] std::size_t object_node_count(const Scene& scene) const {
    return compact() ? single.size() : scene.objects.size();
  }
  /// The object of node first_object + k.
  [[nodiscard]] std::uint32_t object_at(std::uint32_t k) const { return compact() ? single[k] : k; }
  /// Has a node of its own that carries its channels.
  [[nodiscard]] bool is_single(std::uint32_t object) const;
  [[nodiscard]] std::uint32_t leaf_count() const;
  /// First of the nodes of a group's objects in look `number` >= 1 (layout groups).
  [[nodiscard]] std::uint32_t leaf_of(const Group& group, std::uint32_t number) const {
    return first_leaf + group.first_leaf + (number - 1) * group.count;
  }
  /// Layout groups: the group of an object that is in one with looks.
  [[nodiscard]] const Group* look_group(std::uint32_t object) const {
    const std::uint32_t g = look_groups.empty() ? kNoGroup : look_groups[object];
    return g == kNoGroup ? nullptr : &groups[g];
  }
  /// Node of an object that has one.
  [[nodiscard]] std::uint32_t node_of(std::uint32_t object) const;
};

/// The meshes of a mesh track in the order in which it first shows them: look 0, look 1, …
[[nodiscard]] std::vector<MeshId> looks_of(const Scene& scene, TrackId mesh_track);

/// Chooses the layout; fills groups, group_nodes, grouped, single and timelines.
void plan_groups(const Scene& scene, const WriteOptions& options, NodePlan& plan);

[[nodiscard]] NodePlan plan_nodes(const Scene& scene, const WriteOptions& options);

}  // namespace scenegen::gltf
