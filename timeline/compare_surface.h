// Comparing geometry as the triangles that are seen, within a tolerance.
#pragma once

#include <string>

#include "scene/scene.h"
#include "timeline/compare.h"

namespace scenegen::timeline {

/// Empty if every triangle of either has one in the other within the tolerances; order of triangles and
/// vertices, their sharing, and triangles that have no area (within the tolerance) do not matter. Geometries
/// that are no triangles differ unless they are the same bits.
[[nodiscard]] std::string surface_difference(const Geometry& a, const Geometry& b,
                                             const CompareOptions& options);

}  // namespace scenegen::timeline
