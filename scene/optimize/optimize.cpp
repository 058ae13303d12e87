#include "scene/optimize/optimize.h"

#include "scene/optimize/steps.h"

namespace scenegen {

namespace optimizing {

namespace {

template <class Mark>
void mark(std::vector<std::uint8_t>& used, const Mark& id) {
  if (id.valid()) used[id.value] = 1;
}

void prune_meshes(Scene& scene) {
  std::vector<std::uint8_t> used(scene.meshes.size(), 0);
  for (const MeshId mesh : scene.objects.mesh) mark(used, mesh);
  for (const ObjectMeshTrack& t : scene.object_mesh_tracks) {
    for (const float value : scene.values(t.track)) used[static_cast<std::size_t>(value)] = 1;
  }
  renumber_meshes(scene, keep_only(scene.meshes, used));
}

void prune_parts(Scene& scene) {
  std::vector<std::uint8_t> geometries(scene.geometries.size(), 0), materials(scene.materials.size(), 0);
  for (const Mesh& mesh : scene.meshes) {
    for (const Primitive& p : mesh.primitives) {
      mark(geometries, p.geometry);
      mark(materials, p.material);
    }
  }
  const auto moved_geometries = keep_only(scene.geometries, geometries);
  const auto moved_materials = keep_only(scene.materials, materials);
  for (Mesh& mesh : scene.meshes) {
    for (Primitive& p : mesh.primitives) {
      renumber(p.geometry, moved_geometries);
      renumber(p.material, moved_materials);
    }
  }
  std::erase_if(scene.material_tracks,
                [&](const MaterialTrack& t) { return materials[t.material.value] == 0; });
  for (MaterialTrack& t : scene.material_tracks) renumber(t.material, moved_materials);
}

template <class Visit>
void each_texture_use(Scene& scene, const Visit& visit) {
  for (Material& m : scene.materials) {
    for (TextureUse* use : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture,
                            &m.occlusion_texture, &m.emissive_texture})
      visit(*use);
  }
}

void prune_textures(Scene& scene) {
  std::vector<std::uint8_t> textures(scene.textures.size(), 0), images(scene.images.size(), 0);
  each_texture_use(scene, [&](const TextureUse& use) { mark(textures, use.texture); });
  const auto moved_textures = keep_only(scene.textures, textures);
  each_texture_use(scene, [&](TextureUse& use) { renumber(use.texture, moved_textures); });
  for (const Texture& texture : scene.textures) mark(images, texture.image);
  const auto moved_images = keep_only(scene.images, images);
  for (Texture& texture : scene.textures) renumber(texture.image, moved_images);
}

}  // namespace

void prune_content(Scene& scene) {
  prune_meshes(scene);
  prune_parts(scene);
  prune_textures(scene);
}

}  // namespace optimizing

ContentCounts count_content(const Scene& scene) {
  ContentCounts out;
  out.meshes = scene.meshes.size();
  out.geometries = scene.geometries.size();
  out.materials = scene.materials.size();
  out.textures = scene.textures.size();
  out.images = scene.images.size();
  out.frames = scene.frames.size();
  out.tracks = scene.tracks.size();
  for (const Track& track : scene.tracks) out.keys += track.key_count;
  return out;
}

OptimizeReport optimize(Scene& scene) {
  using namespace optimizing;
  OptimizeReport report;
  report.before = count_content(scene);
  simplify_tracks(scene, report);  // first: materials are equal only if their tracks are the same
  join_equal_content(scene, report);
  join_stretched_meshes(scene, report);
  leave_still_frames(scene, report);
  prune_content(scene);
  simplify_tracks(scene, report);  // again: looks may have become equal, materials may have gone
  prune_content(scene);
  report.after = count_content(scene);
  return report;
}

}  // namespace scenegen
