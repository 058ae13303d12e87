// Lists of slots to draw, and how they are made: pure processor code.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/draw_scene.h"
#include "render/spatial/frustum_cull.h"
#include "render/view.h"
#include "scene/held_bytes.h"

namespace scenegen::render {

/// Opaque and masked slots in slot order, and blended ones back to front. Reused from frame to frame, so that
/// nothing is allocated in steady state.
struct DrawList {
  std::vector<std::uint32_t> solid;
  std::vector<std::uint32_t> blended;
  std::uint64_t tested = 0;           ///< boxes tested against the frustum
  std::vector<std::uint64_t> inside;  ///< scratch: bits of slots

  [[nodiscard]] std::uint64_t memory_bytes() const { return held_bytes(solid, blended, inside); }
  void clear() {
    solid.clear();
    blended.clear();
    tested = 0;
  }
};

/// Everything that is visible by timeline.
void list_visible(const DrawScene& scene, DrawList& out);
/// What of it touches the frustum; never misses anything (boxes and planes carry slack for rounding).
void list_in_frustum(const DrawScene& scene, const CullPlanes& planes, DrawList& out);
/// Only the blended part of what touches the frustum.
void list_blended_in_frustum(const DrawScene& scene, const CullPlanes& planes, DrawList& out);
/// Adds solid slots given as bits, in slot order.
void list_solid(const DrawScene& scene, std::span<const std::uint64_t> slots, DrawList& out);
/// Farthest first along the view direction, by the boxes' centres; ties by object, then slot.
void sort_back_to_front(const DrawScene& scene, const View& view, std::vector<std::uint32_t>& slots);

}  // namespace scenegen::render
