// What D 2.3's program does each frame: walk every object's curves from the first key on. Written apart from
// timeline/keys.cpp, in another way (GLM's slerp, std::lerp, de Casteljau), to be compared with.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "scene/scene.h"

namespace scenegen::timeline::test {

/// Index of the last key with time <= t; -1 if none.
inline int naive_segment(std::span<const float> times, double t) {
  int k = -1;
  while (k + 1 < static_cast<int>(times.size()) &&
         static_cast<double>(times[static_cast<std::size_t>(k + 1)]) <= t)
    ++k;
  return k;
}

inline glm::dvec4 naive_value(const Scene& scene, TrackId id, double t) {
  const Track& track = scene.tracks[id.value];
  const auto times = scene.times_s(id);
  const auto values = scene.values(id);
  const std::size_t w = width(track.property);
  const bool cubic = track.interpolation == Interpolation::cubic_spline;
  const auto read = [&](std::size_t key, std::size_t part) {
    glm::dvec4 v(0.0);
    for (std::size_t i = 0; i < w; ++i)
      v[static_cast<int>(i)] = values[(cubic ? key * 3 + part : key) * w + i];
    return v;
  };
  const int segment = naive_segment(times, t);
  const auto k = static_cast<std::size_t>(std::max(segment, 0));
  const bool ends = segment < 0 || k + 1 == times.size();
  if (ends || track.interpolation == Interpolation::step) return read(k, 1);
  const double length = static_cast<double>(times[k + 1]) - static_cast<double>(times[k]);
  const double u = (t - static_cast<double>(times[k])) / length;
  const bool rotation = track.property == Property::rotation;
  if (!cubic) {
    const glm::dvec4 a = read(k, 0);
    const glm::dvec4 b = read(k + 1, 0);
    if (!rotation) return glm::mix(a, b, u);
    const glm::dquat q = glm::slerp(glm::dquat(a.w, a.x, a.y, a.z), glm::dquat(b.w, b.x, b.y, b.z), u);
    return glm::normalize(glm::dvec4(q.x, q.y, q.z, q.w));
  }
  // Hermite as Bezier: control points a third of the tangents away, then de Casteljau.
  const glm::dvec4 p0 = read(k, 1);
  const glm::dvec4 p3 = read(k + 1, 1);
  const glm::dvec4 p1 = p0 + read(k, 2) * (length / 3);
  const glm::dvec4 p2 = p3 - read(k + 1, 0) * (length / 3);
  const glm::dvec4 q0 = glm::mix(p0, p1, u);
  const glm::dvec4 q1 = glm::mix(p1, p2, u);
  const glm::dvec4 q2 = glm::mix(p2, p3, u);
  const glm::dvec4 p = glm::mix(glm::mix(q0, q1, u), glm::mix(q1, q2, u), u);
  return rotation ? glm::normalize(p) : p;
}

struct NaiveState {
  std::vector<std::uint8_t> visible;
  std::vector<MeshId> mesh;
  std::vector<glm::dmat4> world_from_object;
  std::vector<glm::vec4> base_color;
  std::vector<glm::vec3> emissive;
};

inline glm::dmat4 naive_local(const Scene& scene, FrameId id, double t) {
  const Frame& f = scene.frames[id.value];
  if (f.has_matrix) return glm::dmat4(f.matrix);
  glm::dvec3 translation(f.local.translation_m);
  glm::dquat rotation(f.local.rotation);
  glm::dvec3 scale(f.local.scale);
  for (const FrameTrack& track : scene.frame_tracks) {
    if (track.frame != id) continue;
    const glm::dvec4 v = naive_value(scene, track.track, t);
    switch (scene.tracks[track.track.value].property) {
      case Property::translation:
        translation = glm::dvec3(v);
        break;
      case Property::rotation:
        rotation = glm::dquat(v.w, v.x, v.y, v.z);
        break;
      default:
        scale = glm::dvec3(v);
    }
  }
  glm::dmat4 m = glm::mat4_cast(rotation);
  for (int i = 0; i < 3; ++i) m[i] *= scale[i];
  m[3] = glm::dvec4(translation, 1.0);
  return m;
}

inline glm::dmat4 naive_world(const Scene& scene, FrameId id, double t) {
  if (!id.valid()) return glm::dmat4(1.0);
  return naive_world(scene, scene.frames[id.value].parent, t) * naive_local(scene, id, t);
}

inline NaiveState naive_state(const Scene& scene, double t) {
  NaiveState out;
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const TrackId track = scene.objects.visibility[o];
    out.visible.push_back(!track.valid() || naive_value(scene, track, t).x != 0.0);
    out.mesh.push_back(scene.objects.mesh[o]);
    out.world_from_object.push_back(naive_world(scene, scene.objects.frame[o], t) *
                                    glm::dmat4(scene.objects.frame_from_object[o].matrix()));
  }
  for (const ObjectMeshTrack& m : scene.object_mesh_tracks) {
    out.mesh[m.object.value] = MeshId(static_cast<std::uint64_t>(naive_value(scene, m.track, t).x));
  }
  for (const Material& m : scene.materials) {
    out.base_color.push_back(m.base_color);
    out.emissive.push_back(m.emissive);
  }
  for (const MaterialTrack& m : scene.material_tracks) {
    const glm::vec4 v(naive_value(scene, m.track, t));
    if (scene.tracks[m.track.value].property == Property::base_color) {
      out.base_color[m.material.value] = v;
    } else {
      out.emissive[m.material.value] = glm::vec3(v);
    }
  }
  return out;
}

}  // namespace scenegen::timeline::test
