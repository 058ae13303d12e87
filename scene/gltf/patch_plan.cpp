#include "scene/gltf/patch_plan.h"

#include <algorithm>

#include "scene/gltf/write_names.h"

namespace scenegen::gltf::patching {

using reading::Node;
using reading::NodeDetail;
using reading::Path;
using reading::Place;
using reading::reject;

namespace {

/// A channel before it has a sampler.
struct Want {
  enum class Kind : std::uint8_t { scale, pointer, value };
  Kind kind = Kind::scale;
  Path path = Path::none;
  std::uint32_t target = 0;
  TrackId track;
  MeshId look;
  glm::vec3 shown{1.0F};
  float divisor = 1.0F;
};

/// What one object gets.
struct Task {
  ObjectId object;
  std::uint32_t node = 0;
  TrackId visibility;         ///< none: no change
  FrameId frame;              ///< new; none: no change
  TrackId mesh_track;         ///< new; none: no change
  std::vector<MeshId> looks;  ///< of mesh_track, in order of first appearance; at least two
  MeshId mesh;                ///< the one shown when there are no looks
  bool mesh_changes = false;
};

class PatchPlanner {
 public:
  PatchPlanner(const PatchInput& in, Scene& tracks)
      : in_(in),
        document_(in.document),
        scene_(in.scene),
        tracks_(tracks),
        old_frames_(in.source.node_of_frame.size()),
        edit_of_node_(in.document.nodes.size(), kNone) {}

  NodePatch plan();

 private:
  [[nodiscard]] const NodeDetail* detail(std::uint32_t node) const {
    const std::uint32_t i = document_.nodes[node].detail;
    return i == kNone ? nullptr : &document_.node_details[i];
  }
  [[nodiscard]] bool has_looks(std::uint32_t node) const {
    const NodeDetail* const d = detail(node);
    return document_.ours && d != nullptr && d->mesh != kNone && document_.nodes[node].mesh == kNone;
  }
  /// One of several nodes that draw an object of ours, a look each.
  [[nodiscard]] bool is_group_look(const NodeDetail& d) const {
    return document_.ours && !document_.foreign && d.look != kNone;
  }
  [[nodiscard]] bool by_scale() const { return in_.options.visibility != VisibilityEncoding::pointer; }
  [[nodiscard]] bool by_pointer() const { return in_.options.visibility != VisibilityEncoding::scale; }
  [[nodiscard]] std::uint32_t next_node() const {
    return static_cast<std::uint32_t>(document_.nodes.size() + out_.new_nodes.size());
  }
  [[nodiscard]] bool is_new_frame(FrameId frame) const { return frame.valid() && frame.value >= old_frames_; }
  [[nodiscard]] std::string name_of(ObjectId object) const {
    return std::string(scene_.objects.names[object.value]);
  }

  void check_counts() const;
  void find_looks();
  [[nodiscard]] TrackId always();
  [[nodiscard]] bool task_of(std::uint32_t object, Task& task);
  void apply(const Task& task);
  void check_skin(const Task& task, const Place& at) const;
  [[nodiscard]] bool exclusive(std::uint32_t node) const;
  [[nodiscard]] bool own_frame(const Task& task) const;
  [[nodiscard]] glm::vec3 own_scale(const Task& task) const;
  [[nodiscard]] bool scale_possible(const Task& task) const;
  [[nodiscard]] FrameId former_frame(FrameId frame) const;
  void check_former_frame(const Task& task, const Place& at) const;
  std::uint32_t frame_node(FrameId frame, std::uint32_t anchor, bool& is_new);
  void insert_above(const Task& task);
  std::uint32_t hang_below(const Task& task);
  std::uint32_t add_leaf(const Task& task, std::uint32_t parent);
  void add_looks(const Task& task, std::uint32_t parent);
  void want_visibility(const Task& task, std::uint32_t node, const glm::vec3& shown);
  void want_frame_tracks();
  void want_constant_scales();
  void want_material_tracks();
  void settle_names();
  void make_channels();
  NodeEdit& edit(std::uint32_t node);
  std::uint32_t wish(const std::string& name);

  const PatchInput& in_;
  const reading::Document& document_;
  const Scene& scene_;
  Scene& tracks_;
  NodePatch out_;
  Place root_;
  Place nodes_ = root_.key("nodes");
  std::size_t old_frames_;
  std::vector<std::uint32_t> edit_of_node_;
  Retiming retiming_;
  std::vector<TrackId> looks_of_object_;  ///< empty: none
  TrackId always_;
  std::vector<Want> wants_;
  UniqueNames names_;
  std::vector<std::pair<std::uint32_t, ObjectId>>
      animated_;  ///< nodes of the file that channels of ours drive
  struct FrameNode {
    FrameId frame;
    std::uint32_t node = 0;
    glm::mat3 linear{1.0F};  ///< of translations of the frame to those of the node
  };
  std::vector<FrameNode> frame_nodes_;
  std::unordered_map<std::uint64_t, std::uint32_t> frame_node_;  ///< (frame, anchor), into frame_nodes_
};

void PatchPlanner::check_counts() const {
  if (in_.source.merged)
    reject(root_, "a file of layout merged, whose objects have no nodes; layout nodes gives them some");
  if (scene_.objects.size() == in_.source.node_of_object.size() && scene_.frames.size() >= old_frames_ &&
      scene_.tracks.size() >= in_.source.track_count && scene_.meshes.size() >= document_.meshes.size() &&
      scene_.materials.size() >= document_.materials.size())
    return;
  reject(root_, "the scene to be written is not the one that was read from this document");
}

NodeEdit& PatchPlanner::edit(std::uint32_t node) {
  std::uint32_t& at = edit_of_node_[node];
  if (at == kNone) {
    at = static_cast<std::uint32_t>(out_.edits.size());
    out_.edits.emplace_back().node = node;
  }
  return out_.edits[at];
}

std::uint32_t PatchPlanner::wish(const std::string& name) {
  names_.wish(name);
  return static_cast<std::uint32_t>(names_.size() - 1);
}

TrackId PatchPlanner::always() {
  constexpr float kStart[] = {0.0F};
  constexpr float kShown[] = {1.0F};
  if (!always_.valid())
    always_ = tracks_.add_track(Property::visibility, Interpolation::step, kStart, kShown);
  return always_;
}

void PatchPlanner::find_looks() {
  for (const ObjectMeshTrack& t : scene_.object_mesh_tracks) {
    if (t.track.value < in_.source.track_count) continue;
    looks_of_object_.resize(scene_.objects.size());
    looks_of_object_[t.object.value] = t.track;
  }
}

bool PatchPlanner::task_of(std::uint32_t object, Task& task) {
  task = Task();
  task.object = ObjectId(object);
  task.node = in_.source.node_of_object[object];
  if (retiming_.wants_track(object)) {
    task.visibility = scene_.objects.visibility[object];
    if (!task.visibility.valid()) task.visibility = always();
  }
  if (is_new_frame(scene_.objects.frame[object])) task.frame = scene_.objects.frame[object];
  task.mesh = scene_.objects.mesh[object];
  if (!looks_of_object_.empty() && looks_of_object_[object].valid()) {
    for (const float value : scene_.values(looks_of_object_[object])) {
      const MeshId look(static_cast<std::uint64_t>(value));
      if (std::find(task.looks.begin(), task.looks.end(), look) == task.looks.end())
        task.looks.push_back(look);
    }
    task.mesh_track = looks_of_object_[object];
    if (task.looks.size() == 1) {  // always this one: no timeline at all
      task.mesh = task.looks[0];
      task.looks.clear();
      task.mesh_track = {};
    }
  }
  const Node& node = document_.nodes[task.node];
  const NodeDetail* const d = detail(task.node);
  const bool shares_node = d != nullptr && (d->instanced || is_group_look(*d));
  const std::uint32_t mesh_before = node.mesh != kNone || d == nullptr ? node.mesh : d->mesh;
  task.mesh_changes = !shares_node && task.mesh.value != mesh_before;
  return task.visibility.valid() || task.frame.valid() || task.mesh_track.valid() || task.mesh_changes;
}

void PatchPlanner::check_skin(const Task& task, const Place& at) const {
  const Place skin = at.key("skin");
  const std::string who = "'" + reading::printable(name_of(task.object)) + "' has a skin, ";
  if (task.frame.valid())
    reject(skin,
           who + "so its node's place moves nothing: it can appear and disappear, but not drop or move");
  if (task.mesh_track.valid())
    reject(skin,
           who + "so children with other looks would not be hidden by their scale: color it by pointer");
  if (task.visibility.valid() && by_scale())
    reject(skin, who + "so the scale of its node does not hide it: use --visibility pointer");
}

/// Nothing but the object hangs on the node: what happens to the node happens to the object only.
bool PatchPlanner::exclusive(std::uint32_t node) const {
  const Node& n = document_.nodes[node];
  if (n.camera != kNone || n.has_other || (in_.uses.of_node[node] & NodeUses::kJoint) != 0) return false;
  const bool looks = has_looks(node);
  for (std::uint32_t k = 0; k < n.child_count; ++k) {
    const NodeDetail* const d = detail(document_.children[n.first_child + k]);
    if (!looks || d == nullptr || d->look == kNone) return false;
  }
  return true;
}

FrameId PatchPlanner::former_frame(FrameId frame) const {
  while (is_new_frame(frame)) frame = scene_.frames[frame.value].parent;
  return frame;
}

/// The file's node is itself a frame of the scene, with the object in its origin.
bool PatchPlanner::own_frame(const Task& task) const {
  const FrameId former = former_frame(scene_.objects.frame[task.object.value]);
  return former.valid() && in_.source.node_of_frame[former.value] == task.node;
}

glm::vec3 PatchPlanner::own_scale(const Task& task) const {
  if (!own_frame(task)) return scene_.objects.frame_from_object[task.object.value].scale;
  const Frame& frame = scene_.frames[former_frame(scene_.objects.frame[task.object.value]).value];
  return frame.local.scale;
}

bool PatchPlanner::scale_possible(const Task& task) const {
  if (own_scale(task) == glm::vec3(0.0F)) return false;
  if ((in_.uses.of_node[task.node] & NodeUses::kScaleElsewhere) != 0) return false;
  if (const NodeDetail* const d = detail(task.node); d != nullptr && d->has_matrix) {
    constexpr float kExact = 1e-6F;
    Transform ignored;
    if (!decompose(d->matrix, ignored, kExact)) return false;
  }
  if (!own_frame(task)) return true;
  const FrameId former = former_frame(scene_.objects.frame[task.object.value]);
  return std::none_of(scene_.frame_tracks.begin(), scene_.frame_tracks.end(), [&](const FrameTrack& t) {
    return t.frame == former && scene_.tracks[t.track.value].property == Property::scale;
  });
}

void PatchPlanner::check_former_frame(const Task& task, const Place& at) const {
  const FrameId former = former_frame(task.frame);
  std::uint32_t node = task.node;
  if (!former.valid()) return;
  while (node != kNone && node != in_.source.node_of_frame[former.value]) node = in_.hierarchy.parent[node];
  if (node == kNone)
    reject(at, "the new frame of '" + reading::printable(name_of(task.object)) +
                   "' does not hang on the frame that it had");
}

/// The node of `frame` below `anchor` (a node of the file, or none), made at its first use together with
/// those of the new frames above it. `is_new`: the topmost was made now and hangs nowhere yet.
std::uint32_t PatchPlanner::frame_node(FrameId frame, std::uint32_t anchor, bool& is_new) {
  const std::uint64_t key = (std::uint64_t{frame.value} << 32) | anchor;
  if (const auto known = frame_node_.find(key); known != frame_node_.end()) {
    is_new = false;
    return frame_nodes_[known->second].node;
  }
  is_new = true;
  const Frame& f = scene_.frames[frame.value];
  std::uint32_t above = kNone;
  if (is_new_frame(f.parent)) above = frame_node(f.parent, anchor, is_new);
  const std::uint32_t node = next_node();
  NewNode& made = out_.new_nodes.emplace_back();
  made.kind = NewNode::Kind::frame;
  made.name = wish(f.name.empty() ? "frame_" + std::to_string(frame.value) : f.name);
  made.local = f.local;
  frame_node_.emplace(key, frame_nodes_.size());
  frame_nodes_.push_back({frame, node, glm::mat3(1.0F)});
  if (above != kNone) out_.added.emplace_back(above, node);
  return node;
}

/// Puts the new frame's node between the object's node and what is above it.
void PatchPlanner::insert_above(const Task& task) {
  const std::uint32_t parent = in_.hierarchy.parent[task.node];
  bool is_new = false;
  const std::uint32_t node = frame_node(task.frame, parent, is_new);
  out_.added.emplace_back(node, task.node);
  std::uint32_t top = node;
  if (is_new) {
    for (FrameId f = scene_.frames[task.frame.value].parent; is_new_frame(f);
         f = scene_.frames[f.value].parent)
      top = frame_nodes_[frame_node_.at((std::uint64_t{f.value} << 32) | parent)].node;
  }
  out_.swapped.emplace(task.node, is_new ? top : kNone);
  if (parent == kNone) {
    out_.roots_swapped = true;
  } else {
    edit(parent).children_swapped = true;
  }
}

/// Hangs the new frame below the object's node instead; returns the frame's node. Where the frame is above
/// the node's own transform N, what it does is done in N's coordinates: N^-1 F N.
std::uint32_t PatchPlanner::hang_below(const Task& task) {
  bool is_new = false;
  const std::uint32_t node = frame_node(task.frame, task.node, is_new);
  std::uint32_t top = node;
  for (FrameId f = task.frame; is_new_frame(f); f = scene_.frames[f.value].parent) {
    FrameNode& made = frame_nodes_[frame_node_.at((std::uint64_t{f.value} << 32) | task.node)];
    top = made.node;
    if (own_frame(task)) continue;
    const glm::mat3 own(scene_.objects.frame_from_object[task.object.value].matrix());
    if (own == glm::mat3(1.0F)) continue;
    const Place at = nodes_.at(task.node);
    if (glm::determinant(own) == 0.0F) reject(at.key("scale"), "a node without extent cannot be moved");
    const Frame& frame = scene_.frames[f.value];
    const bool turns =
        frame.local.rotation != glm::quat(1.0F, 0.0F, 0.0F, 0.0F) || frame.local.scale != glm::vec3(1.0F) ||
        std::any_of(scene_.frame_tracks.begin(), scene_.frame_tracks.end(), [&](const auto& t) {
          return t.frame == f && scene_.tracks[t.track.value].property != Property::translation;
        });
    if (turns) {
      reject(at,
             "other things hang on the node, and it is turned or scaled: a frame that turns or scales cannot "
             "be put below it");
    }
    made.linear = glm::inverse(own);
    NewNode& new_node = out_.new_nodes[made.node - document_.nodes.size()];
    new_node.local.translation_m = made.linear * new_node.local.translation_m;
  }
  out_.added.emplace_back(task.node, top);
  return node;
}

std::uint32_t PatchPlanner::add_leaf(const Task& task, std::uint32_t parent) {
  const std::uint32_t node = next_node();
  const NodeDetail* const d = detail(task.node);
  NewNode leaf;
  leaf.kind = NewNode::Kind::leaf;
  leaf.name = wish(name_of(task.object) + "/visible");
  leaf.object = task.object;
  leaf.stands_for = task.node;
  if (d != nullptr && document_.ours && d->stands_for != kNone) leaf.stands_for = d->stands_for;
  leaf.pointer = by_pointer() && task.visibility.valid();
  if (d != nullptr && document_.ours && !document_.foreign) leaf.object_index = d->object;
  if (has_looks(task.node)) {
    leaf.object_mesh = d->mesh;
    const Node& n = document_.nodes[task.node];
    for (std::uint32_t k = 0; k < n.child_count; ++k) {
      const std::uint32_t child = document_.children[n.first_child + k];
      const NodeDetail* const c = detail(child);
      if (c == nullptr || c->look == kNone) continue;
      out_.swapped.emplace(child, kNone);
      edit(task.node).children_swapped = true;
      out_.added.emplace_back(node, child);
    }
  } else if (task.looks.empty()) {
    leaf.mesh = task.mesh.value;
    leaf.source = task.node;
  } else {
    leaf.object_mesh = task.mesh.value;
  }
  out_.new_nodes.push_back(leaf);
  out_.added.emplace_back(parent, node);
  edit(task.node).drop_mesh = true;
  return node;
}

void PatchPlanner::add_looks(const Task& task, std::uint32_t parent) {
  for (std::uint32_t k = 0; k < task.looks.size(); ++k) {
    const std::uint32_t node = next_node();
    NewNode look;
    look.kind = NewNode::Kind::look;
    look.name = wish(name_of(task.object) + "/look_" + std::to_string(k));
    look.mesh = task.looks[k].value;
    look.source = task.node;
    look.look = k;
    out_.new_nodes.push_back(look);
    out_.added.emplace_back(parent, node);
    wants_.push_back(
        {Want::Kind::scale, Path::scale, node, task.mesh_track, task.looks[k], glm::vec3(1.0F), 1.0F});
  }
}

void PatchPlanner::want_visibility(const Task& task, std::uint32_t node, const glm::vec3& shown) {
  if (by_scale()) wants_.push_back({Want::Kind::scale, Path::scale, node, task.visibility, {}, shown, 1.0F});
  if (by_pointer())
    wants_.push_back({Want::Kind::pointer, Path::visibility, node, task.visibility, {}, shown, 1.0F});
}

void PatchPlanner::apply(const Task& task) {
  const Place at = nodes_.at(task.node);
  const Node& node = document_.nodes[task.node];
  const NodeDetail* const d = detail(task.node);
  const std::string who = "'" + reading::printable(name_of(task.object));
  if (d != nullptr && d->instanced)
    reject(at, who + "' shares its node with others (EXT_mesh_gpu_instancing): they must become nodes first");
  if (d != nullptr && is_group_look(*d))
    reject(at, who + "' is drawn by several nodes, a look each: write its scene with --layout nodes first");
  if (node.skinned) check_skin(task, at);
  if (has_looks(task.node) && (task.mesh_track.valid() || task.mesh_changes))
    reject(at, who + "' already changes its mesh over time");
  if (task.frame.valid()) check_former_frame(task, at);

  const bool alone = exclusive(task.node);
  const bool below = task.frame.valid() && (own_frame(task) || !alone);
  const bool leaf = below || (task.visibility.valid() && (!alone || (by_scale() && !scale_possible(task)))) ||
                    (!task.looks.empty() && node.odd_extras);
  const bool moves_mesh = leaf || !task.looks.empty();
  if (moves_mesh && (in_.uses.of_node[task.node] & NodeUses::kWeightsPointer) != 0) {
    reject(at, "a pointer animates the morph weights of '" + reading::printable(name_of(task.object)) +
                   "', and its mesh would have to go to another node");
  }
  if (moves_mesh && (in_.uses.of_node[task.node] & NodeUses::kWeights) != 0) out_.moves_weights = true;
  std::uint32_t carrier = task.node;
  if (task.frame.valid() && !below) insert_above(task);
  if (leaf) carrier = add_leaf(task, below ? hang_below(task) : task.node);
  if (task.visibility.valid()) {
    want_visibility(task, carrier, leaf ? glm::vec3(1.0F) : own_scale(task));
    if (!leaf) {
      animated_.emplace_back(task.node, task.object);
      if (by_pointer()) edit(task.node).add_visibility = true;
      if (by_scale() && d != nullptr && d->has_matrix) edit(task.node).as_trs = true;
    }
  }
  if (!task.looks.empty()) {
    if (!leaf) {
      edit(task.node).drop_mesh = true;
      edit(task.node).looks_mesh = task.mesh.value;
    }
    add_looks(task, carrier);
  } else if (task.mesh_changes && !leaf) {
    edit(task.node).mesh = task.mesh.value;
  }
}

/// Tracks of new frames: each for every node that a frame has become.
void PatchPlanner::want_frame_tracks() {
  std::vector<std::vector<TrackId>> tracks(scene_.frames.size() - old_frames_);
  for (const FrameTrack& t : scene_.frame_tracks) {
    if (is_new_frame(t.frame)) {
      tracks[t.frame.value - old_frames_].push_back(t.track);
    } else if (t.track.value >= in_.source.track_count) {
      reject(nodes_.at(in_.source.node_of_frame[t.frame.value]), "a new track for a node of the file");
    }
  }
  for (const FrameNode& made : frame_nodes_) {
    for (TrackId track : tracks[made.frame.value - old_frames_]) {
      const Track& t = scene_.tracks[track.value];
      if (made.linear != glm::mat3(1.0F)) {
        const auto values = scene_.values(track);
        std::vector<float> own(values.begin(), values.end());
        for (std::size_t i = 0; i + 2 < own.size(); i += 3) {  // tangents too: they are differences
          const glm::vec3 moved = made.linear * glm::vec3(own[i], own[i + 1], own[i + 2]);
          std::copy_n(&moved.x, 3, &own[i]);
        }
        track = tracks_.add_track(t.property, t.interpolation, scene_.times_s(track), own);
      }
      wants_.push_back({Want::Kind::value, path_of(t.property), made.node, track, {}, glm::vec3(1.0F), 1.0F});
    }
  }
}

/// A node whose times the file gave by scale may lie at rest with another scale than the one shown.
void PatchPlanner::want_constant_scales() {
  std::vector<bool> driven(document_.nodes.size());
  for (const Want& want : wants_) {
    if (want.path == Path::scale && want.target < driven.size()) driven[want.target] = true;
  }
  for (const auto& scaled : in_.source.scale_visibility) {
    if (!std::binary_search(retiming_.dropped.begin(), retiming_.dropped.end(), scaled.node)) continue;
    if (driven[scaled.node] || document_.nodes[scaled.node].local.scale == scaled.shown) continue;
    wants_.push_back({Want::Kind::scale, Path::scale, scaled.node, always(), {}, scaled.shown, 1.0F});
  }
}

void PatchPlanner::want_material_tracks() {
  const Place materials = root_.key("materials");
  for (const MaterialTrack& t : scene_.material_tracks) {
    if (t.track.value < in_.source.track_count) continue;
    if (t.material.value < document_.materials.size())
      reject(materials.at(t.material.value), "a new track for a material of the file");
    if (scene_.tracks[t.track.value].property != Property::base_color)
      reject(materials.at(t.material.value), "a new track for light that materials give off");
    wants_.push_back(
        {Want::Kind::value, Path::base_color, t.material.value, t.track, {}, glm::vec3(1.0F), 1.0F});
  }
}

/// Loaders that bind channels by name need names, each once, on the nodes that our animation drives.
void PatchPlanner::settle_names() {
  NameTable of_file;
  std::size_t bytes = 0;
  for (const Node& node : document_.nodes) bytes += node.name.size();
  of_file.reserve(document_.nodes.size(), bytes);
  for (const Node& node : document_.nodes) of_file.push_back(node.name);

  Dedup driven;
  std::vector<std::uint32_t> first;  // by distinct name, into animated_
  std::vector<std::uint8_t> shared;  // by distinct name
  std::vector<std::uint32_t> name_index(animated_.size());
  const auto is_name = [&](std::string_view name) {
    return [&, name](std::uint32_t i) { return of_file[animated_[first[i]].first] == name; };
  };
  for (std::uint32_t k = 0; k < animated_.size(); ++k) {
    const std::string_view name = of_file[animated_[k].first];
    bool is_new = false;
    name_index[k] = driven.add(fast_hash(name), is_name(name), is_new);
    if (is_new) {
      first.push_back(k);
      shared.push_back(name.empty() ? 1 : 0);
    }
  }
  for (std::uint32_t n = 0; n < document_.nodes.size() && !animated_.empty(); ++n) {
    const std::uint32_t at = driven.find(fast_hash(of_file[n]), is_name(of_file[n]));
    if (at != Dedup::kMissing && animated_[first[at]].first != n) shared[at] = 1;
  }
  for (std::uint32_t k = 0; k < animated_.size(); ++k) {
    const auto& [node, object] = animated_[k];
    const bool named = !document_.nodes[node].name.empty();
    if (shared[name_index[k]] == 0 || (named && document_.nodes[node].odd_extras)) continue;
    edit(node).name = wish(name_of(object));
    edit(node).keep_name = object;
  }
  names_.settle(of_file);
  for (NodeEdit& e : out_.edits) {
    if (e.name == kNone || !e.keep_name.valid()) continue;
    if (names_[e.name] == scene_.objects.names[e.keep_name.value]) e.keep_name = {};
    if (e.keep_name.valid() && document_.nodes[e.node].odd_extras) e.name = kNone, e.keep_name = {};
  }
  for (std::size_t i = 0; i < names_.size(); ++i) out_.new_names.push_back(names_[i]);
}

void PatchPlanner::make_channels() {
  const FileTracks tracks(tracks_);
  AnimationPlanner planner(tracks);
  out_.channels.reserve(wants_.size());
  for (const Want& want : wants_) {
    std::uint32_t sampler = 0;
    switch (want.kind) {
      case Want::Kind::scale:
        sampler = planner.scale_sampler({want.track, want.look}, want.shown);
        break;
      case Want::Kind::pointer:
        sampler = planner.pointer_sampler({want.track, {}});
        break;
      case Want::Kind::value:
        sampler = planner.value_sampler(want.track, want.divisor);
        break;
    }
    out_.channels.push_back({sampler, want.target, want.path});
  }
  out_.animation = std::move(planner).take();
}

NodePatch PatchPlanner::plan() {
  check_counts();
  out_.first_new = document_.nodes.size();
  tracks_.tracks = scene_.tracks;
  tracks_.track_times_s = scene_.track_times_s;
  tracks_.track_values = scene_.track_values;
  tracks_.duration_s = scene_.duration_s;
  retiming_ = find_retiming(in_);
  for (const std::uint32_t node : retiming_.invisible) edit(node).show = true;
  find_looks();
  Task task;
  for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) {
    if (task_of(i, task)) apply(task);
  }
  want_frame_tracks();
  want_constant_scales();
  want_material_tracks();
  settle_names();
  make_channels();
  std::stable_sort(out_.added.begin(), out_.added.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [parent, child] : out_.added) {
    if (parent < document_.nodes.size()) (void)edit(parent);
  }
  std::sort(out_.edits.begin(), out_.edits.end(),
            [](const NodeEdit& a, const NodeEdit& b) { return a.node < b.node; });
  out_.dropped = std::move(retiming_.dropped);
  return std::move(out_);
}

}  // namespace

NodePatch plan_patch(const PatchInput& input, Scene& tracks) {
  return PatchPlanner(input, tracks).plan();
}

}  // namespace scenegen::gltf::patching
