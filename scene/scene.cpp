#include "scene/scene.h"

#include <cassert>

#include "scene/parallel.h"

namespace scenegen {

std::size_t Geometry::triangle_count() const {
  const std::size_t n = drawn_vertex_count();
  switch (topology) {
    case Topology::triangles:
      return n / 3;
    case Topology::triangle_strip:
    case Topology::triangle_fan:
      return n < 3 ? 0 : n - 2;
    default:
      return 0;
  }
}

Box Geometry::bounds() const {
  Box b;
  for (const glm::vec3& p : positions_m) b.add(p);
  return b;
}

std::uint32_t width(Property property) {
  switch (property) {
    case Property::visibility:
    case Property::mesh:
      return 1;
    case Property::translation:
    case Property::scale:
    case Property::emissive:
      return 3;
    case Property::rotation:
    case Property::base_color:
      return 4;
  }
  return 0;
}

void Objects::reserve(std::size_t count, std::size_t name_bytes) {
  frame_from_object.reserve(count);
  frame.reserve(count);
  mesh.reserve(count);
  visibility.reserve(count);
  names.reserve(count, name_bytes);
}

ObjectId Objects::add(std::string_view name, MeshId mesh_id, const Transform& transform, FrameId frame_id) {
  frame_from_object.push_back(transform);
  frame.push_back(frame_id);
  mesh.push_back(mesh_id);
  visibility.emplace_back();
  names.push_back(name);
  return ObjectId(mesh.size() - 1);
}

namespace {
std::size_t values_per_key(const Track& track) {
  return width(track.property) * (track.interpolation == Interpolation::cubic_spline ? 3U : 1U);
}
}  // namespace

std::span<const float> Scene::times_s(TrackId id) const {
  const Track& track = tracks[id.value];
  return std::span(track_times_s).subspan(track.first_time, track.key_count);
}

std::span<const float> Scene::values(TrackId id) const {
  const Track& track = tracks[id.value];
  return std::span(track_values).subspan(track.first_value, track.key_count * values_per_key(track));
}

TrackId Scene::add_track(Property property, Interpolation interpolation, std::span<const float> times,
                         std::span<const float> values) {
  Track track{property, interpolation, static_cast<std::uint32_t>(times.size()), track_times_s.size(),
              track_values.size()};
  assert(values.size() == times.size() * values_per_key(track));
  track_times_s.insert(track_times_s.end(), times.begin(), times.end());
  track_values.insert(track_values.end(), values.begin(), values.end());
  tracks.push_back(track);
  return TrackId(tracks.size() - 1);
}

std::vector<glm::mat4> rest_frame_matrices(const Scene& scene) {
  std::vector<glm::mat4> world_from_frame;
  world_from_frame.reserve(scene.frames.size());
  for (const Frame& frame : scene.frames) {
    const glm::mat4 local = frame.has_matrix ? frame.matrix : frame.local.matrix();
    world_from_frame.push_back(frame.parent.valid() ? world_from_frame[frame.parent.value] * local : local);
  }
  return world_from_frame;
}

glm::mat4 rest_world_from_object(const Scene& scene, std::span<const glm::mat4> frames, ObjectId id) {
  const glm::mat4 local = scene.objects.frame_from_object[id.value].matrix();
  const FrameId frame = scene.objects.frame[id.value];
  return frame.valid() ? frames[frame.value] * local : local;
}

std::vector<Box> mesh_bounds(const Scene& scene) {
  std::vector<Box> of_geometry;
  of_geometry.reserve(scene.geometries.size());
  for (const Geometry& geometry : scene.geometries) of_geometry.push_back(geometry.bounds());
  std::vector<Box> of_mesh(scene.meshes.size());
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    for (const Primitive& primitive : scene.meshes[i].primitives)
      of_mesh[i].add(of_geometry[primitive.geometry.value]);
  }
  return of_mesh;
}

std::vector<Box> object_bounds(const Scene& scene, unsigned threads) {
  const std::vector<Box> of_mesh = mesh_bounds(scene);
  const std::vector<glm::mat4> frames = rest_frame_matrices(scene);
  std::vector<Box> out(scene.objects.size());
  parallel_for(out.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      out[i] = transformed(of_mesh[scene.objects.mesh[i].value],
                           rest_world_from_object(scene, frames, ObjectId(i)));
    }
  });
  return out;
}

}  // namespace scenegen
