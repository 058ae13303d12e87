#include "timeline/compare_content.h"

#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

#include "scene/axis_affine.h"
#include "timeline/compare_report.h"
#include "timeline/compare_surface.h"

namespace scenegen::timeline {

namespace {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Empty if the streams are the same bits.
template <class T>
std::string stream_difference(std::string_view name, const std::vector<T>& a, const std::vector<T>& b) {
  if (same_bits(a, b)) return {};
  const std::string stream(name);
  if (a.size() != b.size()) return a_and_b("", text(a.size()) + " " + stream, text(b.size()));
  std::size_t i = 0;
  while (std::memcmp(&a[i], &b[i], sizeof(T)) == 0) ++i;
  const std::string which = stream + "[" + text(i) + "]";
  if constexpr (std::is_integral_v<T>) {
    return a_and_b(which, text(a[i]), text(b[i]));
  } else {
    return a_and_b(which, vector_text(a[i]), vector_text(b[i]));
  }
}

std::string geometry_difference(const Geometry& a, const Geometry& b) {
  if (a.topology != b.topology) return "another topology";
  for (const std::string& difference : {stream_difference("positions", a.positions_m, b.positions_m),
                                        stream_difference("normals", a.normals, b.normals),
                                        stream_difference("tangents", a.tangents, b.tangents),
                                        stream_difference("colors", a.colors, b.colors),
                                        stream_difference("texcoords 0", a.texcoords[0], b.texcoords[0]),
                                        stream_difference("texcoords 1", a.texcoords[1], b.texcoords[1]),
                                        stream_difference("indices", a.indices, b.indices)}) {
    if (!difference.empty()) return difference;
  }
  return {};
}

std::string alpha_text(AlphaMode mode) {
  constexpr std::array<const char*, 3> kNames{"OPAQUE", "MASK", "BLEND"};
  return kNames[static_cast<std::size_t>(mode)];
}

}  // namespace

const Material& material_of(const Scene& scene, MaterialId id) {
  static const Material gltf_default;
  return id.valid() ? scene.materials[id.value] : gltf_default;
}

bool ContentComparer::close(float a, float b) const {
  return std::abs(a - b) <= options_.color_tolerance;
}

const std::vector<ContentFault>& ContentComparer::mesh_faults(MeshId a, MeshId b) {
  return mesh_pair(a, b).faults;
}

const ContentComparer::Stretch* ContentComparer::stretch(MeshId a, MeshId b) {
  const MeshPair& pair = mesh_pair(a, b);
  return pair.stretch ? &*pair.stretch : nullptr;
}

bool ContentComparer::exact() const {
  return options_.geometry_tolerance <= 0.0F && options_.normal_tolerance <= 0.0F;
}

std::optional<ContentComparer::Stretch> ContentComparer::find_stretch(const Mesh& a, const Mesh& b) const {
  if (const auto affine = axis_affine(a_, a, b_, b)) return Stretch{affine->matrix()};
  if (exact()) return std::nullopt;
  const auto affine = box_affine(a_, a, b_, b);
  if (!affine) return std::nullopt;
  for (std::size_t i = 0; i < a.primitives.size(); ++i) {
    Geometry stretched = a_.geometries[a.primitives[i].geometry.value];
    for (glm::vec3& p : stretched.positions_m) p = affine->scale * p + affine->offset_m;
    if (!surface_difference(stretched, b_.geometries[b.primitives[i].geometry.value], options_).empty())
      return std::nullopt;
  }
  return Stretch{affine->matrix(), true};
}

ContentComparer::MeshPair& ContentComparer::mesh_pair(MeshId a, MeshId b) {
  const auto [found, is_new] = mesh_pairs_.try_emplace(pair_key(a.value, b.value));
  MeshPair& pair = found->second;
  if (!is_new) return pair;
  const auto& of_a = a_.meshes[a.value].primitives;
  const auto& of_b = b_.meshes[b.value].primitives;
  if (of_a.size() != of_b.size()) {
    pair.faults.push_back({ContentFault::Kind::primitive_count, a.value, b.value});
    return pair;
  }
  bool same_shape = true, same_look = true;
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    same_shape = same_geometry(of_a[i].geometry, of_b[i].geometry) && same_shape;
    same_look = same_material(of_a[i].material, of_b[i].material) && same_look;
  }
  if (!same_shape && same_look) pair.stretch = find_stretch(a_.meshes[a.value], b_.meshes[b.value]);
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    if (!pair.stretch && !same_geometry(of_a[i].geometry, of_b[i].geometry)) {
      pair.faults.push_back({ContentFault::Kind::geometry, of_a[i].geometry.value, of_b[i].geometry.value});
    }
    if (!same_material(of_a[i].material, of_b[i].material)) {
      pair.faults.push_back({ContentFault::Kind::material, of_a[i].material.value, of_b[i].material.value});
    }
  }
  return pair;
}

std::string ContentComparer::content_difference(const Geometry& a, const Geometry& b) const {
  std::string difference = geometry_difference(a, b);
  return exact() || difference.empty() ? difference : surface_difference(a, b, options_);
}

bool ContentComparer::same_geometry(GeometryId a, GeometryId b) {
  const auto [found, is_new] = geometry_pairs_.try_emplace(pair_key(a.value, b.value), false);
  if (is_new) {
    found->second = content_difference(a_.geometries[a.value], b_.geometries[b.value]).empty();
  }
  return found->second;
}

bool ContentComparer::same_material(MaterialId a, MaterialId b) {
  const auto [found, is_new] = material_pairs_.try_emplace(pair_key(a.value, b.value), false);
  if (is_new) found->second = material_difference(a, b).empty();
  return found->second;
}

std::string ContentComparer::material_difference(MaterialId id_a, MaterialId id_b) const {
  const Material& a = material_of(a_, id_a);
  const Material& b = material_of(b_, id_b);
  if (!close(a.metallic, b.metallic)) return a_and_b("metallic", text(a.metallic), text(b.metallic));
  if (!close(a.roughness, b.roughness)) return a_and_b("roughness", text(a.roughness), text(b.roughness));
  if (a.alpha_mode != b.alpha_mode) {
    return a_and_b("alpha mode", alpha_text(a.alpha_mode), alpha_text(b.alpha_mode));
  }
  if (a.alpha_mode == AlphaMode::mask && !close(a.alpha_cutoff, b.alpha_cutoff)) {
    return a_and_b("alpha cutoff", text(a.alpha_cutoff), text(b.alpha_cutoff));
  }
  if (a.double_sided != b.double_sided)
    return a.double_sided ? "double-sided in A only" : "double-sided in B only";
  if (a.unlit != b.unlit) return a.unlit ? "unlit in A only" : "unlit in B only";
  const auto texture = [&](const char* name, const TextureUse& use_a, const TextureUse& use_b) {
    std::string difference = texture_difference(use_a, use_b);
    return difference.empty() ? difference : std::string(name) + " texture: " + difference;
  };
  for (std::string difference :
       {texture("base colour", a.base_color_texture, b.base_color_texture),
        texture("metallic-roughness", a.metallic_roughness_texture, b.metallic_roughness_texture),
        texture("normal", a.normal_texture, b.normal_texture),
        texture("occlusion", a.occlusion_texture, b.occlusion_texture),
        texture("emissive", a.emissive_texture, b.emissive_texture)}) {
    if (!difference.empty()) return difference;
  }
  return {};
}

std::string ContentComparer::texture_difference(const TextureUse& a, const TextureUse& b) const {
  if (a.texture.valid() != b.texture.valid()) return a.texture.valid() ? "in A only" : "in B only";
  if (!a.texture.valid()) return {};
  if (a.texcoord != b.texcoord) return a_and_b("texture coordinates", text(a.texcoord), text(b.texcoord));
  if (!close(a.strength, b.strength)) return a_and_b("strength", text(a.strength), text(b.strength));
  if (!close(a.uv_offset.x, b.uv_offset.x) || !close(a.uv_offset.y, b.uv_offset.y)) {
    return a_and_b("offset", vector_text(a.uv_offset), vector_text(b.uv_offset));
  }
  if (!close(a.uv_rotation_rad, b.uv_rotation_rad)) {
    return a_and_b("rotation", text(a.uv_rotation_rad), text(b.uv_rotation_rad));
  }
  if (!close(a.uv_scale.x, b.uv_scale.x) || !close(a.uv_scale.y, b.uv_scale.y)) {
    return a_and_b("scale", vector_text(a.uv_scale), vector_text(b.uv_scale));
  }
  const Texture& texture_a = a_.textures[a.texture.value];
  const Texture& texture_b = b_.textures[b.texture.value];
  if (!(texture_a.sampler == texture_b.sampler)) return "another sampler";
  if (texture_a.image.valid() != texture_b.image.valid())
    return texture_a.image.valid() ? "image in A only" : "image in B only";
  if (!texture_a.image.valid()) return {};
  const auto& bytes_a = a_.images[texture_a.image.value].bytes;
  const auto& bytes_b = b_.images[texture_b.image.value].bytes;
  if (bytes_a.size() != bytes_b.size()) {
    return a_and_b("image of", text(bytes_a.size()) + " bytes", text(bytes_b.size()));
  }
  return same_bits(bytes_a, bytes_b) ? std::string() : "image bytes differ";
}

std::string ContentComparer::where(const ContentFault& fault) const {
  switch (fault.kind) {
    case ContentFault::Kind::primitive_count:
      return "mesh '" + a_.meshes[fault.a].name + "'";
    case ContentFault::Kind::geometry:
      return "geometry " + text(fault.a);
    case ContentFault::Kind::material:
      break;
  }
  return "material '" + material_of(a_, MaterialId(fault.a)).name + "'";
}

std::string ContentComparer::what(const ContentFault& fault) const {
  switch (fault.kind) {
    case ContentFault::Kind::primitive_count:
      return a_and_b("", text(a_.meshes[fault.a].primitives.size()) + " primitives",
                     text(b_.meshes[fault.b].primitives.size()));
    case ContentFault::Kind::geometry:
      return content_difference(a_.geometries[fault.a], b_.geometries[fault.b]);
    case ContentFault::Kind::material:
      break;
  }
  return material_difference(MaterialId(fault.a), MaterialId(fault.b));
}

}  // namespace scenegen::timeline
