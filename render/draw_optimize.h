// Geometry made cheaper to draw without changing a pixel: equal vertices are shared, so that each is shaded
// once.
#pragma once

#include <cstdint>

#include "render/draw_geometry.h"

namespace scenegen::render {

/// `free`: triangles may come in another order, in which what they share is still in the device's cache.
/// Where surfaces blend, the order is part of the picture.
enum class TriangleOrder : std::uint8_t { kept, free };

/// Vertices that are equal bit by bit become one, those that nothing uses go, and all stand in order of use.
/// Lines and points stay as they are. O(vertices + indices).
void share_vertices(DrawGeometry& geometry, TriangleOrder order);

/// What drawing a geometry once takes, as the model counts it.
struct DrawWork {
  std::uint32_t vertices = 0;  ///< that are shaded
  std::uint32_t triangles = 0;
  /// Of the pixels that its box covers, those that it covers itself, seen from anywhere: by Cauchy, a convex
  /// body's shadow is a quarter of its surface on average. Open surfaces count twice where they are not
  /// balanced by others that face the other way. At most 1; 1 for what is flat, lines and points.
  float covered_share = 1;
};
[[nodiscard]] DrawWork work_of(const DrawGeometry& geometry);

}  // namespace scenegen::render
