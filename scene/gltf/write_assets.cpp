#include "scene/gltf/write_assets.h"

// Only the declarations: the functions are in Debian's libtinygltf.so.
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "scene/gltf/write_check.h"

namespace scenegen::gltf {

namespace {

tinygltf::Value numbers(std::initializer_list<float> values) {
  tinygltf::Value::Array array;
  for (const float v : values) array.emplace_back(static_cast<double>(v));
  return tinygltf::Value(std::move(array));
}

/// Sampler, made at its first use. glTF's default sampler is none at all.
int sampler_of(const Sampler& sampler, std::vector<Sampler>& known, tinygltf::Model& model) {
  if (sampler == Sampler{}) return -1;
  const auto at = std::find(known.begin(), known.end(), sampler);
  if (at != known.end()) return static_cast<int>(at - known.begin());
  known.push_back(sampler);
  tinygltf::Sampler& out = model.samplers.emplace_back();
  if (sampler.mag_filter != 0) out.magFilter = sampler.mag_filter;
  if (sampler.min_filter != 0) out.minFilter = sampler.min_filter;
  out.wrapS = sampler.wrap_s;
  out.wrapT = sampler.wrap_t;
  return static_cast<int>(known.size()) - 1;
}

void add_textures(const Scene& scene, const BufferPlan& buffer, tinygltf::Model& model, AssetTrees& trees) {
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    tinygltf::Image& image = model.images.emplace_back();
    image.bufferView = static_cast<int>(buffer.images[i].index);
    image.mimeType = image_mime_type(scene.images[i]);
  }
  std::vector<Sampler> samplers;
  for (const Texture& texture : scene.textures) {
    tinygltf::Texture& out = model.textures.emplace_back();
    out.sampler = sampler_of(texture.sampler, samplers, model);
    if (!texture.image.valid()) continue;
    const auto source = static_cast<int>(texture.image.value);
    const std::string& type = model.images[texture.image.value].mimeType;
    const std::string extension = type == "image/webp"   ? "EXT_texture_webp"
                                  : type == "image/ktx2" ? "KHR_texture_basisu"
                                                         : "";
    if (extension.empty()) {
      out.source = source;
    } else {  // there is no other image to fall back to, so it is required
      out.extensions[extension] = tinygltf::Value({{"source", tinygltf::Value(source)}});
      trees.extensions_used.insert(extension);
      trees.extensions_required.insert(extension);
    }
  }
}

template <class Info>
void use_texture(const TextureUse& use, Info& out, AssetTrees& trees) {
  if (!use.texture.valid()) return;
  out.index = static_cast<int>(use.texture.value);
  out.texCoord = static_cast<int>(use.texcoord);
  tinygltf::Value::Object transform;
  if (use.uv_offset != glm::vec2(0.0F)) transform["offset"] = numbers({use.uv_offset.x, use.uv_offset.y});
  if (use.uv_rotation_rad != 0.0F)
    transform["rotation"] = tinygltf::Value(static_cast<double>(use.uv_rotation_rad));
  if (use.uv_scale != glm::vec2(1.0F)) transform["scale"] = numbers({use.uv_scale.x, use.uv_scale.y});
  if (transform.empty()) return;
  out.extensions["KHR_texture_transform"] = tinygltf::Value(std::move(transform));
  trees.extensions_used.insert("KHR_texture_transform");
}

void add_material(const Material& material, float strength, tinygltf::Model& model, AssetTrees& trees) {
  tinygltf::Material& out = model.materials.emplace_back();
  tinygltf::PbrMetallicRoughness& pbr = out.pbrMetallicRoughness;
  const glm::vec4& c = material.base_color;
  pbr.baseColorFactor = {c.x, c.y, c.z, c.w};
  pbr.metallicFactor = material.metallic;
  pbr.roughnessFactor = material.roughness;
  const glm::vec3 emissive = material.emissive / strength;
  out.emissiveFactor = {emissive.x, emissive.y, emissive.z};
  if (material.alpha_mode == AlphaMode::mask) {
    out.alphaMode = "MASK";
    out.alphaCutoff = material.alpha_cutoff;  // the validator warns of a cutoff without MASK
  } else if (material.alpha_mode == AlphaMode::blend) {
    out.alphaMode = "BLEND";
  }
  out.doubleSided = material.double_sided;
  use_texture(material.base_color_texture, pbr.baseColorTexture, trees);
  use_texture(material.metallic_roughness_texture, pbr.metallicRoughnessTexture, trees);
  use_texture(material.normal_texture, out.normalTexture, trees);
  use_texture(material.occlusion_texture, out.occlusionTexture, trees);
  use_texture(material.emissive_texture, out.emissiveTexture, trees);
  out.normalTexture.scale = material.normal_texture.strength;
  out.occlusionTexture.strength = material.occlusion_texture.strength;
  if (material.unlit) {
    out.extensions["KHR_materials_unlit"] = tinygltf::Value(tinygltf::Value::Object{});
    trees.extensions_used.insert("KHR_materials_unlit");
  }
  if (strength > 1.0F) {
    out.extensions["KHR_materials_emissive_strength"] =
        tinygltf::Value({{"emissiveStrength", tinygltf::Value(static_cast<double>(strength))}});
    trees.extensions_used.insert("KHR_materials_emissive_strength");
  }
}

void add_draco(const DracoStream& stream, std::uint32_t view, tinygltf::Primitive& out) {
  tinygltf::Value::Object ids;
  const auto attribute = [&](const char* name, int id) {
    if (id >= 0) ids[name] = tinygltf::Value(id);
  };
  attribute("POSITION", stream.position);
  attribute("NORMAL", stream.normal);
  attribute("TANGENT", stream.tangent);
  attribute("TEXCOORD_0", stream.texcoord[0]);
  attribute("TEXCOORD_1", stream.texcoord[1]);
  attribute("COLOR_0", stream.color);
  out.extensions["KHR_draco_mesh_compression"] =
      tinygltf::Value({{"bufferView", tinygltf::Value(static_cast<int>(view))},
                       {"attributes", tinygltf::Value(std::move(ids))}});
}

void add_mesh(const Scene& scene, const Mesh& mesh, const BufferPlan& buffer, tinygltf::Model& model) {
  tinygltf::Mesh& out = model.meshes.emplace_back();
  for (const Primitive& primitive : mesh.primitives) {
    const GeometryAccessors& accessors = buffer.geometries[primitive.geometry.value];
    tinygltf::Primitive& p = out.primitives.emplace_back();
    const auto attribute = [&](const char* name, int accessor) {
      if (accessor >= 0) p.attributes[name] = accessor;
    };
    attribute("POSITION", accessors.position);
    attribute("NORMAL", accessors.normal);
    attribute("TANGENT", accessors.tangent);
    attribute("TEXCOORD_0", accessors.texcoord[0]);
    attribute("TEXCOORD_1", accessors.texcoord[1]);
    attribute("COLOR_0", accessors.color);
    p.indices = accessors.indices;
    p.mode = static_cast<int>(scene.geometries[primitive.geometry.value].topology);  // the numbers are glTF's
    if (const DracoStream* const stream = buffer.streams->find(primitive.geometry.value))
      add_draco(*stream, buffer.draco[primitive.geometry.value].index, p);
    p.material = primitive.material.valid() ? static_cast<int>(primitive.material.value) : -1;
  }
}

/// What tinygltf cannot do right: names (it cuts them at a NUL),
/// and properties with default values that a pointer needs.
void finish_trees(const Scene& scene, const std::vector<float>& strengths, AssetTrees& trees) {
  const auto name_all = [](nlohmann::json& trees_of, const auto& things) {
    for (std::size_t i = 0; i < things.size(); ++i) {
      if (!things[i].name.empty()) trees_of[i]["name"] = things[i].name;
    }
  };
  name_all(trees.meshes, scene.meshes);
  name_all(trees.materials, scene.materials);
  name_all(trees.images, scene.images);
  for (nlohmann::json& mesh : trees.meshes) {
    for (nlohmann::json& primitive : mesh["primitives"]) {
      if (primitive["mode"] == TINYGLTF_MODE_TRIANGLES) primitive.erase("mode");
    }
  }
  for (nlohmann::json& texture : trees.textures) {
    if (texture.is_null()) texture = nlohmann::json::object();  // neither sampler nor source
  }
  for (const MaterialTrack& t : scene.material_tracks) {
    const Material& m = scene.materials[t.material.value];
    nlohmann::json& tree = trees.materials[t.material.value];
    if (scene.tracks[t.track.value].property == Property::base_color) {
      const glm::vec4& c = m.base_color;
      tree["pbrMetallicRoughness"]["baseColorFactor"] = {c.x, c.y, c.z, c.w};
    } else {
      glm::vec3 e = m.emissive / strengths[t.material.value];
      if (e == glm::vec3(0.0F) && strengths[t.material.value] > 1.0F) {
        // The validator warns of a strength with nothing to strengthen, though the track gives it something.
        e = glm::vec3(1.0F);
        tree["extras"]["scenegen"]["emissive"] = {0.0F, 0.0F, 0.0F};
      }
      tree["emissiveFactor"] = {e.x, e.y, e.z};
    }
  }
}

}  // namespace

std::vector<float> emissive_strengths(const Scene& scene) {
  std::vector<float> most(scene.materials.size(), 1.0F);
  const auto raise = [](float& to, float value) { to = std::max(to, std::abs(value)); };
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    for (int c = 0; c < 3; ++c) raise(most[i], scene.materials[i].emissive[c]);
  }
  for (const MaterialTrack& t : scene.material_tracks) {
    const Track& track = scene.tracks[t.track.value];
    if (track.property != Property::emissive) continue;
    const bool spline = track.interpolation == Interpolation::cubic_spline;
    const std::span<const float> values = scene.values(t.track);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!spline || i / 3 % 3 == 1) raise(most[t.material.value], values[i]);  // tangents may be larger
    }
  }
  for (float& m : most) {
    int exponent = 0;
    const float fraction = std::frexp(m, &exponent);  // m = fraction * 2^exponent, fraction in [0.5, 1)
    m = std::ldexp(1.0F, fraction == 0.5F ? exponent - 1 : std::min(exponent, 127));
  }
  return most;
}

AssetTrees make_assets(const Scene& scene, const BufferPlan& buffer, const std::vector<float>& strengths) {
  AssetTrees trees;
  tinygltf::Model model;
  if (buffer.streams->any()) {  // there is no uncompressed copy to fall back to, so it is required
    trees.extensions_used.insert("KHR_draco_mesh_compression");
    trees.extensions_required.insert("KHR_draco_mesh_compression");
  }
  for (const Mesh& mesh : scene.meshes) add_mesh(scene, mesh, buffer, model);
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    add_material(scene.materials[i], strengths[i], model, trees);
  add_textures(scene, buffer, model, trees);

  std::ostringstream text;
  tinygltf::TinyGLTF writer;
  writer.WriteGltfSceneToStream(&model, text, false, false);
  nlohmann::json document = nlohmann::json::parse(text.str());
  const auto take = [&](const char* key) {
    return document.contains(key) ? std::move(document[key]) : nlohmann::json::array();
  };
  trees.meshes = take("meshes");
  trees.materials = take("materials");
  trees.textures = take("textures");
  trees.samplers = take("samplers");
  trees.images = take("images");
  finish_trees(scene, strengths, trees);
  return trees;
}

}  // namespace scenegen::gltf
