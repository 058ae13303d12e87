// Roofs: gabled (crow-stepped brick gables, rows of tiles, ridge) and flat (parapet, coping, gravel).
#pragma once

#include "gen/plan.h"

namespace scenegen::gen {

/// A gabled roof's shape. Rows of tiles lap: row i lies at x in [i * exposure - overhang, …] and
/// z in [i * tile, (i + 1) * tile] of the slope's own axes (layout.h), so each rests on the one below and all
/// boxes of a slope are exact in those axes.
struct GableShape {
  int base_mm = 0;        ///< top of the slab under the roof
  int step_width_mm = 0;  ///< of the crow steps: whole bricks
  int step_courses = 0;
  int first_courses = 0;  ///< courses below the first step, besides step_courses
  int steps = 0;
  int exposure_mm = 0, lap_mm = 0, tile_mm = 0, overhang_mm = 0, tile_width_mm = 0;
  int beam_half_mm = 0;  ///< half width of the ridge beam
  double cosine = 1, sine = 0;
};
[[nodiscard]] GableShape gable_shape(const BuildingPlan& plan, int base_mm);

/// Everything above `base_mm` (the top of the last walls), its slab first.
void build_roof(const BuildingPlan& plan, int base_mm, LayoutSink& sink);

}  // namespace scenegen::gen
