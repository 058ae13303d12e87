// Materials and textures.
#include <assimp/GltfMaterial.h>
#include <assimp/material.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "scene/import/convert.h"
#include "scene/import/texture_files.h"

namespace scenegen::import {

namespace {

using nlohmann::json;

/// sRGB -> linear light (IEC 61966-2-1), four digits: the same whatever the mathematical library.
float linear(float srgb) {
  const double v = std::clamp(double{srgb}, 0.0, 1.0);
  const double out = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  return static_cast<float>(std::round(out * 1e4) / 1e4);
}

float unit(float v) {
  return v > 0 ? std::min(v, 1.0F) : 0.0F;  // also NaN
}

std::optional<float> number(const aiMaterial& m, const char* key, unsigned type, unsigned index) {
  float v = 0;
  if (m.Get(key, type, index, v) != aiReturn_SUCCESS || !std::isfinite(v)) return std::nullopt;
  return v;
}

std::optional<aiColor4D> color(const aiMaterial& m, const char* key, unsigned type, unsigned index) {
  aiColor4D v(0, 0, 0, 1);
  if (m.Get(key, type, index, v) != aiReturn_SUCCESS) return std::nullopt;
  return v;
}

int wrap(const aiMaterial& m, const char* key, aiTextureType type) {
  int mode = aiTextureMapMode_Wrap;
  (void)m.Get(key, type, 0, mode);
  return mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? 33071
         : mode == aiTextureMapMode_Mirror                                ? 33648
                                                                          : 10497;
}

/// {"index": …, "texCoord": …} of the first texture of one of the types; null when there is none.
json texture(Conversion& c, const aiMaterial& m, std::initializer_list<aiTextureType> types) {
  for (const aiTextureType type : types) {
    aiString path;
    unsigned uv = 0;
    if (m.GetTexture(type, 0, &path, nullptr, &uv) != aiReturn_SUCCESS || path.length == 0) continue;
    const std::optional<std::size_t> image = add_image(c, path);
    if (!image) return nullptr;
    json entry = {{"source", *image}};
    const int s = wrap(m, _AI_MATKEY_MAPPINGMODE_U_BASE, type);
    const int t = wrap(m, _AI_MATKEY_MAPPINGMODE_V_BASE, type);
    if (s != 10497 || t != 10497)
      entry["sampler"] = c.document.shared("samplers", {{"wrapS", s}, {"wrapT", t}});
    json out = {{"index", c.document.shared("textures", entry)}};
    if (uv == 1) out["texCoord"] = 1;
    return out;
  }
  return nullptr;
}

/// Roughness of a Blinn-Phong exponent (Walter et al. 2007: alpha = sqrt(2 / (n + 2))), roughness =
/// sqrt(alpha).
float roughness(const aiMaterial& m) {
  if (const auto given = number(m, AI_MATKEY_ROUGHNESS_FACTOR)) return unit(*given);
  if (const auto gloss = number(m, AI_MATKEY_GLOSSINESS_FACTOR)) return unit(1 - *gloss);
  const auto exponent = number(m, AI_MATKEY_SHININESS);
  const auto specular = color(m, AI_MATKEY_COLOR_SPECULAR);
  const bool shiny = specular && std::max({specular->r, specular->g, specular->b}) > 0;
  if (!exponent || !(*exponent > 0) || !shiny) return 1.0F;
  return unit(std::sqrt(std::sqrt(2.0F / (*exponent + 2.0F))));
}

json base_color(const aiMaterial& m, json& out) {
  aiColor4D rgba(1, 1, 1, 1);
  if (const auto base = color(m, AI_MATKEY_BASE_COLOR)) {
    rgba = aiColor4D(unit(base->r), unit(base->g), unit(base->b), unit(base->a));
  } else if (const auto diffuse = color(m, AI_MATKEY_COLOR_DIFFUSE)) {
    rgba = aiColor4D(linear(diffuse->r), linear(diffuse->g), linear(diffuse->b), 1);
  }
  if (const auto opacity = number(m, AI_MATKEY_OPACITY); opacity && *opacity < 1) rgba.a = unit(*opacity);
  aiString mode;
  if (m.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS && text(mode) == "MASK") {
    out["alphaMode"] = "MASK";
  } else if (rgba.a < 1) {
    out["alphaMode"] = "BLEND";
  }
  return {rgba.r, rgba.g, rgba.b, rgba.a};
}

void put_emission(Conversion& c, const aiMaterial& m, json& out) {
  const auto given = color(m, AI_MATKEY_COLOR_EMISSIVE);
  const float strength = number(m, AI_MATKEY_EMISSIVE_INTENSITY).value_or(1.0F);
  json image = texture(c, m, {aiTextureType_EMISSION_COLOR, aiTextureType_EMISSIVE});
  json factor = {1.0F, 1.0F, 1.0F};
  if (given) {
    factor = json::array();
    for (const float v : {given->r, given->g, given->b}) factor.push_back(linear(v * strength));
  }
  const bool dark = factor[0] == 0 && factor[1] == 0 && factor[2] == 0;
  if (!image.is_null()) out["emissiveTexture"] = std::move(image);
  if (!dark && (given || out.contains("emissiveTexture"))) out["emissiveFactor"] = factor;
}

void note_textures(Conversion& c, const aiMaterial& m) {
  constexpr std::pair<aiTextureType, const char*> kLeftOut[] = {
      {aiTextureType_SPECULAR, "specular textures"},
      {aiTextureType_HEIGHT, "height (bump) textures"},
      {aiTextureType_SHININESS, "shininess textures"},
      {aiTextureType_OPACITY, "opacity textures"},
      {aiTextureType_REFLECTION, "reflection textures"},
      {aiTextureType_METALNESS, "metalness textures"},
      {aiTextureType_DIFFUSE_ROUGHNESS, "roughness textures"},
      {aiTextureType_LIGHTMAP, "light maps"}};
  for (const auto& [type, what] : kLeftOut) {
    if (m.GetTextureCount(type) != 0) c.notes.add(what, m.GetTextureCount(type));
  }
}

}  // namespace

std::size_t convert_material(Conversion& c, unsigned index) {
  const aiMaterial& m = *c.scene.mMaterials[index];
  json out = json::object();
  aiString name;
  (void)m.Get(AI_MATKEY_NAME, name);
  out["name"] = name.length > 0 ? text(name) : "material_" + std::to_string(index);
  json pbr = {{"baseColorFactor", base_color(m, out)},
              {"metallicFactor", unit(number(m, AI_MATKEY_METALLIC_FACTOR).value_or(0.0F))},
              {"roughnessFactor", roughness(m)}};
  if (json image = texture(c, m, {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}); !image.is_null())
    pbr["baseColorTexture"] = std::move(image);
  out["pbrMetallicRoughness"] = std::move(pbr);
  if (json image = texture(c, m, {aiTextureType_NORMAL_CAMERA, aiTextureType_NORMALS}); !image.is_null())
    out["normalTexture"] = std::move(image);
  if (json image = texture(c, m, {aiTextureType_AMBIENT_OCCLUSION}); !image.is_null())
    out["occlusionTexture"] = std::move(image);
  put_emission(c, m, out);
  note_textures(c, m);
  int flag = 0;
  if (m.Get(AI_MATKEY_TWOSIDED, flag) == aiReturn_SUCCESS && flag != 0) out["doubleSided"] = true;
  return c.document.shared("materials", out);
}

}  // namespace scenegen::import
