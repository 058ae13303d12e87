// Are two scenes the same thing to see, at every time?
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace scenegen::timeline {

struct CompareOptions {
  float transform_tolerance = 1e-5F;  ///< relative to the size of the scene
  float color_tolerance = 1e-5F;
  /// Geometry is the same bits, unless one of these is above 0: then it is the same triangles in any order.
  float geometry_tolerance = 0;  ///< of positions and texture coordinates, relative to their extent in a mesh
  float normal_tolerance = 0;    ///< of each component of normals, tangents and vertex colors
  std::size_t most = 20;         ///< differences listed
};

struct Difference {
  std::string where;  ///< "building_00_01/floor_2/brick_0017 at 3.25 s"
  std::string what;   ///< "visible in A, hidden in B"
};

struct Comparison {
  std::vector<Difference> differences;  ///< at most `most`
  std::uint64_t difference_count = 0;
  std::uint64_t times_compared = 0;
  [[nodiscard]] bool equal() const { return difference_count == 0; }
};

/// Compares objects (matched by name), geometry and materials by content, cameras, and the state at every
/// event time of either scene, just before it, and between keys. Order of arrays, sharing and layout do not
/// matter, nor whether an object's size is in its mesh or in its scale.
[[nodiscard]] Comparison compare(const Scene& a, const Scene& b, const CompareOptions& options = {});

}  // namespace scenegen::timeline
