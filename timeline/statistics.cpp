#include "timeline/statistics.h"

#include <algorithm>

#include "timeline/appearance.h"

namespace scenegen::timeline {

Statistics statistics(const Scene& scene, unsigned threads) {
  Statistics out;
  out.objects = scene.objects.size();
  out.meshes = scene.meshes.size();
  out.geometries = scene.geometries.size();
  out.materials = scene.materials.size();
  out.textures = scene.textures.size();
  out.images = scene.images.size();
  out.cameras = scene.cameras.size();
  out.frames = scene.frames.size();
  out.tracks = scene.tracks.size();
  for (const Track& track : scene.tracks) out.keys += track.key_count;
  out.duration_s = scene.duration_s;

  for (const Geometry& g : scene.geometries) {
    out.unique_vertices += g.vertex_count();
    out.unique_triangles += g.triangle_count();
  }
  struct Drawn {
    std::uint64_t vertices = 0, triangles = 0;
  };
  std::vector<Drawn> of_mesh(scene.meshes.size());
  for (std::size_t i = 0; i < of_mesh.size(); ++i) {
    for (const Primitive& p : scene.meshes[i].primitives) {
      of_mesh[i].vertices += scene.geometries[p.geometry.value].drawn_vertex_count();
      of_mesh[i].triangles += scene.geometries[p.geometry.value].triangle_count();
    }
  }
  for (const MeshId mesh : scene.objects.mesh) {
    out.vertices += of_mesh[mesh.value].vertices;
    out.triangles += of_mesh[mesh.value].triangles;
  }
  for (const Box& box : object_bounds(scene, threads)) out.bounds_m.add(box);

  const std::shared_ptr<const Timeline> timeline = compile(scene);
  out.classes = timeline->class_counts();
  const std::span<const std::uint64_t> changes = timeline->visibility_changes();
  out.moments = changes.size();
  for (const std::uint64_t count : changes) {
    out.events += count;
    out.most_events = std::max(out.most_events, count);
    out.least_events = out.least_events == 0 ? count : std::min(out.least_events, count);
  }
  if (out.moments > 0) out.mean_events = static_cast<double>(out.events) / static_cast<double>(out.moments);
  if (scene.info.appearance) {
    out.locality_cells = scene.info.appearance->locality_cells;
    if (const Result<std::uint64_t> jumps = curve_jumps(scene.info)) out.jumps = *jumps;
    if (const Result<double> measured = measure_coherence(scene, threads)) out.coherence_measured = *measured;
  }
  return out;
}

}  // namespace scenegen::timeline
