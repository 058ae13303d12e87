#include "gen/joinery.h"

#include <algorithm>

namespace scenegen::gen {
namespace {

/// The frame's outline, after the opening was made smaller by the sill.
struct Light {
  Interval u, z, frame_d, pane_d;
  int bar_mm = 0;
};

Light light_of(const Wall& wall, const Opening& opening, const JoinerySizes& sizes, int sill_mm) {
  Light light;
  light.u = opening.u;
  light.z = {wall.course_z(opening.first_course).lo_mm + sill_mm,
             wall.course_z(opening.end_course - 1).hi_mm};
  const int depth = std::clamp(sizes.depth_mm, 1, wall.thickness_mm);
  const int front = (wall.thickness_mm - depth) * 2 / 5;
  light.frame_d = {front, front + depth};
  const int pane = std::clamp(sizes.pane_mm, 1, depth);
  light.pane_d = {front + (depth - pane) / 2, front + (depth - pane) / 2 + pane};
  light.bar_mm =
      std::min({sizes.bar_mm, (light.u.hi_mm - light.u.lo_mm) / 6, (light.z.hi_mm - light.z.lo_mm) / 6});
  return light;
}

bool is_empty(Interval i) {
  return i.lo_mm >= i.hi_mm;
}

}  // namespace

void fit_window(const Wall& wall, const Opening& opening, const JoinerySizes& sizes, LayoutSink& sink) {
  const int height = wall.course_z(opening.end_course - 1).hi_mm - wall.course_z(opening.first_course).lo_mm;
  const int sill = std::min(sizes.sill_mm, height / 6);
  const Light light = light_of(wall, opening, sizes, sill);
  const WallPlace& at = wall.place;
  if (sill > 0) {
    sink.add(PartKind::sill, at.box(light.u, {-sizes.projection_mm, light.frame_d.hi_mm},
                                    {light.z.lo_mm - sill, light.z.lo_mm}));
  }
  const int bar = light.bar_mm;
  const Interval inner_u{light.u.lo_mm + bar, light.u.hi_mm - bar};
  const Interval inner_z{light.z.lo_mm + bar, light.z.hi_mm - bar};
  if (bar == 0) {  // too small for a frame: glass only
    sink.add(PartKind::pane, at.box(light.u, light.pane_d, light.z));
    return;
  }
  sink.add(PartKind::frame, at.box({light.u.lo_mm, inner_u.lo_mm}, light.frame_d, light.z));
  sink.add(PartKind::frame, at.box({inner_u.hi_mm, light.u.hi_mm}, light.frame_d, light.z));
  sink.add(PartKind::frame, at.box(inner_u, light.frame_d, {light.z.lo_mm, inner_z.lo_mm}));
  sink.add(PartKind::frame, at.box(inner_u, light.frame_d, {inner_z.hi_mm, light.z.hi_mm}));
  const int width = inner_u.hi_mm - inner_u.lo_mm;
  if (width >= 8 * bar) {  // a mullion in the middle
    const Interval mullion{inner_u.lo_mm + (width - bar) / 2, inner_u.lo_mm + (width - bar) / 2 + bar};
    sink.add(PartKind::frame, at.box(mullion, light.frame_d, inner_z));
    sink.add(PartKind::pane, at.box({inner_u.lo_mm, mullion.lo_mm}, light.pane_d, inner_z));
    sink.add(PartKind::pane, at.box({mullion.hi_mm, inner_u.hi_mm}, light.pane_d, inner_z));
  } else {
    sink.add(PartKind::pane, at.box(inner_u, light.pane_d, inner_z));
  }
}

void fit_door(const Wall& wall, const Opening& opening, const JoinerySizes& sizes, Interval step,
              LayoutSink& sink) {
  const Light light = light_of(wall, opening, sizes, 0);
  const WallPlace& at = wall.place;
  const int bar = light.bar_mm;
  const Interval inner_u{light.u.lo_mm + bar, light.u.hi_mm - bar};
  const Interval inner_z{light.z.lo_mm, light.z.hi_mm - bar};
  if (bar > 0) {
    sink.add(PartKind::frame, at.box({light.u.lo_mm, inner_u.lo_mm}, light.frame_d, light.z));
    sink.add(PartKind::frame, at.box({inner_u.hi_mm, light.u.hi_mm}, light.frame_d, light.z));
    sink.add(PartKind::frame, at.box(inner_u, light.frame_d, {inner_z.hi_mm, light.z.hi_mm}));
  }
  // A fanlight above the leaf where the door is high enough.
  const int leaf_top = inner_z.lo_mm + (inner_z.hi_mm - inner_z.lo_mm) * 4 / 5;
  const bool fanlight = bar > 0 && inner_z.hi_mm - leaf_top > 2 * bar;
  if (fanlight) {
    sink.add(PartKind::door, at.box(inner_u, light.frame_d, {inner_z.lo_mm, leaf_top}));
    sink.add(PartKind::frame, at.box(inner_u, light.frame_d, {leaf_top, leaf_top + bar}));
    sink.add(PartKind::pane, at.box(inner_u, light.pane_d, {leaf_top + bar, inner_z.hi_mm}));
  } else {
    sink.add(PartKind::door, at.box(inner_u, light.frame_d, inner_z));
  }
  if (is_empty(step) || sizes.step_depth_mm <= 0) return;
  const Interval step_d{-sizes.step_projection_mm - sizes.step_depth_mm, -sizes.step_projection_mm};
  sink.add(PartKind::step, at.box({light.u.lo_mm - 3 * bar, light.u.hi_mm + 3 * bar}, step_d, step));
}

}  // namespace scenegen::gen
