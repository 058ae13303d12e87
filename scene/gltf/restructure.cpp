#include "scene/gltf/restructure.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "scene/gltf/restructure_data.h"
#include "scene/gltf/restructure_parts.h"
#include "scene/limits.h"

namespace scenegen::gltf {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
constexpr const char* kDraco = "KHR_draco_mesh_compression";

Json floats(const float* values, int count) {
  return std::vector<float>(values, values + count);
}

void put_transform(const Transform& t, Json& node) {
  if (t.translation_m != glm::vec3(0.0F)) node["translation"] = floats(&t.translation_m.x, 3);
  if (t.rotation != glm::quat(1, 0, 0, 0)) {
    const float xyzw[4] = {t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w};
    node["rotation"] = floats(xyzw, 4);
  }
  if (t.scale != glm::vec3(1.0F)) node["scale"] = floats(&t.scale.x, 3);
}

/// Removes /object/extensions/name, and the extensions when that was the last.
void erase_extension(Json& object, const char* name) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->is_object()) return;
  extensions->erase(name);
  if (extensions->empty()) object.erase("extensions");
}

bool has_extension(const Json& object, const char* name) {
  const auto extensions = object.find("extensions");
  return extensions != object.end() && extensions->is_object() && extensions->contains(name);
}

void erase_from_list(Json& document, const char* list, const char* name) {
  const auto found = document.find(list);
  if (found == document.end()) return;
  Json left = Json::array();
  for (const Json& entry : *found) {
    if (entry != name) left.push_back(entry);
  }
  if (left.empty()) {
    document.erase(list);
  } else {
    *found = std::move(left);
  }
}

class Restructurer {
 public:
  Restructurer(const ReadResult& read, Split split)
      : scene_(read.scene),
        source_(*read.source),
        split_(split),
        document_(Json::parse(source_.json)),
        data_(document_, source_) {}
  Restructured run();

 private:
  /// New meshes that stand for one of the document's; fewer than two: it stays whole.
  struct MeshSplit {
    bool known = false;
    std::vector<std::size_t> parts;
  };
  void renumber_objects();
  void expand_instances();
  void split_object(std::size_t object);
  const MeshSplit& split_mesh(std::uint32_t mesh);
  std::optional<std::vector<MeshPart>> parts_of(std::uint32_t mesh);
  [[nodiscard]] std::vector<MeshPart> primitives_of(const Mesh& mesh) const;
  bool can_be_cut(const Json& primitive);
  Json cut(const Json& primitive, const Geometry& geometry, const PartPiece& piece);
  std::size_t add_node(std::size_t parent, Json node);
  void note(const std::string& what);
  std::vector<std::uint8_t> finish();

  const Scene& scene_;
  const SourceDocument& source_;
  Split split_;
  Json document_;
  PartData data_;
  std::vector<std::vector<std::size_t>> nodes_of_object_;  ///< one, or its parts
  std::vector<MeshSplit> meshes_;
  Restructured out_;
  std::vector<std::pair<std::string, std::uint64_t>> whole_;  ///< reasons and their counts
};

void Restructurer::note(const std::string& what) {
  for (auto& [known, count] : whole_) {
    if (known != what) continue;
    ++count;
    return;
  }
  whole_.emplace_back(what, 1);
}

std::size_t Restructurer::add_node(std::size_t parent, Json node) {
  Json& nodes = document_["nodes"];
  nodes.push_back(std::move(node));
  nodes[parent]["children"].push_back(nodes.size() - 1);
  return nodes.size() - 1;
}

/// In our own files objects have numbers, and names a table: both hold for the objects there were. The
/// numbers are given again in the old order, parts following each other; names are in the nodes.
void Restructurer::renumber_objects() {
  const auto ours_in = [](Json& owner) -> Json* {
    const auto extras = owner.find("extras");
    if (extras == owner.end() || !extras->is_object()) return nullptr;
    const auto ours = extras->find("scenegen");
    return ours == extras->end() || !ours->is_object() ? nullptr : &*ours;
  };
  if (!document_.contains("asset") || ours_in(document_["asset"]) == nullptr) return;
  if (document_.contains("scenes")) {
    for (Json& scene : document_["scenes"]) {
      if (Json* const ours = ours_in(scene); ours != nullptr) ours->erase("names");
    }
  }
  std::uint64_t number = 0;
  for (const auto& nodes : nodes_of_object_) {
    for (const std::size_t node : nodes) document_["nodes"][node]["extras"]["scenegen"]["object"] = number++;
  }
}

void Restructurer::expand_instances() {
  for (const std::uint32_t node : source_.node_of_object) nodes_of_object_.push_back({node});
  if (source_.instance_of_object.empty()) return;
  std::vector<std::uint32_t> left;  // by node: the mesh of an expanded one
  for (std::size_t i = 0; i < nodes_of_object_.size(); ++i) {
    const std::uint32_t node = source_.node_of_object[i];
    if (!has_extension(document_["nodes"][node], kInstancing)) continue;
    Json child = {{"name", scene_.objects.names[i]}, {"mesh", scene_.objects.mesh[i].value}};
    put_transform(scene_.objects.frame_from_object[i], child);
    nodes_of_object_[i] = {add_node(node, std::move(child))};
    left.push_back(node);
    ++out_.expanded;
  }
  for (const std::uint32_t node : left) {
    document_["nodes"][node].erase("mesh");
    erase_extension(document_["nodes"][node], kInstancing);
  }
  const Json& nodes = document_["nodes"];
  if (std::any_of(nodes.begin(), nodes.end(), [](const Json& n) { return has_extension(n, kInstancing); }))
    return;
  erase_from_list(document_, "extensionsUsed", kInstancing);
  erase_from_list(document_, "extensionsRequired", kInstancing);
}

/// Every primitive a part. Those that use only some of their vertices get their own, so that the part's box
/// is the part's.
std::vector<MeshPart> Restructurer::primitives_of(const Mesh& mesh) const {
  std::vector<MeshPart> out;
  for (std::uint32_t p = 0; p < mesh.primitives.size(); ++p) {
    const Geometry& geometry = scene_.geometries[mesh.primitives[p].geometry.value];
    std::vector<bool> used(geometry.vertex_count());
    for (const std::uint32_t v : geometry.indices) used[v] = true;
    const bool all = geometry.indices.empty() || std::find(used.begin(), used.end(), false) == used.end();
    out.push_back({{{p, all ? std::vector<std::uint32_t>() : element_corners(geometry)}}});
  }
  return out;
}

bool Restructurer::can_be_cut(const Json& primitive) {
  if (primitive.contains("targets")) {
    note("have morph targets");
    return false;
  }
  if (!has_extension(primitive, kDraco)) return true;
  constexpr std::string_view kKnown[] = {"POSITION",   "NORMAL",     "TANGENT",
                                         "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"};
  for (const auto& [name, accessor] : primitive["attributes"].items()) {
    if (std::find(std::begin(kKnown), std::end(kKnown), name) != std::end(kKnown)) continue;
    note("are Draco streams with an attribute " + name);
    return false;
  }
  return true;
}

std::optional<std::vector<MeshPart>> Restructurer::parts_of(std::uint32_t index) {
  const Mesh& mesh = scene_.meshes[index];
  const Json& json = document_["meshes"][index];
  if (mesh.primitives.size() != json["primitives"].size()) {
    note("have primitives without POSITION");
    return std::nullopt;
  }
  for (const Json& primitive : json["primitives"]) {
    if (!can_be_cut(primitive)) return std::nullopt;
  }
  std::vector<MeshPart> parts =
      split_ == Split::components ? connected_parts(scene_, mesh) : primitives_of(mesh);
  if (parts.size() < 2) return std::nullopt;
  return parts;
}

const float* data_of(const Geometry& g, std::string_view name, std::uint32_t& components) {
  components = name == "TANGENT" || name == "COLOR_0" ? 4 : name.starts_with("TEXCOORD") ? 2 : 3;
  if (name == "POSITION") return &g.positions_m.data()->x;
  if (name == "NORMAL") return &g.normals.data()->x;
  if (name == "TANGENT") return &g.tangents.data()->x;
  if (name == "COLOR_0") return &g.colors.data()->x;
  return &g.texcoords[name == "TEXCOORD_1" ? 1 : 0].data()->x;
}

/// The primitive with only the vertices of one piece; itself when the piece is all of it.
Json Restructurer::cut(const Json& primitive, const Geometry& geometry, const PartPiece& piece) {
  if (piece.corners.empty()) return primitive;
  std::vector<std::uint32_t> vertices = piece.corners;
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::vector<std::uint32_t> corners;
  corners.reserve(piece.corners.size());
  for (const std::uint32_t v : piece.corners) {
    corners.push_back(
        static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin()));
  }
  Json out = primitive;
  const bool draco = has_extension(primitive, kDraco);
  if (draco) erase_extension(out, kDraco);
  for (auto& [name, accessor] : out["attributes"].items()) {
    if (!draco) {
      accessor = data_.gather(accessor.get<std::size_t>(), vertices);
      continue;
    }
    std::uint32_t components = 0;
    const float* const values = data_of(geometry, name, components);
    accessor = data_.gather_floats(values, components, name == "POSITION", vertices);
  }
  out["indices"] = data_.indices(corners, vertices.size());
  if (element_size(geometry.topology) == 3) out.erase("mode");  // triangles
  return out;
}

const Restructurer::MeshSplit& Restructurer::split_mesh(std::uint32_t index) {
  MeshSplit& split = meshes_[index];
  if (split.known) return split;
  split.known = true;
  const auto parts = parts_of(index);
  if (!parts) return split;
  Json whole = document_["meshes"][index];
  const Json pieces = std::move(whole["primitives"]);  // so that parts do not begin as copies of all of them
  for (std::size_t k = 0; k < parts->size(); ++k) {
    Json part = whole;
    if (whole.contains("name") && whole["name"].is_string())
      part["name"] = whole["name"].get<std::string>() + "/part_" + std::to_string(k);
    Json primitives = Json::array();
    for (const PartPiece& piece : (*parts)[k].pieces) {
      const Geometry& geometry =
          scene_.geometries[scene_.meshes[index].primitives[piece.primitive].geometry.value];
      primitives.push_back(cut(pieces[piece.primitive], geometry, piece));
    }
    part["primitives"] = std::move(primitives);
    document_["meshes"].push_back(std::move(part));
    split.parts.push_back(document_["meshes"].size() - 1);
  }
  return split;
}

void Restructurer::split_object(std::size_t object) {
  const std::size_t node = nodes_of_object_[object].front();
  const Json& before = document_["nodes"][node];
  if (!before.contains("mesh")) return note("show several looks over time");
  if (before.contains("skin")) return note("are skinned");
  if (before.contains("weights")) return note("have morph targets");
  const MeshSplit& split = split_mesh(before["mesh"].get<std::uint32_t>());
  if (split.parts.size() < 2) return;
  document_["nodes"][node].erase("mesh");
  const std::string name(scene_.objects.names[object]);
  nodes_of_object_[object].clear();
  for (std::size_t k = 0; k < split.parts.size(); ++k) {
    nodes_of_object_[object].push_back(
        add_node(node, {{"name", name + "/part_" + std::to_string(k)}, {"mesh", split.parts[k]}}));
  }
  ++out_.split_objects;
}

/// The document as a .glb whose chunk is buffer 0.
std::vector<std::uint8_t> Restructurer::finish() {
  std::vector<std::uint8_t> chunk = data_.finish();
  if (out_.split_objects != 0) {
    Json& buffers = document_["buffers"];
    if (buffers.empty()) buffers.push_back(Json::object());
    buffers[0].erase("uri");
    buffers[0]["byteLength"] = chunk.size();
  }
  const auto& meshes = document_["meshes"];
  const bool draco = std::any_of(meshes.begin(), meshes.end(), [](const Json& mesh) {
    const Json& list = mesh["primitives"];
    return std::any_of(list.begin(), list.end(), [](const Json& p) { return has_extension(p, kDraco); });
  });
  if (!draco) {
    erase_from_list(document_, "extensionsUsed", kDraco);
    erase_from_list(document_, "extensionsRequired", kDraco);
  }
  std::string text = document_.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  chunk.resize((chunk.size() + 3) / 4 * 4);
  if (28 + text.size() + chunk.size() > limits::kMaxGlbBytes)
    throw RestructureFault{"", "it would become more than 4 GiB of glTF"};
  std::vector<std::uint8_t> glb;
  glb.reserve(28 + text.size() + chunk.size());
  const auto put = [&glb](std::uint64_t word) {
    for (int shift = 0; shift < 32; shift += 8) glb.push_back(static_cast<std::uint8_t>(word >> shift));
  };
  put(0x46546C67);  // "glTF"
  put(2);
  put(20 + text.size() + (chunk.empty() ? 0 : 8 + chunk.size()));
  put(text.size());
  put(0x4E4F534A);  // "JSON"
  glb.insert(glb.end(), text.begin(), text.end());
  if (chunk.empty()) return glb;
  put(chunk.size());
  put(0x004E4942);  // "BIN"
  glb.insert(glb.end(), chunk.begin(), chunk.end());
  return glb;
}

Restructured Restructurer::run() {
  expand_instances();
  if (split_ != Split::none) {
    meshes_.resize(scene_.meshes.size());
    for (std::size_t i = 0; i < nodes_of_object_.size(); ++i) split_object(i);
  }
  renumber_objects();
  const std::vector<std::uint8_t> glb = finish();
  const std::size_t slash = source_.path.rfind('/');
  const std::string folder = slash == std::string::npos ? "."
                             : slash == 0               ? "/"
                                                        : source_.path.substr(0, slash);
  ReadOptions options;
  options.keep_source = true;
  auto again = read_memory(glb, source_.path, folder, options);
  if (!again) throw RestructureFault{"", "once restructured: " + again.error().str()};
  out_.read = std::move(*again);
  for (const auto& [why, count] : whole_)
    out_.notes.push_back("left whole: " + std::to_string(count) + " that " + why);
  return std::move(out_);
}

}  // namespace

bool needs_restructuring(const ReadResult& read, Split split) {
  return split != Split::none || !read.source->instance_of_object.empty();
}

Result<Restructured> restructure(ReadResult read, Split split) {
  const std::string name = read.source->path;
  if (read.scene.objects.size() == 0) return Restructured{std::move(read), 0, 0, {}};
  try {
    return Restructurer(read, split).run();
  } catch (const RestructureFault& fault) {
    return fail(ErrorKind::bad_input, fault.where.empty() ? name : name + ": " + fault.where, fault.what);
  } catch (const Json::exception& error) {  // something that the reader had no reason to look at
    return fail(ErrorKind::bad_input, name, std::string("cannot be restructured: ") + error.what());
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::bad_input, name, "not enough memory to split what the file holds");
  }
}

}  // namespace scenegen::gltf
