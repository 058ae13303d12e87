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

/// Without the name, which is not seen.
Material nameless(const Material& material) {
  Material out = material;
  out.name.clear();
  return out;
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
  const auto first = first_equals(
      scene.materials.size(),
      [&](std::uint32_t i) {
        const Material& m = scene.materials[i];
        ContentHash hash;
        hash.add_bytes(&m.base_color, sizeof m.base_color);
        hash.add_bytes(&m.emissive, sizeof m.emissive);
        hash.mix(m.base_color_texture.texture.value);
        hash.mix(tracks[i].base_color.value);
        hash.mix(tracks[i].emissive.value);
        return hash.value();
      },
      [&](std::uint32_t a, std::uint32_t b) {
        return tracks[a] == tracks[b] && nameless(scene.materials[a]) == nameless(scene.materials[b]);
      });
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
        hash.add(g.texcoords[0]);
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
