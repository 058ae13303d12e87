#include "timeline/profile_looks.h"

#include <algorithm>
#include <string>

namespace scenegen::timeline {
namespace {

constexpr std::size_t kMostMeshes = 1U << 24;  // a track names meshes by float32

std::string_view look_name(std::uint8_t look) {
  return name(static_cast<Profile>(look));
}

/// What a highlight of its own kind takes from the material below.
bool same_highlight(const Material& a, const Material& b) {
  return a.base_color == b.base_color && a.double_sided == b.double_sided && a.unlit == b.unlit &&
         a.alpha_mode == b.alpha_mode && a.alpha_cutoff == b.alpha_cutoff &&
         a.base_color_texture == b.base_color_texture;
}

}  // namespace

ProfileLooks::ProfileLooks(Scene& scene, const ProfileOptions& options)
    : scene_(scene),
      options_(options),
      has_mesh_track_(scene.objects.size()),
      emissive_track_(scene.materials.size()),
      has_color_track_(scene.materials.size()) {
  for (const ObjectMeshTrack& use : scene.object_mesh_tracks) has_mesh_track_[use.object.value] = true;
  for (const MaterialTrack& use : scene.material_tracks) {
    const bool is_color = scene.tracks[use.track.value].property == Property::base_color;
    if (is_color) has_color_track_[use.material.value] = true;
    if (!is_color) emissive_track_[use.material.value] = use.track;
  }
  result_.first_new_material = scene.materials.size();
}

Result<void> ProfileLooks::check(ObjectId object) const {
  if (has_mesh_track_[object.value]) {
    return fail(ErrorKind::bad_input, "",
                "changes its look already (a material timeline by swapped meshes) and cannot be highlighted");
  }
  if (options_.color == ColorForm::swap) {
    if (scene_.meshes.size() <= kMostMeshes / (kProfileCount + 1)) return {};
    return fail(ErrorKind::bad_input, "",
                "cannot be highlighted by swapped meshes: the scene has " +
                    std::to_string(scene_.meshes.size()) + " meshes, at most " +
                    std::to_string(kMostMeshes / (kProfileCount + 1)));
  }
  for (const Primitive& primitive : scene_.meshes[scene_.objects.mesh[object.value].value].primitives) {
    if (!primitive.material.valid() || !has_color_track_[primitive.material.value]) continue;
    return fail(ErrorKind::bad_input, "",
                "cannot be highlighted by its material: the color of '" +
                    scene_.materials[primitive.material.value].name + "' is animated already");
  }
  return {};
}

void ProfileLooks::begin(TrackSharing& tracks) {
  tracks_ = &tracks;
}

void ProfileLooks::give(ObjectId object, std::uint32_t timeline, std::span<const LookKey> keys) {
  const MeshId own = scene_.objects.mesh[object.value];
  const std::uint64_t key = (std::uint64_t{timeline} << 32) | own.value;
  const auto [known, fresh] = given_.try_emplace(key);
  if (options_.color == ColorForm::swap && keys.size() == 1) {
    scene_.objects.mesh[object.value] = swapped_mesh(own, keys.front().look);  // never seen otherwise
  } else if (options_.color == ColorForm::swap) {
    if (fresh) known->second = mesh_track(own, keys).value;
    scene_.object_mesh_tracks.push_back({object, TrackId(known->second)});
  } else {
    if (fresh) known->second = animated_mesh(own, keys).value;
    scene_.objects.mesh[object.value] = MeshId(known->second);
  }
}

ProfileResult ProfileLooks::result() && {
  result_.copy_of.resize(scene_.materials.size() - result_.first_new_material);
  return std::move(result_);
}

// ---- swap

Material ProfileLooks::highlight_material(MaterialId own, std::uint8_t look) const {
  const Material below = own.valid() ? scene_.materials[own.value] : Material();
  Material m;
  m.name = "highlight_" + std::string(look_name(look));
  m.base_color = color(look);
  m.metallic = 0.0F;
  m.roughness = 0.7F;
  m.double_sided = below.double_sided;
  m.unlit = below.unlit;
  m.alpha_mode = below.alpha_mode;
  switch (below.alpha_mode) {
    case AlphaMode::opaque:
      if (m.base_color.w < 1.0F) m.alpha_mode = AlphaMode::blend;
      break;
    case AlphaMode::mask:  // cut out by its texture, as it was
      m.alpha_cutoff = below.alpha_cutoff;
      m.base_color_texture = below.base_color_texture;
      m.base_color.w *= below.base_color.w;
      break;
    case AlphaMode::blend:
      m.base_color.w *= below.base_color.w;
      break;
  }
  return m;
}

MaterialId ProfileLooks::shared_material(Material material, std::uint8_t look) {
  for (const auto& [of, id] : highlights_) {
    if (of == look && same_highlight(scene_.materials[id.value], material)) return id;
  }
  scene_.materials.push_back(std::move(material));
  highlights_.emplace_back(look, MaterialId(scene_.materials.size() - 1));
  return highlights_.back().second;
}

MeshId ProfileLooks::swapped_mesh(MeshId own, std::uint8_t look) {
  if (look == kOwnLook) return own;
  const auto [known, fresh] = swapped_.try_emplace({own, look});
  if (!fresh) return known->second;
  Mesh mesh = scene_.meshes[own.value];
  mesh.name += "_" + std::string(look_name(look));
  for (Primitive& primitive : mesh.primitives)
    primitive.material = shared_material(highlight_material(primitive.material, look), look);
  scene_.meshes.push_back(std::move(mesh));
  known->second = MeshId(scene_.meshes.size() - 1);
  return known->second;
}

TrackId ProfileLooks::mesh_track(MeshId own, std::span<const LookKey> keys) {
  std::vector<float> times_s, values;
  for (const LookKey& key : keys) {
    times_s.push_back(key.time_s);
    values.push_back(static_cast<float>(swapped_mesh(own, key.look).value));
  }
  return tracks_->add(Property::mesh, Interpolation::step, times_s, values);
}

// ---- pointer

MaterialId ProfileLooks::animated_material(MaterialId own, std::span<const LookKey> keys) {
  Material copy = own.valid() ? scene_.materials[own.value] : Material();
  std::vector<float> times_s, values;
  for (const LookKey& key : keys) {
    times_s.push_back(key.time_s);
    glm::vec4 c = copy.base_color;
    if (key.look != kOwnLook)
      c = glm::vec4(glm::vec3(color(key.look)), color(key.look).w * copy.base_color.w);
    for (int i = 0; i < 4; ++i) values.push_back(c[i]);
  }
  const TrackId track = tracks_->add(Property::base_color, Interpolation::step, times_s, values);
  const auto [known, fresh] = animated_.try_emplace({own, track});
  if (!fresh) return known->second;
  const MaterialId id(scene_.materials.size());
  copy.name += "_" + std::to_string(result_.copy_of.size());
  const bool sheer = std::any_of(keys.begin(), keys.end(), [&](const LookKey& key) {
    return key.look != kOwnLook && color(key.look).w < 1.0F;
  });
  if (sheer && copy.alpha_mode == AlphaMode::opaque) copy.alpha_mode = AlphaMode::blend;
  scene_.materials.push_back(std::move(copy));
  result_.copy_of.push_back(own);
  scene_.material_tracks.push_back({id, track});
  if (own.valid() && emissive_track_[own.value].valid())
    scene_.material_tracks.push_back({id, emissive_track_[own.value]});
  known->second = id;
  return id;
}

MeshId ProfileLooks::animated_mesh(MeshId own, std::span<const LookKey> keys) {
  Mesh mesh = scene_.meshes[own.value];
  std::vector<MaterialId> materials;
  for (Primitive& primitive : mesh.primitives) {
    primitive.material = animated_material(primitive.material, keys);
    materials.push_back(primitive.material);
  }
  const auto [known, fresh] = recolored_.try_emplace({own, std::move(materials)});
  if (!fresh) return known->second;
  mesh.name += "_" + std::to_string(recolored_.size() - 1);
  scene_.meshes.push_back(std::move(mesh));
  known->second = MeshId(scene_.meshes.size() - 1);
  return known->second;
}

}  // namespace scenegen::timeline
