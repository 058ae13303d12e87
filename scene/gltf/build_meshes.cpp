#include <array>
#include <cstring>
#include <map>

#include "scene/gltf/build.h"

namespace scenegen::gltf::reading {

namespace {

template <class Vector>
void read_vectors(Data& data, std::uint32_t accessor, const Place& at, std::vector<Vector>& out) {
  const std::vector<float> values = data.floats(accessor, Vector::length(), at);
  out.resize(values.size() / Vector::length());
  std::memcpy(out.data(), values.data(), values.size() * sizeof(float));
}

/// COLOR_0 may be RGB.
void read_colors(Data& data, std::uint32_t accessor, const Place& at, std::vector<glm::vec4>& out) {
  if (data.accessor(accessor, at).components == 4) return read_vectors(data, accessor, at, out);
  std::vector<glm::vec3> rgb;
  read_vectors(data, accessor, at, rgb);
  data.budget().take(rgb.size() * sizeof(glm::vec4), at);
  out.reserve(rgb.size());
  for (const glm::vec3& c : rgb) out.emplace_back(c, 1.0F);
}

void check_count(std::size_t count, std::size_t vertices, const Place& at) {
  if (count == 0 || count == vertices) return;
  reject(at, std::to_string(count) + " elements, but POSITION has " + std::to_string(vertices));
}

Geometry read_geometry(const PrimitiveRecord& primitive, Data& data, const Place& at) {
  Geometry out;
  out.topology = static_cast<Topology>(primitive.mode);
  const bool draco = primitive.draco_view != kNone;
  if (draco) {
    if (primitive.mode != 4 && primitive.mode != 5) reject(at.key("mode"), "Draco meshes are triangles");
    const Place extensions = at.key("extensions");
    decode_draco(primitive, data, extensions.key("KHR_draco_mesh_compression"), out);
    out.topology = Topology::triangles;
  }
  const Place names = at.key("attributes");
  const auto& a = primitive.attribute;
  const auto& id = primitive.draco_id;
  const auto plain = [&](std::size_t slot) { return a[slot] != kNone && !(draco && id[slot] != kNone); };
  if (plain(0)) read_vectors(data, a[0], names.key("POSITION"), out.positions_m);
  if (plain(1)) read_vectors(data, a[1], names.key("NORMAL"), out.normals);
  if (plain(2)) read_vectors(data, a[2], names.key("TANGENT"), out.tangents);
  if (plain(3)) read_vectors(data, a[3], names.key("TEXCOORD_0"), out.texcoords[0]);
  if (plain(4)) read_vectors(data, a[4], names.key("TEXCOORD_1"), out.texcoords[1]);
  if (plain(5)) read_colors(data, a[5], names.key("COLOR_0"), out.colors);
  const std::size_t vertices = out.vertex_count();
  check_count(out.normals.size(), vertices, names.key("NORMAL"));
  check_count(out.tangents.size(), vertices, names.key("TANGENT"));
  check_count(out.texcoords[0].size(), vertices, names.key("TEXCOORD_0"));
  check_count(out.texcoords[1].size(), vertices, names.key("TEXCOORD_1"));
  check_count(out.colors.size(), vertices, names.key("COLOR_0"));
  if (!draco && primitive.indices != kNone) out.indices = data.integers(primitive.indices, at.key("indices"));
  for (std::size_t i = 0; i < out.indices.size(); ++i) {
    if (out.indices[i] >= vertices) {
      reject(at.key("indices"), "element " + std::to_string(i) + " is " + std::to_string(out.indices[i]) +
                                    " of " + std::to_string(vertices) + " vertices");
    }
  }
  return out;
}

}  // namespace

void build_meshes(Document& document, Data& data, Scene& scene) {
  using Key = std::array<std::uint32_t, 2 * kAttributes + 3>;
  std::map<Key, GeometryId> known;  // the same accessors are the same geometry
  const Place root;
  const Place list = root.key("meshes");
  scene.meshes.reserve(document.meshes.size());
  for (std::size_t m = 0; m < document.meshes.size(); ++m) {
    const MeshRecord& record = document.meshes[m];
    const Place at = list.at(m);
    const Place primitives = at.key("primitives");
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.name = record.name;
    mesh.primitives.reserve(record.primitive_count);
    for (std::uint32_t i = 0; i < record.primitive_count; ++i) {
      const PrimitiveRecord& primitive = document.primitives[record.first_primitive + i];
      const Place here = primitives.at(i);
      if (primitive.attribute[0] == kNone) {
        document.ignored.add(here, "primitives without POSITION");
        continue;
      }
      if (primitive.material != kNone)
        check_index(primitive.material, scene.materials.size(), "materials", here.key("material"));
      Key key{primitive.mode, primitive.indices, primitive.draco_view};
      for (std::size_t k = 0; k < kAttributes; ++k) {
        key[3 + k] = primitive.attribute[k];
        key[3 + kAttributes + k] = primitive.draco_id[k];
      }
      const auto [entry, fresh] = known.emplace(key, GeometryId(scene.geometries.size()));
      if (fresh) scene.geometries.push_back(read_geometry(primitive, data, here));
      const MaterialId material = primitive.material == kNone ? MaterialId() : MaterialId(primitive.material);
      mesh.primitives.push_back({entry->second, material});
    }
  }
}

}  // namespace scenegen::gltf::reading
