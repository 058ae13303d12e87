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

/// Objects that come and go together: one animated parent (layout groups) or one instancing node (layout
/// instances).
struct Group {
  TrackId track;            ///< none: always visible (instances only)
  MeshId mesh;              ///< none in layout groups
  std::uint32_t first = 0;  ///< into NodePlan::grouped
  std::uint32_t count = 0;
  bool rotated = false;  ///< some instance has a rotation
  bool scaled = false;
};

/// One child of an object with a mesh track.
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
  Layout layout = Layout::nodes;
  VisibilityEncoding visibility = VisibilityEncoding::scale;

  std::vector<Group> groups;
  std::vector<std::uint32_t> grouped;  ///< objects, group by group, by index within a group
  /// Objects with nodes of their own beside the groups, ascending; in layout nodes it is empty and means all.
  std::vector<std::uint32_t> single;
  std::vector<std::uint32_t> wrapped;  ///< objects under an inserted `<name>/visible`, ascending
  std::vector<LookNode> looks;         ///< by object, then number
  Rows objects_of_frame, frames_of_frame, cameras_of_frame;

  // Node indices of the first of each kind.
  std::uint32_t first_object = 0, first_group = 0, first_frame = 0, first_camera = 0, first_wrapper = 0,
                first_look = 0, node_count = 0;
  /// Of groups, frames, cameras, wrappers and looks, in this order.
  UniqueNames names;

  std::uint64_t single_object_groups = 0;
  std::vector<std::string> notes;

  [[nodiscard]] bool pointer() const { return visibility != VisibilityEncoding::scale; }
  [[nodiscard]] bool scale() const { return visibility != VisibilityEncoding::pointer; }
  /// Objects that have nodes: all, or in layout instances the single ones.
  [[nodiscard]] std::size_t object_node_count(const Scene& scene) const {
    return layout == Layout::instances ? single.size() : scene.objects.size();
  }
  /// The object of node first_object + k.
  [[nodiscard]] std::uint32_t object_at(std::uint32_t k) const {
    return layout == Layout::instances ? single[k] : k;
  }
  /// Node of an object that has one.
  [[nodiscard]] std::uint32_t node_of(std::uint32_t object) const;
};

[[nodiscard]] NodePlan plan_nodes(const Scene& scene, const WriteOptions& options);

}  // namespace scenegen::gltf
