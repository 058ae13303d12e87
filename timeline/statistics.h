// What `scenegen inspect` prints: counts over a scene and its timeline.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "scene/scene.h"
#include "timeline/timeline.h"

namespace scenegen::timeline {

struct Statistics {
  std::uint64_t objects = 0, meshes = 0, geometries = 0, materials = 0, textures = 0, images = 0, cameras = 0,
                frames = 0;
  std::uint64_t vertices = 0;   ///< drawn vertices of all objects (a shared mesh counts once per object)
  std::uint64_t triangles = 0;  ///< likewise
  std::uint64_t unique_vertices = 0, unique_triangles = 0;
  ClassCounts classes;
  std::uint64_t tracks = 0, keys = 0;
  std::uint64_t moments = 0;  ///< distinct times at which some object's visibility changes
  std::uint64_t events = 0;   ///< visibility changes of all objects
  std::uint64_t least_events = 0, most_events = 0;  ///< per moment
  double mean_events = 0;
  double duration_s = 0;
  Box bounds_m;
  std::optional<double>
      coherence_measured;  ///< again, from the tracks; none without (usable) info.appearance
  std::optional<double> locality_cells;
  std::optional<std::uint64_t> jumps;  ///< curve_jumps(); none without (usable) info.appearance
};
[[nodiscard]] Statistics statistics(const Scene& scene, unsigned threads = 1);

}  // namespace scenegen::timeline
