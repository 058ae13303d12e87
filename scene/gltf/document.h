// A glTF document in flat arrays, indices still unchecked: what one pass over the JSON leaves, whatever the
// order of its members. Strings are views into the text or into Document::unescaped. Private to scene/gltf.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "scene/gltf/fault.h"
#include "scene/gltf/read.h"
#include "scene/scene.h"

namespace scenegen::gltf::reading {

constexpr std::uint32_t kNone = 0xFFFFFFFFU;

struct Buffer {
  std::string_view uri;
  bool has_uri = false;
  std::uint64_t byte_length = 0;
};
struct BufferView {
  std::uint32_t buffer = kNone;
  std::uint64_t byte_offset = 0, byte_length = 0;
  std::uint32_t byte_stride = 0;  ///< 0: tightly packed
};
struct Sparse {
  std::uint64_t count = 0;
  std::uint32_t index_view = kNone, index_type = 0, value_view = kNone;
  std::uint64_t index_offset = 0, value_offset = 0;
};
struct Accessor {
  std::uint32_t view = kNone;
  std::uint32_t component_type = 0;
  std::uint64_t byte_offset = 0, count = 0;
  std::uint32_t components = 0;  ///< 1 … 16
  std::uint32_t sparse = kNone;  ///< into Document::sparse
  bool normalized = false;
};

/// Vertex attributes that a Geometry has, in this order.
enum class Attribute : std::uint8_t { position, normal, tangent, texcoord_0, texcoord_1, color_0 };
constexpr std::size_t kAttributes = 6;
struct PrimitiveRecord {
  std::array<std::uint32_t, kAttributes> attribute{kNone, kNone, kNone, kNone, kNone, kNone};
  std::array<std::uint32_t, kAttributes> draco_id{kNone, kNone, kNone, kNone, kNone, kNone};
  std::uint32_t indices = kNone, material = kNone, mode = 4;
  std::uint32_t draco_view = kNone;
};
struct MeshRecord {
  std::string_view name;
  std::uint32_t first_primitive = 0, primitive_count = 0;
};
struct ImageRecord {
  std::string_view name, uri, mime_type;
  std::uint32_t view = kNone;
  bool has_uri = false;
};
struct TextureRecord {
  std::uint32_t source = kNone, sampler = kNone;
};
/// Accessors of placed objects: of an instancing node, or of one set of objects in a merged one.
struct Instances {
  std::uint32_t translation = kNone, rotation = kNone, scale = kNone, object_id = kNone;
  std::uint32_t mesh = kNone;      ///< kNone: the node's
  std::uint32_t first_id = kNone;  ///< extras.scenegen.ids: into the scene's table of ids
};
/// What an optional JSON object says beside its mere presence; the common node has none of it.
struct NodeDetail {
  glm::mat4 matrix{1.0F};
  bool has_matrix = false;
  bool instanced = false;
  Instances instances;                         ///< EXT_mesh_gpu_instancing
  std::uint32_t first_set = 0, set_count = 0;  ///< extras.scenegen.objects: into Document::instance_sets
  std::uint32_t shows = kNone;                 ///< extras.scenegen: the mesh of a merged look
  std::uint32_t object = kNone, look = kNone, mesh = kNone, frame = kNone;  ///< extras.scenegen
  std::uint32_t visibility = kNone, looks = kNone;  ///< extras.scenegen: into the scene's timelines
  std::uint32_t stands_for = kNone;  ///< the node in whose place among the objects this one comes
  std::string_view name;             ///< its name: of the object, not of the node
};
struct Node {
  Transform local;
  std::string_view name;
  std::uint32_t mesh = kNone, camera = kNone;
  std::uint32_t first_child = 0, child_count = 0;  ///< into Document::children
  std::uint32_t detail = kNone;                    ///< into Document::node_details
  bool has_visibility : 1 = false;                 ///< KHR_node_visibility is there
  bool visible : 1 = true;
  bool skinned : 1 = false;
  bool has_other : 1 = false;   ///< extensions that mean something to its children or beside its mesh
  bool odd_extras : 1 = false;  ///< extras that are no object
};
struct SceneRecord {
  std::uint32_t first_root = 0, root_count = 0;  ///< into Document::scene_roots
};
/// A table in a buffer view: names, or indices of objects.
struct NameList {
  std::uint32_t view = kNone;
  std::uint64_t count = 0;
};
/// A visibility track or a mesh track behind the looks of a group: keys in Document::timeline_times_s and
/// timeline_values.
struct Timeline {
  std::uint64_t first = 0, count = 0;
  bool is_looks = false;  ///< values are numbers of looks, else 0 or 1
};
/// scenes[i].extras.scenegen
struct SceneExtras {
  NameList names, ids;
  std::uint32_t first_timeline = 0, timeline_count = 0;
  std::uint32_t merged_after = kNone;  ///< layout merged: meshes from this one on are merged ones
};

enum class Path : std::uint8_t { none, translation, rotation, scale, visibility, base_color, emissive };
struct AnimationSampler {
  std::uint32_t input = kNone, output = kNone;
  Interpolation interpolation = Interpolation::linear;
};
struct Channel {
  std::uint32_t sampler = kNone, target = kNone;
  Path path = Path::none;  ///< none: not played
};

/// Counts of what is left out, by kind, in the order of first occurrence.
class IgnoredList {
 public:
  void add(std::string where, std::string_view what, std::uint64_t count = 1);
  void add(const Place& at, std::string_view what, std::uint64_t count = 1);
  [[nodiscard]] bool has(std::string_view what) const { return index_.find(what) != index_.end(); }
  [[nodiscard]] std::vector<Ignored> take() { return std::move(list_); }

 private:
  std::vector<Ignored> list_;
  std::map<std::string, std::size_t, std::less<>> index_;
};

struct Document {
  SceneInfo info;
  bool ours = false;             ///< asset.extras.scenegen is there
  bool foreign = false;          ///< and says that it was added to a document of another program,
  std::string source_generator;  ///< whose asset.generator this was
  double end_s = -1;             ///< its time.end
  std::vector<std::string_view> extensions_used, extensions_required;
  std::vector<Buffer> buffers;
  std::vector<BufferView> views;
  std::vector<Accessor> accessors;
  std::vector<Sparse> sparse;
  std::vector<ImageRecord> images;
  std::vector<Sampler> samplers;
  std::vector<TextureRecord> textures;
  std::vector<Material> materials;  ///< TextureUse::texture as in the file
  std::vector<float> emissive_strength;
  std::vector<MeshRecord> meshes;
  std::vector<PrimitiveRecord> primitives;
  std::vector<Camera> cameras;
  std::vector<Node> nodes;
  std::vector<NodeDetail> node_details;
  std::vector<Instances> instance_sets;
  std::vector<std::uint32_t> children;
  std::vector<SceneRecord> scenes;
  std::vector<std::uint32_t> scene_roots;
  std::uint32_t scene = kNone;
  std::vector<SceneExtras> scene_extras;  ///< by scene
  std::vector<Timeline> timelines;
  std::vector<float> timeline_times_s;
  std::vector<std::uint32_t> timeline_values;
  std::vector<AnimationSampler> animation_samplers;
  std::vector<Channel> channels;
  bool animated = false;  ///< animations[0] is there
  IgnoredList ignored;
  std::deque<std::string> unescaped;  ///< strings that hold escapes in the text
};

/// The quaternion x y z w at unit length; within float32 of it the numbers stay as they are, so that our own
/// come back exactly.
[[nodiscard]] glm::quat unit_rotation(const std::array<float, 4>& xyzw, const Place& at);

}  // namespace scenegen::gltf::reading
