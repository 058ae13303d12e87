// Nodes -> frames, objects, cameras.
#include <algorithm>

#include "scene/gltf/build.h"
#include "scene/gltf/names.h"
#include "scene/limits.h"

namespace scenegen::gltf::reading {

namespace {

constexpr std::uint8_t kInScene = 1, kUsed = 2, kUsedBelow = 4, kOwnFrame = 8, kLook = 16, kFurtherLook = 32,
                       kStandIn = 64;

class ObjectBuilder {
 public:
  ObjectBuilder(Document& document, Data& data, const Hierarchy& hierarchy, const Motions& motions,
                VisibilityTable& visibility, Scene& scene)
      : document_(document),
        data_(data),
        hierarchy_(hierarchy),
        motions_(motions),
        visibility_(visibility),
        scene_(scene),
        looks_(document, data, visibility, scene) {}
  Origins build();

 private:
  [[nodiscard]] const NodeDetail* detail(std::uint32_t node) const {
    const std::uint32_t i = document_.nodes[node].detail;
    return i == kNone ? nullptr : &document_.node_details[i];
  }
  [[nodiscard]] const NodeMotion* motion(std::uint32_t node) const {
    if (motions_.of_node.empty() || motions_.of_node[node] == kNone) return nullptr;
    return &motions_.motions[motions_.of_node[node]];
  }
  /// An object of ours whose meshes are its children's (docs/FORMAT.md 5).
  [[nodiscard]] bool has_looks(std::uint32_t node) const {
    const NodeDetail* const d = detail(node);
    return document_.ours && d != nullptr && d->mesh != kNone && document_.nodes[node].mesh == kNone;
  }
  /// Written by us as a whole, not a document of another program that was given times.
  [[nodiscard]] bool ours_alone() const { return document_.ours && !document_.foreign; }
  [[nodiscard]] bool instanced(std::uint32_t node) const {
    const NodeDetail* const d = detail(node);
    return d != nullptr && d->instanced;
  }
  [[nodiscard]] bool merged(std::uint32_t node) const {
    const NodeDetail* const d = detail(node);
    return d != nullptr && d->set_count > 0;
  }
  /// A node of ours that shows one look of objects in a group; look 0 is the one that says what they are.
  [[nodiscard]] bool shows_group_look(std::uint32_t node) const {
    const NodeDetail* const d = detail(node);
    if (!document_.ours || d == nullptr || d->look == kNone || (flags_[node] & kLook) != 0) return false;
    if (d->set_count > 0) return true;
    const bool indexed = d->instanced ? d->instances.object_id != kNone : d->object != kNone;
    return document_.nodes[node].mesh != kNone && indexed && (d->look > 0 || d->mesh != kNone);
  }
  [[nodiscard]] bool is_object(std::uint32_t node) const {
    return (flags_[node] & (kLook | kFurtherLook)) == 0 &&
           (document_.nodes[node].mesh != kNone || has_looks(node) || merged(node));
  }
  /// Objects::mesh of what a node stands for.
  [[nodiscard]] std::uint32_t mesh_of(std::uint32_t node) const {
    const std::uint32_t mesh = document_.nodes[node].mesh;
    return mesh != kNone && !shows_group_look(node) ? mesh : detail(node)->mesh;
  }
  /// What a node that shows a look of a group shows.
  [[nodiscard]] std::uint32_t look_of(std::uint32_t node) const {
    return merged(node) ? detail(node)->shows : document_.nodes[node].mesh;
  }
  [[nodiscard]] Place node_place(std::uint32_t node) const { return nodes_.at(node); }

  void mark_used();
  std::uint32_t own_visibility(std::uint32_t node);
  void place_nodes();
  void add_frame(std::uint32_t node, FrameId parent);
  void find_stand_ins();
  /// f(node) for every node that is one object or many, in their order: by node, but a node that draws what
  /// was another node's mesh comes in that one's place.
  template <class F>
  void each_object_node(const F& f);
  void load_ids();
  std::vector<std::uint32_t> instance_ids(const Instances& d, std::uint64_t count, const Place& at);
  template <class Use>
  void for_each_set(std::uint32_t node, const Use& use);
  std::uint64_t instance_count(const Instances& d, const Place& at);
  std::uint64_t count_objects();
  void add_objects(std::uint64_t count);
  void add_objects_of(std::uint32_t node);
  void add_instances(std::uint32_t node);
  void add_set(std::uint32_t node, const Instances& d, const Place& at, std::uint32_t& instance);
  struct Origin {
    std::uint32_t node, instance;
  };
  void put(std::uint64_t id, const Origin& origin, const Transform& transform, std::uint32_t mesh);
  std::uint64_t next_id(std::uint32_t given, const Place& at);
  void add_looks(std::uint32_t node, ObjectId object);
  void add_look_node(std::uint64_t object, std::uint32_t node);
  void add_further_look(std::uint32_t node);
  void resolve_looks();
  void add_cameras();
  void add_names();
  void finish_visibility();

  Document& document_;
  Data& data_;
  const Hierarchy& hierarchy_;
  const Motions& motions_;
  VisibilityTable& visibility_;
  Scene& scene_;
  Place root_;
  Place nodes_ = root_.key("nodes");
  std::vector<std::uint8_t> flags_;
  std::vector<FrameId> frame_;           ///< by node: of its children, and of itself
  std::vector<std::uint32_t> visible_;   ///< by node, ancestors included
  std::vector<std::uint32_t> stand_in_;  ///< by node; empty when there are none
  bool explicit_ids_ = false;
  std::vector<std::uint32_t> ids_;  ///< of objects: docs/FORMAT.md 2 (ids)
  bool ids_damaged_ = false;
  std::uint64_t next_ = 0;
  std::vector<bool> taken_;
  Origins origins_;
  std::vector<std::uint32_t> object_visibility_;  ///< of the VisibilityTable
  LookTable looks_;
  struct LookNode {
    std::uint32_t node;
    std::uint32_t next;  ///< of the same object
  };
  std::vector<LookNode> look_nodes_;
  std::vector<std::uint32_t> look_of_object_;  ///< the last one; empty when there are none
};

void ObjectBuilder::mark_used() {
  flags_.assign(document_.nodes.size(), 0);
  for (const std::uint32_t node : hierarchy_.order) {
    flags_[node] |= kInScene;
    if (shows_group_look(node) && detail(node)->look > 0) flags_[node] |= kFurtherLook | kUsed;
    if (!has_looks(node)) continue;
    const Node& owner = document_.nodes[node];
    for (std::uint32_t k = 0; k < owner.child_count; ++k) {
      const std::uint32_t child = document_.children[owner.first_child + k];
      const NodeDetail* const d = detail(child);
      if (d != nullptr && d->look != kNone && document_.nodes[child].mesh != kNone) flags_[child] |= kLook;
    }
  }
  for (std::size_t i = hierarchy_.order.size(); i-- > 0;) {
    const std::uint32_t node = hierarchy_.order[i];
    if (is_object(node) || document_.nodes[node].camera != kNone) flags_[node] |= kUsed;
    const std::uint32_t parent = hierarchy_.parent[node];
    if ((flags_[node] & kUsed) != 0 && parent != kNone) flags_[parent] |= kUsed | kUsedBelow;
  }
}

std::uint32_t ObjectBuilder::own_visibility(std::uint32_t node) {
  const Node& n = document_.nodes[node];
  std::uint32_t out = n.visible ? VisibilityTable::kAlways : visibility_.never();
  if (const NodeMotion* const m = motion(node); m != nullptr) {
    if (m->pointer_visibility != kNone) out = m->pointer_visibility;  // replaces the value at rest
    out = visibility_.both(out, m->scale_visibility, node_place(node));
  }
  return out;
}

void ObjectBuilder::add_frame(std::uint32_t node, FrameId parent) {
  const Node& n = document_.nodes[node];
  const FrameId id(scene_.frames.size());
  Frame& frame = scene_.frames.emplace_back();
  origins_.node_of_frame.push_back(node);
  frame.name = n.name;
  frame.parent = parent;
  frame.local = n.local;
  if (const NodeDetail* const d = detail(node); d != nullptr && d->has_matrix) {
    frame.has_matrix = true;
    frame.matrix = d->matrix;
  }
  if (const NodeMotion* const m = motion(node); m != nullptr) {
    for (const std::uint32_t track : {m->translation, m->rotation, m->scale}) {
      if (track < NodeMotion::kConstant) scene_.frame_tracks.push_back({id, TrackId(track)});
    }
  }
  frame_[node] = id;
  flags_[node] |= kOwnFrame;
}

void ObjectBuilder::place_nodes() {
  frame_.assign(document_.nodes.size(), FrameId());
  visible_.assign(document_.nodes.size(), VisibilityTable::kAlways);
  for (const std::uint32_t node : hierarchy_.order) {
    if ((flags_[node] & kUsed) == 0) continue;
    Node& n = document_.nodes[node];
    const std::uint32_t parent = hierarchy_.parent[node];
    const FrameId outer = parent == kNone ? FrameId() : frame_[parent];
    const std::uint32_t above = parent == kNone ? VisibilityTable::kAlways : visible_[parent];
    visible_[node] = visibility_.both(above, own_visibility(node), node_place(node));
    frame_[node] = outer;
    bool matrix = false;
    if (n.detail != kNone && document_.node_details[n.detail].has_matrix) {
      NodeDetail& d = document_.node_details[n.detail];
      d.has_matrix = !decompose(d.matrix, n.local);
      matrix = d.has_matrix;
      if (matrix) n.local = Transform();
    }
    const NodeMotion* const m = motion(node);
    const bool moves = m != nullptr && m->moves();
    const bool bare = n.local == Transform();
    if (moves || matrix || (!bare && ((flags_[node] & kUsedBelow) != 0 || instanced(node))))
      add_frame(node, outer);
  }
}

/// use(instances, place of their attributes) for what an instancing or merged node holds.
template <class Use>
void ObjectBuilder::for_each_set(std::uint32_t node, const Use& use) {
  const NodeDetail& d = *detail(node);
  const Place here = node_place(node);
  if (d.set_count == 0) {
    const Place extensions = here.key("extensions");
    const Place extension = extensions.key("EXT_mesh_gpu_instancing");
    return use(d.instances, extension.key("attributes"));
  }
  const Place extras = here.key("extras");
  const Place ours = extras.key("scenegen");
  const Place sets = ours.key("objects");
  for (std::uint32_t k = 0; k < d.set_count; ++k) use(document_.instance_sets[d.first_set + k], sets.at(k));
}

std::uint64_t ObjectBuilder::instance_count(const Instances& d, const Place& at) {
  std::uint64_t count = 0;
  const auto same = [&](std::uint32_t accessor, std::string_view name) {
    if (accessor == kNone) return;
    const std::uint64_t given = data_.accessor(accessor, at.key(name)).count;
    if (count != 0 && given != count) {
      reject(at.key(name),
             std::to_string(given) + " instances, but another attribute has " + std::to_string(count));
    }
    count = given;
  };
  same(d.translation, "TRANSLATION");
  same(d.rotation, "ROTATION");
  same(d.scale, "SCALE");
  if (ours_alone()) same(d.object_id, "_OBJECT_ID");
  if (count == 0) reject(at, "none of TRANSLATION, ROTATION, SCALE");
  return count;
}

void ObjectBuilder::find_stand_ins() {
  if (!document_.ours) return;
  for (std::uint32_t node = 0; node < flags_.size(); ++node) {
    const NodeDetail* const d = detail(node);
    if (d == nullptr || d->stands_for >= flags_.size() || (flags_[node] & kUsed) == 0 || !is_object(node))
      continue;
    if (d->stands_for == node || is_object(d->stands_for)) continue;
    if (stand_in_.empty()) stand_in_.assign(flags_.size(), kNone);
    std::uint32_t& place = stand_in_[d->stands_for];
    if (place != kNone) continue;
    place = node;
    flags_[node] |= kStandIn;
  }
}

template <class F>
void ObjectBuilder::each_object_node(const F& f) {
  for (std::uint32_t node = 0; node < flags_.size(); ++node) {
    if (!stand_in_.empty() && stand_in_[node] != kNone) f(stand_in_[node]);
    if ((flags_[node] & kUsed) != 0 && (flags_[node] & kStandIn) == 0 && is_object(node)) f(node);
  }
}

/// Table of ids of our own files. Tools that rebuild buffer views (see add_names) leave it damaged: then
/// objects are numbered as they come, and names by number would be the wrong ones.
void ObjectBuilder::load_ids() {
  const std::uint32_t shown = document_.scene == kNone ? 0 : document_.scene;
  if (!ours_alone() || document_.scenes.empty() || document_.scene_extras[shown].ids.view == kNone) return;
  const Place scenes = root_.key("scenes");
  const Place scene = scenes.at(shown);
  const Place extras = scene.key("extras");
  const Place ours = extras.key("scenegen");
  const Place at = ours.key("ids");
  try {
    ids_ = decode_ids(document_.scene_extras[shown].ids, data_, at);
  } catch (const Fault& fault) {
    ids_damaged_ = true;
    document_.ignored.add(at, "the table of object indices is damaged (" + fault.error.what + ")");
  }
}

/// Indices of a node's instances; empty where it has none.
std::vector<std::uint32_t> ObjectBuilder::instance_ids(const Instances& d, std::uint64_t count,
                                                       const Place& at) {
  if (!explicit_ids_) return {};
  if (d.object_id != kNone) return data_.integers(d.object_id, at.key("_OBJECT_ID"));
  if (d.first_id == kNone) return {};
  if (d.first_id > ids_.size() || count > ids_.size() - d.first_id)
    reject(at, std::to_string(count) + " instances from " + std::to_string(d.first_id) + " of " +
                   std::to_string(ids_.size()) + " indices");
  const auto first = ids_.begin() + d.first_id;
  return {first, first + static_cast<std::ptrdiff_t>(count)};
}

std::uint64_t ObjectBuilder::count_objects() {
  std::uint64_t count = 0;
  load_ids();
  each_object_node([&](std::uint32_t node) {
    const NodeDetail* const d = detail(node);
    const bool many = instanced(node);
    const bool has_id = d != nullptr && (d->object != kNone || (many && d->instances.object_id != kNone) ||
                                         (many && d->instances.first_id != kNone) || merged(node));
    if (ours_alone() && !ids_damaged_ && has_id) explicit_ids_ = true;
    std::uint64_t here = many ? 0 : 1;
    if (many)
      for_each_set(node, [&](const Instances& set, const Place& at) { here += instance_count(set, at); });
    if (here > limits::kMaxObjects - count) {
      reject(node_place(node), "more than " + std::to_string(limits::kMaxObjects) + " objects");
    }
    if (many) data_.budget().take(here * 64, node_place(node));  // a Scene has about as much for each object
    if (many && origins_.instance.empty()) origins_.instance.resize(1);
    count += here;
  });
  return count;
}

std::uint64_t ObjectBuilder::next_id(std::uint32_t given, const Place& at) {
  if (!explicit_ids_) return next_++;
  if (given == kNone)
    reject(at, "an object without an index (extras.scenegen.object) among others that have one");
  check_index(given, taken_.size(), "objects", at);
  if (taken_[given]) reject(at, "a second object with index " + std::to_string(given));
  taken_[given] = true;
  return given;
}

void ObjectBuilder::put(std::uint64_t id, const Origin& origin, const Transform& transform,
                        std::uint32_t mesh) {
  scene_.objects.frame_from_object[id] = transform;
  scene_.objects.frame[id] = frame_[origin.node];
  scene_.objects.mesh[id] = MeshId(mesh);
  object_visibility_[id] = visible_[origin.node];
  origins_.node[id] = origin.node;
  if (!origins_.instance.empty()) origins_.instance[id] = origin.instance;
  if (shows_group_look(origin.node)) add_look_node(id, origin.node);
}

void ObjectBuilder::add_instances(std::uint32_t node) {
  std::uint32_t instance = 0;
  for_each_set(node, [&](const Instances& d, const Place& at) { add_set(node, d, at, instance); });
}

/// `instance`: the first one's number within the node; left at the next one's.
void ObjectBuilder::add_set(std::uint32_t node, const Instances& d, const Place& at,
                            std::uint32_t& instance) {
  const std::uint64_t count = instance_count(d, at);
  std::vector<float> translation, rotation, scale;
  const std::vector<std::uint32_t> ids = instance_ids(d, count, at);
  if (d.translation != kNone) translation = data_.floats(d.translation, 3, at.key("TRANSLATION"));
  if (d.rotation != kNone) rotation = data_.floats(d.rotation, 4, at.key("ROTATION"));
  if (d.scale != kNone) scale = data_.floats(d.scale, 3, at.key("SCALE"));
  const std::uint32_t mesh = d.mesh != kNone ? d.mesh : mesh_of(node);
  for (std::uint64_t i = 0; i < count; ++i) {
    Transform transform;
    if (!translation.empty())
      transform.translation_m = {translation[3 * i], translation[3 * i + 1], translation[3 * i + 2]};
    if (!scale.empty()) transform.scale = {scale[3 * i], scale[3 * i + 1], scale[3 * i + 2]};
    if (!rotation.empty()) {
      const float* const q = &rotation[4 * i];
      transform.rotation = unit_rotation({q[0], q[1], q[2], q[3]}, at.key("ROTATION"));
    }
    const std::uint64_t id = next_id(ids.empty() ? kNone : ids[i], at.key("_OBJECT_ID"));
    put(id, {node, instance++}, transform, mesh);
  }
}

void ObjectBuilder::add_objects(std::uint64_t count) {
  scene_.objects.frame_from_object.resize(count);
  scene_.objects.frame.resize(count);
  scene_.objects.mesh.resize(count);
  scene_.objects.visibility.resize(count);
  object_visibility_.resize(count);
  origins_.node.resize(count);
  if (!origins_.instance.empty()) origins_.instance.resize(count);
  if (explicit_ids_) taken_.resize(count);
  for (std::uint32_t node = 0; node < flags_.size(); ++node) {
    if ((flags_[node] & kUsed) != 0 && (flags_[node] & kFurtherLook) != 0) add_further_look(node);
  }
  each_object_node([&](std::uint32_t node) { add_objects_of(node); });
  resolve_looks();
}

void ObjectBuilder::add_objects_of(std::uint32_t node) {
  const Node& n = document_.nodes[node];
  const NodeDetail* const d = detail(node);
  const Place at = node_place(node);
  if (!merged(node)) {  // those are checked (settle_merged)
    check_index(n.mesh != kNone ? n.mesh : d->mesh, scene_.meshes.size(), "meshes", at.key("mesh"));
    if (shows_group_look(node)) check_index(d->mesh, scene_.meshes.size(), "meshes", at.key("extras"));
  }
  if (instanced(node)) return add_instances(node);
  const std::uint64_t id = next_id(d == nullptr ? kNone : d->object, at);
  put(id, {node, 0}, (flags_[node] & kOwnFrame) != 0 ? Transform() : n.local, mesh_of(node));
  if (has_looks(node)) add_looks(node, ObjectId(id));
}

/// The children's visibility tracks, of which exactly one shows at any time, become one mesh track.
void ObjectBuilder::add_looks(std::uint32_t node, ObjectId object) {
  const Node& n = document_.nodes[node];
  std::vector<LookTable::Look> looks;
  for (std::uint32_t k = 0; k < n.child_count; ++k) {
    const std::uint32_t child = document_.children[n.first_child + k];
    if ((flags_[child] & kLook) == 0) continue;
    const std::uint32_t mesh = document_.nodes[child].mesh;
    check_index(mesh, scene_.meshes.size(), "meshes", node_place(child).key("mesh"));
    looks.push_back({own_visibility(child), mesh});
  }
  const TrackId track = looks_.always_one(looks, node_place(node));
  if (track.valid()) scene_.object_mesh_tracks.push_back({object, track});
}

/// Notes that `node` shows a look of the object.
void ObjectBuilder::add_look_node(std::uint64_t object, std::uint32_t node) {
  if (look_of_object_.empty()) look_of_object_.assign(scene_.objects.size(), kNone);
  look_nodes_.push_back({node, look_of_object_[object]});
  look_of_object_[object] = static_cast<std::uint32_t>(look_nodes_.size() - 1);
}

/// A node of ours that shows look 1, 2, … of objects whose look 0 is another node.
void ObjectBuilder::add_further_look(std::uint32_t node) {
  const NodeDetail& d = *detail(node);
  const Place here = node_place(node);
  check_index(look_of(node), scene_.meshes.size(), "meshes", here.key("mesh"));
  if (!explicit_ids_) reject(here, "a look of an object, but no object has an index");
  const auto add = [&](std::uint32_t id) {
    check_index(id, scene_.objects.size(), "objects", here);
    add_look_node(id, node);
  };
  if (!instanced(node)) return add(d.object);
  for_each_set(node, [&](const Instances& set, const Place& at) {
    for (const std::uint32_t id : instance_ids(set, instance_count(set, at), at)) add(id);
  });
}

/// Visibility and mesh tracks of objects whose looks are nodes of groups.
void ObjectBuilder::resolve_looks() {
  struct Numbered {
    std::uint32_t number;
    std::uint32_t node;
  };
  std::vector<Numbered> nodes;
  std::vector<LookTable::Look> looks, last;
  LookTable::Resolved resolved;
  std::uint32_t last_first = kNone;  // neighbours are mostly of one group
  for (std::uint32_t object = 0; object < look_of_object_.size(); ++object) {
    nodes.clear();
    for (std::uint32_t i = look_of_object_[object]; i != kNone; i = look_nodes_[i].next)
      nodes.push_back({detail(look_nodes_[i].node)->look, look_nodes_[i].node});
    if (nodes.empty()) continue;
    std::ranges::sort(nodes, {}, &Numbered::number);
    const Place here = node_place(nodes.front().node);
    looks.clear();
    for (std::uint32_t k = 0; k < nodes.size(); ++k) {
      if (nodes[k].number != k) {
        reject(here, "object " + std::to_string(object) + " has " + std::to_string(nodes.size()) +
                         " looks, but none or two with number " + std::to_string(k));
      }
      looks.push_back({visible_[nodes[k].node], look_of(nodes[k].node)});
    }
    const std::uint32_t first = nodes.front().node;
    if (first != last_first || looks != last) {
      const NodeDetail& d = *detail(first);
      resolved = looks_.at_most_one(looks, d.visibility, d.looks, here);
      last_first = first;
      last = looks;
    }
    object_visibility_[object] = resolved.visible;
    scene_.object_mesh_tracks.push_back({ObjectId(object), resolved.meshes});
  }
  std::ranges::sort(scene_.object_mesh_tracks, {}, &ObjectMeshTrack::object);
  if (looks_.disagreements() > 0) {
    document_.ignored.add(nodes_, "timelines of looks that are missing or differ from the animation",
                          looks_.disagreements());
  }
}

void ObjectBuilder::add_cameras() {
  for (std::uint32_t node = 0; node < flags_.size(); ++node) {
    const Node& n = document_.nodes[node];
    if ((flags_[node] & kUsed) == 0 || n.camera == kNone) continue;
    check_index(n.camera, document_.cameras.size(), "cameras", node_place(node).key("camera"));
    Camera camera = document_.cameras[n.camera];
    if (!ours_alone() && !n.name.empty())
      camera.name = n.name;  // foreign cameras are mostly told apart by their nodes
    camera.frame = frame_[node];
    if ((flags_[node] & kOwnFrame) == 0) camera.frame_from_camera = n.local;
    scene_.cameras.push_back(std::move(camera));
  }
}

void ObjectBuilder::add_names() {
  const std::size_t count = scene_.objects.size();
  UniqueNames names(scene_.objects.names, count);
  const std::uint32_t shown = document_.scene == kNone ? 0 : document_.scene;
  if (document_.ours && !ids_damaged_ && !document_.scenes.empty() &&
      document_.scene_extras[shown].names.view != kNone) {
    const Place scenes = root_.key("scenes");
    const Place scene = scenes.at(shown);
    const Place extras = scene.key("extras");
    const Place ours = extras.key("scenegen");
    const Place at = ours.key("names");
    // Tools that rebuild buffer views without knowing our extras (gltf-transform copy) leave a table that
    // points anywhere: the scene is whole without it, so it loses its names and says so.
    try {
      if (document_.scene_extras[shown].names.count != count) {
        reject(at.key("count"), std::to_string(document_.scene_extras[shown].names.count) + " names of " +
                                    std::to_string(count) + " objects");
      }
      const NameTable table = decode_names(document_.scene_extras[shown].names, data_, at);
      scene_.objects.names.reserve(count, table.byte_count());
      return names.add_all(count, [&](std::size_t i) { return table[i]; });
    } catch (const Fault& fault) {
      document_.ignored.add(at, "the table of object names is damaged (" + fault.error.what + ")");
    }
  }
  // Names that objects have whatever their nodes are called (docs/FORMAT.md 9) are theirs before others ask.
  for (std::uint32_t node = 0; node < flags_.size() && document_.ours; ++node) {
    if ((flags_[node] & kUsed) == 0 || !is_object(node) || instanced(node)) continue;
    const NodeDetail* const d = detail(node);
    if (d != nullptr && !d->name.empty()) names.reserve(d->name);
  }
  std::size_t bytes = 0;
  for (const std::uint32_t node : origins_.node) bytes += document_.nodes[node].name.size();
  bool all_named = origins_.instance.empty() && !names.has_reserved();
  for (std::size_t i = 0; i < count && all_named; ++i)
    all_named = !document_.nodes[origins_.node[i]].name.empty();
  if (all_named) {
    scene_.objects.names.reserve(count, bytes);
    return names.add_all(count, [&](std::size_t i) { return document_.nodes[origins_.node[i]].name; });
  }
  std::string made;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t node = origins_.node[i];
    const std::string_view name = document_.nodes[node].name;
    const bool many = instanced(node);
    if (const NodeDetail* const d = detail(node);
        document_.ours && !many && d != nullptr && !d->name.empty()) {
      names.add_reserved(d->name);
      continue;
    }
    if (!many && !name.empty()) {
      names.add(name);
      continue;
    }
    made = name.empty() ? "node_" + std::to_string(node) : std::string(name);
    if (many) made += "/" + std::to_string(origins_.instance[i]);
    data_.budget().take(made.size(), root_);
    names.add(made);
  }
}

void ObjectBuilder::finish_visibility() {
  std::vector<TrackId> track(visibility_.size());
  std::vector<float> values;
  for (std::size_t i = 0; i < object_visibility_.size(); ++i) {
    const std::uint32_t id = object_visibility_[i];
    if (id == VisibilityTable::kAlways) continue;
    if (!track[id].valid()) {
      const auto shown = visibility_.shown(id);
      values.assign(shown.begin(), shown.end());
      track[id] =
          scene_.add_track(Property::visibility, Interpolation::step, visibility_.times_s(id), values);
    }
    scene_.objects.visibility[i] = track[id];
  }
}

Origins ObjectBuilder::build() {
  mark_used();
  place_nodes();
  find_stand_ins();
  add_objects(count_objects());
  add_cameras();
  add_names();
  finish_visibility();
  return std::move(origins_);
}

}  // namespace

Origins build_objects(Document& document, Data& data, const Hierarchy& hierarchy, const Motions& motions,
                      VisibilityTable& visibility, Scene& scene) {
  return ObjectBuilder(document, data, hierarchy, motions, visibility, scene).build();
}

}  // namespace scenegen::gltf::reading
