#include "scene/gltf/patch_assets.h"

#include <algorithm>
#include <map>

#include "scene/gltf/patch_text.h"
#include "scene/gltf/write_assets.h"

namespace scenegen::gltf::patching {

using reading::Place;
using reading::reject;
using reading::Value;

namespace {

std::string numbers(const glm::vec4& v) {
  return text_of([&](TextOut& out) { out.numbers(v); });
}

template <class Copied>
Copied* find_copied(std::vector<Copied>& list, std::uint64_t index) {
  const auto at = std::lower_bound(list.begin(), list.end(), index,
                                   [](const Copied& c, std::uint64_t i) { return c.index < i; });
  return at != list.end() && at->index == index ? &*at : nullptr;
}

template <class Copied, class New>
void list_copied(const std::vector<New>& made, std::vector<Copied>& out) {
  std::vector<std::uint32_t> wanted;
  for (const New& n : made) {
    if (n.copy_of != kNone) wanted.push_back(n.copy_of);
  }
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  for (const std::uint32_t index : wanted) out.emplace_back().index = index;
}

/// Materials that copy none: as the writer writes them. Their textures are the file's, by number.
void plan_materials(const PatchInput& in, AssetPatch& out) {
  const std::size_t first = in.document.materials.size();
  Scene plain;
  for (std::size_t m = first; m < in.scene.materials.size(); ++m) {
    NewMaterial& made = out.materials.emplace_back();
    const std::size_t k = m - first;
    const MaterialId source =
        k < in.options.material_copy_of.size() ? in.options.material_copy_of[k] : MaterialId();
    if (source.valid() && source.value >= m) {
      const Place root;
      const Place list = root.key("materials");
      reject(list.at(m), "a copy of a material behind it");
    }
    if (source.valid())
      made.copy_of = source.value < first ? source.value : out.materials[source.value - first].copy_of;
    if (made.copy_of == kNone) plain.materials.push_back(in.scene.materials[m]);
  }
  const DracoStreams no_streams;
  BufferPlan no_buffer;
  no_buffer.streams = &no_streams;
  AssetTrees trees = make_assets(plain, no_buffer, emissive_strengths(plain));
  out.extensions_used.insert(trees.extensions_used.begin(), trees.extensions_used.end());
  std::size_t next = 0;
  for (std::size_t k = 0; k < out.materials.size(); ++k) {
    if (out.materials[k].copy_of != kNone) continue;
    nlohmann::json& tree = trees.materials[next++];
    const glm::vec4& c = in.scene.materials[first + k].base_color;
    tree["pbrMetallicRoughness"]["baseColorFactor"] = {c.x, c.y, c.z, c.w};  // a pointer needs it
    out.materials[k].tree = std::move(tree);
  }
}

class MeshPlanner {
 public:
  MeshPlanner(const PatchInput& in, AssetPatch& out)
      : in_(in), out_(out), first_(in.document.meshes.size()) {}

  void plan() {
    if (in_.scene.meshes.size() == first_) return;
    ask_objects();
    for (std::size_t m = 0; m < first_; ++m) by_geometry_.emplace(geometries(m), m);
    for (std::size_t m = first_; m < in_.scene.meshes.size(); ++m) plan_mesh(m);
  }

 private:
  /// The mesh of the object that shows a new one is what the new one copies: others may share its geometry
  /// but have other morph targets or extras.
  void ask_objects() {
    shown_by_.assign(in_.scene.meshes.size() - first_, kNone);
    const auto hint = [&](std::uint64_t mesh, ObjectId object) {
      if (mesh < first_ || shown_by_[mesh - first_] != kNone) return;
      const reading::Node& node = in_.document.nodes[in_.source.node_of_object[object.value]];
      shown_by_[mesh - first_] = node.mesh;
    };
    for (const ObjectMeshTrack& t : in_.scene.object_mesh_tracks) {
      if (t.track.value < in_.source.track_count) continue;
      for (const float value : in_.scene.values(t.track)) hint(static_cast<std::uint64_t>(value), t.object);
    }
    for (std::size_t i = 0; i < in_.scene.objects.size(); ++i)
      hint(in_.scene.objects.mesh[i].value, ObjectId(i));
  }

  [[nodiscard]] std::vector<std::uint32_t> geometries(std::size_t mesh) const {
    std::vector<std::uint32_t> out;
    for (const Primitive& p : in_.scene.meshes[mesh].primitives) out.push_back(p.geometry.value);
    return out;
  }

  void plan_mesh(std::size_t m) {
    const std::vector<std::uint32_t> wanted = geometries(m);
    std::uint32_t base = shown_by_[m - first_];
    if (base == kNone || base >= first_ || geometries(base) != wanted) {
      const auto known = by_geometry_.find(wanted);
      if (known == by_geometry_.end()) {
        const Place root;
        const Place list = root.key("meshes");
        reject(list.at(m), "a new mesh with another geometry than those of the file");
      }
      base = static_cast<std::uint32_t>(known->second);
    }
    NewMesh made;
    made.copy_of = base;
    const reading::MeshRecord& record = in_.document.meshes[base];
    std::size_t next = 0;
    for (std::uint32_t p = 0; p < record.primitive_count; ++p) {
      const bool drawn = in_.document.primitives[record.first_primitive + p].attribute[0] != kNone;
      made.materials.push_back(drawn ? in_.scene.meshes[m].primitives[next++].material : NewMesh::kAsBefore);
    }
    out_.meshes.push_back(std::move(made));
  }

  const PatchInput& in_;
  AssetPatch& out_;
  std::size_t first_;
  std::vector<std::uint32_t> shown_by_;
  std::map<std::vector<std::uint32_t>, std::size_t> by_geometry_;
};

}  // namespace

AssetPatch plan_assets(const PatchInput& input) {
  AssetPatch out;
  plan_materials(input, out);
  MeshPlanner(input, out).plan();
  list_copied(out.materials, out.copied_materials);
  list_copied(out.meshes, out.copied_meshes);
  return out;
}

void locate_material(SourceText& text, Value value, const Place& at, AssetPatch& assets) {
  CopiedMaterial* const copied = find_copied(assets.copied_materials, at.index);
  if (copied == nullptr) return;
  copied->list = text.members(value, at, [&](std::size_t i, std::string_view key, Value& v, const Place& p) {
    if (key == "name") copied->name = i;
    if (key != "pbrMetallicRoughness") return;
    copied->pbr = i;
    copied->pbr_list = text.members(v, p, [&](std::size_t k, std::string_view name, Value&, const Place&) {
      if (name == "baseColorFactor") copied->color = k;
    });
  });
}

void locate_mesh(SourceText& text, Value value, const Place& at, AssetPatch& assets) {
  CopiedMesh* const copied = find_copied(assets.copied_meshes, at.index);
  if (copied == nullptr) return;
  copied->list = text.members(value, at, [&](std::size_t i, std::string_view key, Value& v, const Place& p) {
    if (key == "name") copied->name = i;
    if (key != "primitives") return;
    (void)text.elements(v, p, [&](std::size_t, Value& w, const Place& q) {
      CopiedMesh::Primitive& primitive = copied->primitives.emplace_back();
      ItemList list = text.members(w, q, [&](std::size_t k, std::string_view name, Value&, const Place&) {
        if (name == "material") primitive.material = k;
      });
      copied->primitives.back().list = std::move(list);
    });
  });
}

namespace {

void set_name(const ItemList& list, std::size_t have, const std::string& name, Splices& splices,
              std::string& added) {
  if (name.empty()) return;
  if (have != kAbsent) return splices.replace(list.items[have].value_span(), json_string(name));
  added += (added.empty() ? "" : ",") + std::string("\"name\":") + json_string(name);
}

}  // namespace

std::string material_texts(const PatchInput& input, const AssetPatch& assets, std::string_view text) {
  std::string out;
  for (std::size_t k = 0; k < assets.materials.size(); ++k) {
    if (k > 0) out += ',';
    const NewMaterial& made = assets.materials[k];
    if (made.copy_of == kNone) {
      out += text_of([&](TextOut& to) { to.tree(made.tree); });
      continue;
    }
    const Material& material = input.scene.materials[input.document.materials.size() + k];
    const auto copied =
        std::lower_bound(assets.copied_materials.begin(), assets.copied_materials.end(), made.copy_of,
                         [](const auto& c, std::uint32_t i) { return c.index < i; });
    Splices splices;
    std::string added;
    const std::string color = numbers(material.base_color);
    if (copied->color != kAbsent) {
      splices.replace(copied->pbr_list.items[copied->color].value_span(), color);
    } else if (copied->pbr != kAbsent) {
      copied->pbr_list.splice("\"baseColorFactor\":" + color, splices);
    } else {
      added = R"("pbrMetallicRoughness":{"baseColorFactor":)" + color + "}";
    }
    set_name(copied->list, copied->name, material.name, splices, added);
    copied->list.splice(added, splices);
    splices.sort();
    out += text_of([&](TextOut& to) { splices.emit(text, copied->list.brackets, to); });
  }
  return out;
}

std::string mesh_texts(const PatchInput& input, const AssetPatch& assets, std::string_view text) {
  std::string out;
  for (std::size_t k = 0; k < assets.meshes.size(); ++k) {
    if (k > 0) out += ',';
    const NewMesh& made = assets.meshes[k];
    const auto copied =
        std::lower_bound(assets.copied_meshes.begin(), assets.copied_meshes.end(), made.copy_of,
                         [](const auto& c, std::uint32_t i) { return c.index < i; });
    Splices splices;
    for (std::size_t p = 0; p < copied->primitives.size() && p < made.materials.size(); ++p) {
      if (made.materials[p] == NewMesh::kAsBefore) continue;
      CopiedMesh::Primitive primitive = copied->primitives[p];
      std::string added;
      const bool has = primitive.material != kAbsent;
      if (!made.materials[p].valid()) {
        if (has) primitive.list.items[primitive.material].removed = true;
      } else if (const std::string number = std::to_string(made.materials[p].value); has) {
        splices.replace(primitive.list.items[primitive.material].value_span(), number);
      } else {
        added = "\"material\":" + number;
      }
      primitive.list.splice(added, splices);
    }
    std::string added;
    set_name(copied->list, copied->name, input.scene.meshes[input.document.meshes.size() + k].name, splices,
             added);
    copied->list.splice(added, splices);
    splices.sort();
    out += text_of([&](TextOut& to) { splices.emit(text, copied->list.brackets, to); });
  }
  return out;
}

}  // namespace scenegen::gltf::patching
