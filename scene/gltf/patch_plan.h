// What becomes of the nodes of a document that gets new tracks: decided before a byte is written. Private to
// scene/gltf.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "scene/gltf/build.h"
#include "scene/gltf/document.h"
#include "scene/gltf/patch.h"
#include "scene/gltf/write_tracks.h"
#include "scene/name_table.h"

namespace scenegen::gltf::patching {

using reading::kNone;

/// What the JSON says of nodes beyond Document: who hangs on them.
struct NodeUses {
  static constexpr std::uint8_t kJoint = 1;           ///< of a skin, or its root
  static constexpr std::uint8_t kScaleElsewhere = 2;  ///< scaled by an animation behind the first
  static constexpr std::uint8_t kWeights = 4;         ///< morph weights are animated,
  static constexpr std::uint8_t kWeightsPointer = 8;  ///< by KHR_animation_pointer
  std::vector<std::uint8_t> of_node;
};

/// A node behind those of the file.
struct NewNode {
  enum class Kind : std::uint8_t {
    frame,  ///< moves what is below it
    leaf,   ///< draws an object's mesh in place of the object's own node
    look,   ///< one mesh of an object's mesh track
  };
  Kind kind = Kind::leaf;
  bool pointer = false;    ///< has KHR_node_visibility
  std::uint32_t name = 0;  ///< into NodePatch::new_names
  std::uint32_t mesh = kNone;
  std::uint32_t source = kNone;        ///< the file's node whose skin and weights it takes
  std::uint32_t object_mesh = kNone;   ///< leaf with looks: Objects::mesh
  std::uint32_t stands_for = kNone;    ///< leaf: the object's node in the file
  ObjectId object;                     ///< leaf: whose name it keeps
  std::uint32_t object_index = kNone;  ///< leaf: extras.scenegen.object
  std::uint32_t look = 0;
  Transform local;
};

/// What changes in a node of the file.
struct NodeEdit {
  std::uint32_t node = 0;
  bool drop_mesh = false;       ///< mesh, skin and weights go to new nodes
  bool add_visibility = false;  ///< KHR_node_visibility
  bool show = false;            ///< its visible is true
  bool as_trs = false;          ///< its matrix becomes translation, rotation, scale
  bool children_swapped = false;
  std::uint32_t mesh = kNone;        ///< instead of its own
  std::uint32_t looks_mesh = kNone;  ///< extras.scenegen.mesh
  std::uint32_t name = kNone;        ///< its new name, into NodePatch::new_names
  ObjectId keep_name;                ///< extras.scenegen.name: the object's
};

/// Of a frame's track.
[[nodiscard]] inline reading::Path path_of(Property property) {
  if (property == Property::translation) return reading::Path::translation;
  return property == Property::rotation ? reading::Path::rotation : reading::Path::scale;
}

struct PatchChannel {
  std::uint32_t sampler = 0, target = 0;
  reading::Path path = reading::Path::none;
};

struct NodePatch {
  std::vector<NewNode> new_nodes;
  NameTable new_names;
  std::vector<NodeEdit> edits;  ///< by node
  /// Children to add, by parent: (parent, child), node indices of the result.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> added;
  /// Children of a node or roots of scenes that are replaced by another node, or taken out (kNone).
  std::unordered_map<std::uint32_t, std::uint32_t> swapped;
  bool roots_swapped = false;
  bool moves_weights = false;          ///< animated morph weights go to other nodes with their mesh
  std::vector<PatchChannel> channels;  ///< of our animation
  AnimationPlan animation;
  std::vector<std::uint32_t>
      dropped;  ///< nodes, ascending: visibility of the file's first animation that ours replaces
  std::uint64_t first_new = 0;  ///< node index of new_nodes[0]

  /// Children to add to `parent`.
  [[nodiscard]] std::span<const std::pair<std::uint32_t, std::uint32_t>> added_to(std::uint32_t parent) const;
};

struct PatchInput {
  const SourceDocument& source;
  const Scene& scene;
  const PatchOptions& options;
  const reading::Document& document;
  const reading::Hierarchy& hierarchy;
  const NodeUses& uses;
};

/// Objects whose visibility is another than in the file; nodes of the file that would hide them all the same;
/// objects below such nodes that keep their times, which the node can then no longer give them.
struct Retiming {
  std::vector<std::uint8_t> retimed, pushed;  ///< by object; `pushed` may be empty: none
  std::vector<std::uint32_t> dropped;         ///< nodes, ascending: see NodePatch
  std::vector<std::uint32_t> invisible;       ///< of them, those that are not visible at rest
  [[nodiscard]] bool wants_track(std::uint32_t object) const {
    return retimed[object] != 0 || (!pushed.empty() && pushed[object] != 0);
  }
};
[[nodiscard]] Retiming find_retiming(const PatchInput& input);

/// `tracks` gets copies of the scene's tracks, and those that are derived from them; the plan's ids point
/// into it. Faults: something that cannot be expressed.
[[nodiscard]] NodePatch plan_patch(const PatchInput& input, Scene& tracks);

}  // namespace scenegen::gltf::patching
