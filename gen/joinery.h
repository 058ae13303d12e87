// What stands in the openings of outer walls: sill, frame and panes of a window; frame, leaf and step of a
// door.
#pragma once

#include "gen/wall.h"

namespace scenegen::gen {

/// Sizes that scale with the height of a floor, mm.
struct JoinerySizes {
  int bar_mm = 60;         ///< width of a frame's bar
  int depth_mm = 70;       ///< of the frame, across the wall
  int pane_mm = 12;        ///< thickness of the glass
  int sill_mm = 50;        ///< thickness
  int projection_mm = 40;  ///< of the sill before the wall
  int step_depth_mm = 350;
  int step_projection_mm = 40;  ///< the slab's projection: the step begins there
};

void fit_window(const Wall& wall, const Opening& opening, const JoinerySizes& sizes, LayoutSink& sink);
/// `step` is the step's bottom and top; empty: no step.
void fit_door(const Wall& wall, const Opening& opening, const JoinerySizes& sizes, Interval step,
              LayoutSink& sink);

}  // namespace scenegen::gen
