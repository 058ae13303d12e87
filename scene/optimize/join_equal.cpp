#include <bit>
#include <utility>

#include "scene/optimize/equal.h"
#include "scene/optimize/steps.h"

namespace scenegen::optimizing {

namespace {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Drops all that are not the first of their kind and gives the new number of each old one.
template <class T>
std::vector<std::uint32_t> join(std::vector<T>& items, const std::vector<std::uint32_t>& first,
                                std::uint64_t& joined) {
  std::vector<std::uint8_t> keep(items.size(), 0);
  for (std::size_t i = 0; i < items.size(); ++i) keep[i] = first[i] == i ? 1 : 0;
  std::vector<std::uint32_t> moved = keep_only(items, keep);
  for (std::size_t i = 0; i < first.size(); ++i) {
    moved[i] = moved[first[i]];  // firsts stand before
    joined += keep[i] == 0 ? 1 : 0;
  }
  return moved;
}

void join_images(Scene& scene, OptimizeReport& report) {
  const auto first = first_equals(
      scene.images.size(),
      [&](std::uint32_t i) {
        ContentHash hash;
        hash.add(scene.images[i].bytes);
        return hash.value();
      },
      [&](std::uint32_t a, std::uint32_t b) {
        return scene.images[a].mime_type == scene.images[b].mime_type &&
               same_bits(scene.images[a].bytes, scene.images[b].bytes);
      });
  const auto moved = join(scene.images, first, report.equal_images);
  for (Texture& texture : scene.textures) renumber(texture.image, moved);
}

std::vector<TextureUse*> texture_uses(Material& m) {
  return {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture, &m.occlusion_texture,
          &m.emissive_texture};
}

void join_textures(Scene& scene, OptimizeReport& report) {
  const auto first = first_equals(
      scene.textures.size(), [&](std::uint32_t i) { return std::uint64_t{scene.textures[i].image.value}; },
      [&](std::uint32_t a, std::uint32_t b) { return scene.textures[a] == scene.textures[b]; });
  const auto moved = join(scene.textures, first, report.equal_textures);
  for (Material& material : scene.materials) {
    for (TextureUse* use : texture_uses(material)) renumber(use->texture, moved);
  }
}

/// Of all that a material compares but its name.
std::uint64_t hash_of(const Material& m) {
  ContentHash hash;
  const auto mix = [&](float value) { hash.mix(std::bit_cast<std::uint32_t>(value + 0.0F)); };  // -0 is 0
  const auto add = [&](const TextureUse& use) {
    hash.mix(use.texture.value);
    hash.mix(use.texcoord);
    for (const float v : {use.strength, use.uv_offset.x, use.uv_offset.y, use.uv_rotation_rad, use.uv_scale.x,
                          use.uv_scale.y})
      mix(v);
  };
  for (const float v : {m.base_color.x, m.base_color.y, m.base_color.z, m.base_color.w, m.metallic,
                        m.roughness, m.emissive.x, m.emissive.y, m.emissive.z, m.alpha_cutoff})
    mix(v);
  hash.mix(static_cast<std::uint64_t>(m.alpha_mode) << 2 | (m.double_sided ? 2U : 0U) | (m.unlit ? 1U : 0U));
  add(m.base_color_texture);
  add(m.metallic_roughness_texture);
  add(m.normal_texture);
  add(m.occlusion_texture);
  add(m.emissive_texture);
  return hash.value();
}

void join_materials(Scene& scene, OptimizeReport& report) {
  struct Tracks {
    TrackId base_color, emissive;
    bool operator==(const Tracks&) const = default;
  };
  std::vector<Tracks> tracks(scene.materials.size());
  for (const MaterialTrack& t : scene.material_tracks) {
    const bool base = scene.tracks[t.track.value].property == Property::base_color;
    (base ? tracks[t.material.value].base_color : tracks[t.material.value].emissive) = t.track;
  }
  std::vector<std::string> names;  // laid aside: they are not seen
  for (Material& m : scene.materials) names.push_back(std::exchange(m.name, {}));
  const auto first = first_equals(
      scene.materials.size(),
      [&](std::uint32_t i) {
        ContentHash hash;
        hash.mix(hash_of(scene.materials[i]));
        hash.mix(tracks[i].base_color.value);
        hash.mix(tracks[i].emissive.value);
        return hash.value();
      },
      [&](std::uint32_t a, std::uint32_t b) {
        return tracks[a] == tracks[b] && scene.materials[a] == scene.materials[b];
      });
  for (std::size_t i = 0; i < names.size(); ++i) scene.materials[i].name = std::move(names[i]);
  const auto moved = join(scene.materials, first, report.equal_materials);
  for (Mesh& mesh : scene.meshes) {
    for (Primitive& p : mesh.primitives) renumber(p.material, moved);
  }
  std::vector<MaterialTrack> kept;  // of the first of its kind only: nothing is driven twice
  for (MaterialTrack t : scene.material_tracks) {
    const bool is_first = first[t.material.value] == t.material.value;
    renumber(t.material, moved);
    if (is_first) kept.push_back(t);
  }
  scene.material_tracks = std::move(kept);
}

void join_geometries(Scene& scene, OptimizeReport& report) {
  const auto first = first_equals(
      scene.geometries.size(),
      [&](std::uint32_t i) {
        const Geometry& g = scene.geometries[i];
        ContentHash hash;
        hash.add(g.positions_m);
        hash.add(g.normals);
        hash.add(g.tangents);
        for (const auto& texcoords : g.texcoords) hash.add(texcoords);
        hash.add(g.colors);
        hash.add(g.indices);
        return hash.value();
      },
      [&](std::uint32_t a, std::uint32_t b) {
        const Geometry &x = scene.geometries[a], &y = scene.geometries[b];
        return x.topology == y.topology && same_bits(x.positions_m, y.positions_m) &&
               same_bits(x.normals, y.normals) && same_bits(x.tangents, y.tangents) &&
               same_bits(x.texcoords[0], y.texcoords[0]) && same_bits(x.texcoords[1], y.texcoords[1]) &&
               same_bits(x.colors, y.colors) && same_bits(x.indices, y.indices);
      });
  const auto moved = join(scene.geometries, first, report.equal_geometries);
  for (Mesh& mesh : scene.meshes) {
    for (Primitive& p : mesh.primitives) renumber(p.geometry, moved);
  }
}

void join_meshes(Scene& scene, OptimizeReport& report) {
  const auto first = first_equals(
      scene.meshes.size(),
      [&](std::uint32_t i) {
        ContentHash hash;
        for (const Primitive& p : scene.meshes[i].primitives)
          hash.mix(std::uint64_t{p.geometry.value} << 32 | p.material.value);
        return hash.value();
      },
      [&](std::uint32_t a, std::uint32_t b) {
        return scene.meshes[a].primitives == scene.meshes[b].primitives;
      });
  const auto moved = join(scene.meshes, first, report.equal_meshes);
  renumber_meshes(scene, moved);
}

}  // namespace

void renumber_meshes(Scene& scene, const std::vector<std::uint32_t>& to) {
  for (MeshId& mesh : scene.objects.mesh) renumber(mesh, to);
  std::vector<std::uint8_t> done(scene.tracks.size(), 0);
  for (const ObjectMeshTrack& use : scene.object_mesh_tracks) {
    if (done[use.track.value]++ != 0) continue;
    const Track& track = scene.tracks[use.track.value];
    for (std::uint64_t k = track.first_value; k < track.first_value + track.key_count; ++k)
      scene.track_values[k] = static_cast<float>(to[static_cast<std::size_t>(scene.track_values[k])]);
  }
}

void join_equal_content(Scene& scene, OptimizeReport& report) {
  join_images(scene, report);
  join_textures(scene, report);
  join_materials(scene, report);
  join_geometries(scene, report);
  join_meshes(scene, report);
}

}  // namespace scenegen::optimizing
