#include "tests/tools/at_end.h"

namespace scenegen::test {

namespace {

/// The last key's value; of a cubic spline the middle of in-tangent, value, out-tangent.
const float* last_value(const Scene& scene, TrackId id) {
  const Track& track = scene.tracks[id.value];
  const std::size_t w = width(track.property);
  const auto values = scene.values(id);
  return track.interpolation == Interpolation::cubic_spline ? &values[values.size() - 2 * w]
                                                            : &values[values.size() - w];
}

void put_frame_tracks(const Scene& from, Scene& out) {
  for (const FrameTrack& entry : from.frame_tracks) {
    Transform& local = out.frames[entry.frame.value].local;
    const float* const v = last_value(from, entry.track);
    switch (from.tracks[entry.track.value].property) {
      case Property::translation:
        local.translation_m = {v[0], v[1], v[2]};
        break;
      case Property::rotation:
        local.rotation = glm::quat(v[3], v[0], v[1], v[2]);
        break;
      default:
        local.scale = {v[0], v[1], v[2]};
    }
  }
}

}  // namespace

Scene at_end(const Scene& scene) {
  Scene out = scene;
  put_frame_tracks(scene, out);
  std::vector<MeshId> meshes = scene.objects.mesh;
  for (const ObjectMeshTrack& entry : scene.object_mesh_tracks)
    meshes[entry.object.value] = MeshId(static_cast<std::uint32_t>(*last_value(scene, entry.track)));
  for (const MaterialTrack& entry : scene.material_tracks) {
    const float* const v = last_value(scene, entry.track);
    Material& material = out.materials[entry.material.value];
    if (scene.tracks[entry.track.value].property == Property::base_color) {
      material.base_color = {v[0], v[1], v[2], v[3]};
    } else {
      material.emissive = {v[0], v[1], v[2]};
    }
  }
  out.objects = Objects();
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const TrackId track = scene.objects.visibility[i];
    if (track.valid() && *last_value(scene, track) == 0.0F) continue;
    (void)out.objects.add(scene.objects.names[i], meshes[i], scene.objects.frame_from_object[i],
                          scene.objects.frame[i]);
  }
  out.tracks.clear();
  out.track_times_s.clear();
  out.track_values.clear();
  out.frame_tracks.clear();
  out.object_mesh_tracks.clear();
  out.material_tracks.clear();
  out.duration_s = 0;
  return out;
}

}  // namespace scenegen::test
