// Appearance times along a space-filling curve with a spatio-temporal coherence coefficient (D 3.4; METHODS
// 2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/scene.h"
#include "timeline/curves.h"

namespace scenegen::timeline {

struct AppearanceOptions {
  CurveKind curve = CurveKind::hilbert;
  AxisOrder order;
  glm::uvec3 cells{16, 16, 16};  ///< author's frame: x, y horizontal, z up
  double interval_s = 0.01;      ///< cell n (numbered from 1) appears at n * interval_s
  double hold_s = 1.0;           ///< after the last event
  double coherence = 1.0;        ///< C in [0, 1]
  std::uint64_t seed = 1;
  unsigned threads = 1;
};

/// Gives every object whose entry of `exempt` is 0 (empty span: every object) a visibility track; objects
/// with equal times share one track. Sets scene.duration_s and scene.info.appearance (with measured coherence
/// and locality), and scene.info.seed. Replaces visibility tracks that were there. Errors (usage): C outside
/// [0,1], C < 1 with one cell, times that are not strictly increasing as float32, too many cells.
[[nodiscard]] Result<AppearanceInfo> assign_appearance(Scene& scene, const AppearanceOptions& options,
                                                       std::span<const std::uint8_t> exempt = {});

/// Share of timed objects that start (first appear; under other profiles: ObjectStarts in track_table.h) at
/// the time of their own cell, computed from the scene's tracks and info.appearance alone. An error
/// (bad_input) when the tracks do not show that anything starts though objects were timed (profile move or
/// operate without a highlight).
[[nodiscard]] Result<double> measure_coherence(const Scene& scene, unsigned threads = 1);

/// Steps of info.appearance's curve on its own grid between cells that share no face: none for Hilbert's on a
/// cube of side 2^n, often some on a grid that crops it.
[[nodiscard]] Result<std::uint64_t> curve_jumps(const SceneInfo& info);

}  // namespace scenegen::timeline
