// Nodes, cameras and lights.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <unordered_map>
#include <unordered_set>

#include "scene/import/convert.h"
#include "scene/limits.h"
#include "scene/transform.h"

namespace scenegen::import {

namespace {

using nlohmann::json;

glm::mat4 matrix(const aiMatrix4x4& m) {
  glm::mat4 out(1.0F);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const float v = m[static_cast<unsigned>(row)][column];
      if (!std::isfinite(v)) return glm::mat4(1.0F);
      out[column][row] = v;
    }
  }
  return out;
}

json floats(const float* values, int count) {
  return std::vector<float>(values, values + count);
}

void put_transform(const glm::mat4& parent_from_node, json& node) {
  Transform t;
  if (!decompose(parent_from_node, t)) {
    node["matrix"] = floats(&parent_from_node[0][0], 16);
    return;
  }
  if (t.translation_m != glm::vec3(0.0F)) node["translation"] = floats(&t.translation_m.x, 3);
  if (t.scale != glm::vec3(1.0F)) node["scale"] = floats(&t.scale.x, 3);
  const glm::vec4 q(t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w);
  if (q != glm::vec4(0, 0, 0, 1)) node["rotation"] = floats(&q.x, 4);
}

/// "IfcWall_Wand-Ext-ERDG-1_3rPX_Juz59peXXY6wDJl18" as Assimp 5.2 names the nodes of IFC elements.
struct IfcName {
  std::string kind, name, guid;
};
bool split_ifc_name(const std::string& text, IfcName& out) {
  constexpr std::size_t kGuid = 22;  // IfcGloballyUniqueId: 22 digits of base 64, '_' and '$' among them
  const std::size_t first = text.find('_');
  if (!text.starts_with("Ifc") || first == std::string::npos || text.size() < first + 2 + kGuid) return false;
  const std::size_t last = text.size() - kGuid - 1;
  if (text[last] != '_') return false;
  const bool digits =
      std::all_of(text.begin() + static_cast<std::ptrdiff_t>(last) + 1, text.end(), [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' ||
               c == '$';
      });
  if (!digits) return false;
  out = {text.substr(0, first), last > first ? text.substr(first + 1, last - first - 1) : "",
         text.substr(last + 1)};
  return true;
}

class NodeConverter {
 public:
  NodeConverter(Conversion& c, const std::vector<json>& primitives) : c_(c), primitives_(primitives) {}
  void run();

 private:
  /// Kept: something is drawn, looks or shines at it or below it, or (but in IFC, where openings and
  /// relations would fill the hierarchy) it is there at all.
  bool mark_kept(const aiNode& node, unsigned depth);
  [[nodiscard]] bool spliced(const aiNode& node) const;
  std::size_t add(const aiNode& node, const std::string& above);
  void add_children(const aiNode& node, const std::string& name, json& children);
  std::size_t push(json node, const std::string& wanted);
  std::string unique_name(const std::string& wanted);
  json mesh_index(const aiNode& node, const std::string& name);
  void add_cameras();
  void add_lights();
  std::size_t attach(const aiString& to, const aiVector3D& position, const glm::mat3& rotation,
                     const std::string& kind);

  Conversion& c_;
  const std::vector<json>& primitives_;
  json nodes_ = json::array();
  std::unordered_map<std::string, std::uint32_t> names_;  ///< last suffix given
  std::unordered_set<const aiNode*> kept_;
  std::unordered_set<std::string> needed_;  ///< names of nodes with a camera or light
  std::unordered_map<std::string, std::size_t> mesh_of_primitives_;
  std::unordered_map<std::string, std::size_t> node_of_name_;  ///< the model's names, first occurrence
};

std::string NodeConverter::unique_name(const std::string& wanted) {
  std::string base = wanted.empty() ? "node_" + std::to_string(nodes_.size()) : wanted;
  const auto [entry, fresh] = names_.emplace(base, 1);
  if (fresh) return base;
  std::string name;
  do {
    name = base + "_" + std::to_string(++names_[base]);
  } while (!names_.emplace(name, 1).second);
  return name;
}

std::size_t NodeConverter::push(json node, const std::string& wanted) {
  node["name"] = unique_name(wanted);
  nodes_.push_back(std::move(node));
  return nodes_.size() - 1;
}

bool NodeConverter::mark_kept(const aiNode& node, unsigned depth) {
  if (depth > limits::kMaxNodeDepth)
    throw Refusal{"its nodes are nested deeper than " + std::to_string(limits::kMaxNodeDepth)};
  bool kept = !c_.ifc || needed_.count(text(node.mName)) != 0;
  for (unsigned i = 0; i < node.mNumMeshes; ++i)
    kept |= node.mMeshes[i] < primitives_.size() && !primitives_[node.mMeshes[i]].is_null();
  for (unsigned i = 0; i < node.mNumChildren; ++i) kept |= mark_kept(*node.mChildren[i], depth + 1);
  if (kept) kept_.insert(&node);
  return kept;
}

/// IFC: "$RelAggregates" and its like are relations, no places.
bool NodeConverter::spliced(const aiNode& node) const {
  return c_.ifc && node.mName.length > 0 && node.mName.data[0] == '$' && node.mNumMeshes == 0 &&
         node.mTransformation.IsIdentity();
}

/// One glTF mesh for each distinct list of primitives: nodes that share meshes go on sharing them.
json NodeConverter::mesh_index(const aiNode& node, const std::string& name) {
  json list = json::array();
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const unsigned mesh = node.mMeshes[i];
    if (mesh < primitives_.size() && !primitives_[mesh].is_null()) list.push_back(primitives_[mesh]);
  }
  if (list.empty()) return nullptr;
  json& meshes = c_.document.root["meshes"];
  const auto [entry, fresh] = mesh_of_primitives_.emplace(list.dump(), meshes.size());
  if (fresh) meshes.push_back({{"name", name}, {"primitives", std::move(list)}});
  return entry->second;
}

void NodeConverter::add_children(const aiNode& node, const std::string& name, json& children) {
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    const aiNode& child = *node.mChildren[i];
    if (kept_.count(&child) == 0) continue;
    if (spliced(child)) {
      add_children(child, name, children);
    } else {
      children.push_back(add(child, name));
    }
  }
}

std::size_t NodeConverter::add(const aiNode& node, const std::string& above) {
  std::string name = text(node.mName);
  json extras = metadata_json(node.mMetaData);
  if (IfcName ifc; c_.ifc && split_ifc_name(name, ifc)) {
    extras["guid"] = ifc.guid;
    extras["ifcClass"] = ifc.kind;
    extras["ifcName"] = ifc.name;
  } else if (c_.ifc && name.starts_with("Ifc")) {
    name = above + "/" + name;  // a representation of the element above
  }
  const bool path_of_file = node.mParent == nullptr && (name.empty() || name.find('/') != std::string::npos ||
                                                        name.find('\\') != std::string::npos);
  if (path_of_file) name = std::filesystem::path(c_.path).stem().string();
  json out = json::object();
  put_transform(matrix(node.mTransformation), out);
  if (json mesh = mesh_index(node, name); !mesh.is_null()) out["mesh"] = std::move(mesh);
  if (!extras.empty()) out["extras"] = std::move(extras);
  const std::size_t index = push(std::move(out), name);
  node_of_name_.emplace(text(node.mName), index);
  json children = json::array();
  add_children(node, nodes_[index]["name"].get<std::string>(), children);
  if (!children.empty()) nodes_[index]["children"] = std::move(children);
  return index;
}

/// Columns right, up, back of something that looks along `forward`.
glm::mat3 looking(const aiVector3D& forward, const aiVector3D& up) {
  const glm::dvec3 f(forward.x, forward.y, forward.z);
  const glm::dvec3 u(up.x, up.y, up.z);
  if (!(glm::dot(f, f) > 1e-12)) return glm::mat3(1.0F);
  const glm::dvec3 back = -f / std::sqrt(glm::dot(f, f));
  glm::dvec3 right = glm::cross(u, back);
  if (!(glm::dot(right, right) > 1e-12)) {  // no up, or along the view: any other
    right = glm::cross(std::abs(back.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0), back);
  }
  right /= std::sqrt(glm::dot(right, right));
  return glm::mat3(glm::dmat3(right, glm::cross(back, right), back));
}

/// A node below the one named `to` (or a root) that stands and looks as given; the node itself when that is
/// how it stands.
std::size_t NodeConverter::attach(const aiString& to, const aiVector3D& position, const glm::mat3& rotation,
                                  const std::string& kind) {
  glm::mat4 placed(rotation);
  placed[3] = glm::vec4(position.x, position.y, position.z, 1.0F);
  const auto found = node_of_name_.find(text(to));
  const bool taken = found != node_of_name_.end() && (nodes_[found->second].contains("camera") ||
                                                      nodes_[found->second].contains("extensions"));
  if (found != node_of_name_.end() && placed == glm::mat4(1.0F) && !taken) return found->second;
  json node = json::object();
  put_transform(placed, node);
  const std::size_t made = push(std::move(node), text(to) + "/" + kind);
  const std::size_t parent = found != node_of_name_.end() ? found->second : 0;
  nodes_[parent]["children"].push_back(made);
  return made;
}

/// Six digits: enough for a lens, and the same whatever the mathematical library.
float rounded(double value) {
  return static_cast<float>(std::round(value * 1e6) / 1e6);
}

void NodeConverter::add_cameras() {
  for (unsigned i = 0; i < c_.scene.mNumCameras; ++i) {
    const aiCamera& camera = *c_.scene.mCameras[i];
    const double aspect = camera.mAspect > 0 && std::isfinite(camera.mAspect) ? camera.mAspect : 4.0 / 3.0;
    const double half = std::clamp(double{camera.mHorizontalFOV} / 2, 0.01, 1.5);
    json lens = {{"znear", camera.mClipPlaneNear > 1e-4F && camera.mClipPlaneNear < 1e6F
                               ? camera.mClipPlaneNear
                               : 0.1F}};
    if (camera.mOrthographicWidth > 0 && std::isfinite(camera.mOrthographicWidth)) {
      lens["xmag"] = camera.mOrthographicWidth;
      lens["ymag"] = rounded(camera.mOrthographicWidth / aspect);
      lens["zfar"] = std::max(camera.mClipPlaneFar, 2 * lens["znear"].get<float>());
    } else {
      lens["yfov"] = rounded(2 * std::atan(std::tan(half) / aspect));
      if (camera.mClipPlaneFar > 2 * lens["znear"].get<float>() && std::isfinite(camera.mClipPlaneFar))
        lens["zfar"] = camera.mClipPlaneFar;
    }
    const char* const type = lens.contains("xmag") ? "orthographic" : "perspective";
    json made = {{"type", type}, {type, std::move(lens)}};
    if (camera.mName.length > 0) made["name"] = text(camera.mName);
    json& cameras = c_.document.root["cameras"];
    cameras.push_back(std::move(made));
    const std::size_t node =
        attach(camera.mName, camera.mPosition, looking(camera.mLookAt, camera.mUp), "camera");
    nodes_[node]["camera"] = cameras.size() - 1;
  }
}

void NodeConverter::add_lights() {
  json lights = json::array();
  for (unsigned i = 0; i < c_.scene.mNumLights; ++i) {
    const aiLight& light = *c_.scene.mLights[i];
    const char* const type = light.mType == aiLightSource_DIRECTIONAL ? "directional"
                             : light.mType == aiLightSource_POINT     ? "point"
                             : light.mType == aiLightSource_SPOT      ? "spot"
                                                                      : nullptr;
    if (type == nullptr) {
      c_.notes.add("lights that are neither directional, point nor spot");
      continue;
    }
    const aiColor3D& color = light.mColorDiffuse;
    const float most = std::max({color.r, color.g, color.b});
    if (!(most > 0) || !std::isfinite(most)) {
      c_.notes.add("lights without light");
      continue;
    }
    json made = {
        {"type", type},
        {"intensity", most},
        {"color",
         {std::max(color.r, 0.0F) / most, std::max(color.g, 0.0F) / most, std::max(color.b, 0.0F) / most}}};
    if (light.mName.length > 0) made["name"] = text(light.mName);
    if (light.mType == aiLightSource_SPOT) {
      const double outer = std::clamp(double{light.mAngleOuterCone} / 2, 0.01, 1.57);
      const double inner = std::clamp(double{light.mAngleInnerCone} / 2, 0.0, outer - 0.001);
      made["spot"] = {{"outerConeAngle", rounded(outer)}, {"innerConeAngle", rounded(inner)}};
    }
    const glm::mat3 rotation =
        light.mType == aiLightSource_POINT ? glm::mat3(1.0F) : looking(light.mDirection, light.mUp);
    const std::size_t node = attach(light.mName, light.mPosition, rotation, "light");
    nodes_[node]["extensions"]["KHR_lights_punctual"]["light"] = lights.size();
    lights.push_back(std::move(made));
  }
  if (lights.empty()) return;
  c_.document.root["extensions"]["KHR_lights_punctual"]["lights"] = std::move(lights);
  c_.document.root["extensionsUsed"].push_back("KHR_lights_punctual");
}

void NodeConverter::run() {
  for (unsigned i = 0; i < c_.scene.mNumCameras; ++i) needed_.insert(text(c_.scene.mCameras[i]->mName));
  for (unsigned i = 0; i < c_.scene.mNumLights; ++i) needed_.insert(text(c_.scene.mLights[i]->mName));
  std::size_t root = 0;
  (void)mark_kept(*c_.scene.mRootNode, 0);
  if (c_.metres_y_up == glm::mat4(1.0F)) {
    root = add(*c_.scene.mRootNode, "");
  } else {
    json top = json::object();
    put_transform(c_.metres_y_up, top);
    root = push(std::move(top), "metres_y_up");
    const std::size_t below = add(*c_.scene.mRootNode, "");
    nodes_[root]["children"] = {below};
  }
  add_cameras();
  add_lights();
  json& document = c_.document.root;
  document["nodes"] = std::move(nodes_);
  document["scenes"] = json::array({{{"nodes", {root}}}});
  document["scene"] = 0;
}

}  // namespace

void convert_nodes(Conversion& c, const std::vector<json>& primitives) {
  NodeConverter(c, primitives).run();
}

}  // namespace scenegen::import
