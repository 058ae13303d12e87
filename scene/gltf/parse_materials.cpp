#include "scene/gltf/parse.h"

namespace scenegen::gltf::reading {

namespace {

void require_range(float value, float lo, float hi, const Place& at) {
  if (value >= lo && value <= hi) return;
  reject(at, std::to_string(value) + " is not in " + std::to_string(lo) + " ... " + std::to_string(hi));
}

float factor(Value& v, const Place& at) {
  const float out = get_float(v, at);
  require_range(out, 0.0F, 1.0F, at);
  return out;
}

void parse_transform(Value value, const Place& at, TextureUse& use) {
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "offset") {
      const auto f = get_floats<2>(v, p);
      use.uv_offset = {f[0], f[1]};
    } else if (key == "scale") {
      const auto f = get_floats<2>(v, p);
      use.uv_scale = {f[0], f[1]};
    } else if (key == "rotation") {
      use.uv_rotation_rad = get_float(v, p);
    } else if (key == "texCoord") {
      use.texcoord = get_index(v, p);
    }
  });
}

void parse_use(Value value, const Place& at, Document& out, TextureUse& use) {
  bool has_index = false;
  std::uint32_t base_texcoord = 0;
  std::uint32_t transform_texcoord = kNone;
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "index") {
      use.texture = TextureId(get_index(v, p));
      has_index = true;
    } else if (key == "texCoord") {
      base_texcoord = get_index(v, p);
    } else if (key == "scale") {
      use.strength = get_float(v, p);
    } else if (key == "strength") {
      use.strength = factor(v, p);
    } else if (key == "extensions") {
      each_field(v, p, [&](std::string_view name, Value& w, const Place& q) {
        if (name != "KHR_texture_transform") return ignore_extension(name, q, out);
        use.texcoord = kNone;
        parse_transform(w, q, use);
        transform_texcoord = use.texcoord;  // overrides the base one when it is there
      });
    }
  });
  if (!has_index) reject(at.key("index"), "missing");
  use.texcoord = transform_texcoord != kNone ? transform_texcoord : base_texcoord;
  if (use.texcoord > 1) {
    out.ignored.add(at.key("texCoord"), "textures on TEXCOORD_2 and above");
    use = TextureUse{};
  }
}

void parse_metallic_roughness(Value value, const Place& at, Document& out, Material& material) {
  each_field(value, at, [&](std::string_view key, Value& v, const Place& p) {
    if (key == "baseColorFactor") {
      const auto f = get_floats<4>(v, p);
      for (std::size_t i = 0; i < 4; ++i) require_range(f[i], 0.0F, 1.0F, p);
      material.base_color = {f[0], f[1], f[2], f[3]};
    } else if (key == "metallicFactor") {
      material.metallic = factor(v, p);
    } else if (key == "roughnessFactor") {
      material.roughness = factor(v, p);
    } else if (key == "baseColorTexture") {
      parse_use(v, p, out, material.base_color_texture);
    } else if (key == "metallicRoughnessTexture") {
      parse_use(v, p, out, material.metallic_roughness_texture);
    }
  });
}

AlphaMode parse_alpha_mode(Value& v, const Place& at) {
  const std::string_view mode = get_string(v, at);
  if (mode == "OPAQUE") return AlphaMode::opaque;
  if (mode == "MASK") return AlphaMode::mask;
  if (mode == "BLEND") return AlphaMode::blend;
  reject(at, "'" + printable(mode) + "' is none of OPAQUE MASK BLEND");
}

void parse_material_extensions(Value value, const Place& at, Document& out, float& strength) {
  each_field(value, at, [&](std::string_view name, Value& v, const Place& p) {
    if (name == "KHR_materials_unlit") {
      out.materials.back().unlit = true;
    } else if (name == "KHR_materials_emissive_strength") {
      each_field(v, p, [&](std::string_view key, Value& w, const Place& q) {
        if (key != "emissiveStrength") return;
        strength = get_float(w, q);
        if (!(strength >= 0.0F)) reject(q, "must not be negative");
      });
    } else {
      ignore_extension(name, p, out);
    }
  });
}

/// The light at rest of a material whose emissiveFactor is only there for the animation (docs/FORMAT.md 5).
void parse_material_extras(Value value, const Place& at, std::optional<glm::vec3>& emissive) {
  if (!is_object(value)) return;
  each_field(value, at, [&](std::string_view owner, Value& v, const Place& p) {
    if (owner != "scenegen" || !is_object(v)) return;
    each_field(v, p, [&](std::string_view key, Value& w, const Place& q) {
      if (key != "emissive") return;
      const auto f = get_floats<3>(w, q);
      if (f[0] < 0 || f[1] < 0 || f[2] < 0) reject(q, "must not be negative");
      emissive = glm::vec3(f[0], f[1], f[2]);
    });
  });
}

}  // namespace

void parse_materials(Value value, const Place& at, Document& out) {
  each_element(value, at, [&](Value& element, const Place& place) {
    Material& material = out.materials.emplace_back();
    float strength = 1.0F;
    std::optional<glm::vec3> emissive;
    each_field(element, place, [&](std::string_view key, Value& v, const Place& p) {
      if (key == "name") {
        material.name = get_string(v, p);
      } else if (key == "pbrMetallicRoughness") {
        parse_metallic_roughness(v, p, out, material);
      } else if (key == "normalTexture") {
        parse_use(v, p, out, material.normal_texture);
      } else if (key == "occlusionTexture") {
        parse_use(v, p, out, material.occlusion_texture);
      } else if (key == "emissiveTexture") {
        parse_use(v, p, out, material.emissive_texture);
      } else if (key == "emissiveFactor") {
        const auto f = get_floats<3>(v, p);
        for (std::size_t i = 0; i < 3; ++i) require_range(f[i], 0.0F, 1.0F, p);
        material.emissive = {f[0], f[1], f[2]};
      } else if (key == "alphaMode") {
        material.alpha_mode = parse_alpha_mode(v, p);
      } else if (key == "alphaCutoff") {
        material.alpha_cutoff = get_float(v, p);
        if (!(material.alpha_cutoff >= 0.0F)) reject(p, "must not be negative");
      } else if (key == "doubleSided") {
        material.double_sided = get_bool(v, p);
      } else if (key == "extensions") {
        parse_material_extensions(v, p, out, strength);
      } else if (key == "extras") {
        parse_material_extras(v, p, emissive);
      }
    });
    material.emissive *= strength;
    for (int i = 0; i < 3; ++i) {
      if (!std::isfinite(material.emissive[i]))
        reject(place.key("emissiveFactor"), "times emissiveStrength is not finite");
    }
    if (emissive) material.emissive = *emissive;
    out.emissive_strength.push_back(strength);
  });
}

}  // namespace scenegen::gltf::reading
