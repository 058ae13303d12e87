#include "gen/roof.h"

#include <algorithm>
#include <cmath>

#include "gen/storey.h"

namespace scenegen::gen {
namespace {

constexpr double kSteepness = 0.9;  ///< rise over run that is aimed at: 42 degrees

int courses_up(int height_mm, int course_mm) {
  return (height_mm + course_mm - 1) / course_mm;
}

/// Slab or coping laid along a wall's top in stones about `stone_mm` long.
void lay_coping(const WallPlace& place, Interval u, Interval d, Interval z, LayoutSink& sink) {
  sink.add(PartKind::coping, place.box(u, d, z));
}

/// Window in the middle of a gable where the courses round it are wide enough.
void add_attic_window(const BuildingPlan& plan, Wall& wall) {
  const int half = plan.half_brick_mm();
  if (plan.window_width_mm == 0) return;
  const int first = std::max(1, courses_up(plan.scaled_mm(700), plan.brick_mm.z));
  const int end = first + std::min(plan.window_courses, courses_up(plan.scaled_mm(900), plan.brick_mm.z));
  if (end >= static_cast<int>(wall.courses.size())) return;
  const int lo = (plan.size_mm.x - plan.window_width_mm) / 2 / half * half;
  const Interval u{lo, lo + plan.window_width_mm};
  const Interval narrowest = wall.courses[static_cast<std::size_t>(end)].u;
  if (narrowest.lo_mm > u.lo_mm - plan.brick_mm.x || narrowest.hi_mm < u.hi_mm + plan.brick_mm.x) return;
  wall.openings.push_back({OpeningKind::window, u, first, end});
}

/// Brick gable with a coping stone on every step; the back one ends in a chimney.
void build_gable(const BuildingPlan& plan, const GableShape& shape, const WallPlace& place,
                 LayoutSink& sink) {
  Wall wall;
  wall.place = place;
  wall.thickness_mm = plan.wall_mm();
  wall.brick_length_mm = plan.brick_mm.x;
  wall.course_height_mm = plan.brick_mm.z;
  wall.bottom_mm = shape.base_mm;
  wall.bearing_mm = plan.half_brick_mm();
  const int stone = plan.scaled_mm(60);
  const int out = plan.projection_mm;
  const Interval across{-out, plan.wall_mm() + out};
  int course = 0;
  for (int step = 0; step < shape.steps; ++step) {
    const Interval u{step * shape.step_width_mm, plan.size_mm.x - step * shape.step_width_mm};
    const bool last = step + 1 == shape.steps;
    int count = shape.step_courses + (step == 0 ? shape.first_courses : 0);
    if (last && !place.inwards_up) count += courses_up(plan.scaled_mm(700), plan.brick_mm.z);  // the chimney
    for (int i = 0; i < count; ++i, ++course)
      wall.courses.push_back({u, (course % 2) * plan.half_brick_mm()});
    const int top = shape.base_mm + course * plan.brick_mm.z;
    const Interval z{top, top + stone};
    if (last) {
      lay_coping(place, {u.lo_mm - out, u.hi_mm + out}, across, z, sink);
    } else {
      const Interval left{u.lo_mm - out, u.lo_mm + shape.step_width_mm};
      const Interval right{u.hi_mm - shape.step_width_mm, u.hi_mm + out};
      lay_coping(place, left, across, z, sink);
      lay_coping(place, right, across, z, sink);
    }
  }
  wall.top_mm = shape.base_mm + course * plan.brick_mm.z;
  add_attic_window(plan, wall);
  build_wall(wall, sink);
  for (const Opening& opening : wall.openings) fit_window(wall, opening, joinery_sizes(plan), sink);
}

/// The side walls' last course, which the slopes rest on.
void build_kneel(const BuildingPlan& plan, const GableShape& shape, LayoutSink& sink) {
  std::array<Wall, 4> walls = ring_walls(plan, {{0, 0}, plan.size_mm, shape.base_mm, 1});
  build_wall(walls[kLeft], sink);
  build_wall(walls[kRight], sink);
}

/// Rows of tiles of both slopes, from the eaves to the ridge beam.
int build_slopes(const BuildingPlan& plan, const GableShape& shape, LayoutSink& sink) {
  const int eaves_mm = shape.base_mm + plan.brick_mm.z;
  sink.layout().slopes[0] = {{0, 0, eaves_mm}, shape.cosine, shape.sine};
  sink.layout().slopes[1] = {{plan.size_mm.x, 0, eaves_mm}, shape.cosine, shape.sine};
  const Interval along{plan.wall_mm(), plan.size_mm.y - plan.wall_mm()};
  const double end_x = plan.size_mm.x / 2.0 - shape.beam_half_mm;
  std::vector<Interval> tiles;
  double highest = 0;
  for (int row = 0; !sink.overflowed(); ++row) {
    const int lo = row * shape.exposure_mm - shape.overhang_mm;
    const int z_lo = row * shape.tile_mm;
    // The underside's upper corner is the innermost: x = v cos - w sin.
    const int most = static_cast<int>(std::floor((end_x + z_lo * shape.sine) / shape.cosine));
    const int hi = std::min(lo + shape.exposure_mm + shape.lap_mm, most);
    if (hi - lo < std::max(1, shape.exposure_mm / 8)) break;
    tiles.clear();
    lay_course(along, along.lo_mm + (row % 2) * shape.tile_width_mm / 2, shape.tile_width_mm, tiles);
    const Interval z{z_lo, z_lo + shape.tile_mm};
    for (const Interval& t : tiles) {
      sink.add(PartKind::tile, {{lo, t.lo_mm, z.lo_mm}, {hi, t.hi_mm, z.hi_mm}}, PartFrame::left_slope);
    }
    for (const Interval& t : tiles) {
      sink.add(PartKind::tile, {{-hi, t.lo_mm, z.lo_mm}, {-lo, t.hi_mm, z.hi_mm}}, PartFrame::right_slope);
    }
    highest = std::max(highest, hi * shape.sine + z.hi_mm * shape.cosine);
  }
  return eaves_mm + static_cast<int>(std::ceil(highest));
}

/// A beam between the slopes, and ridge tiles on it above every tile.
void build_ridge(const BuildingPlan& plan, const GableShape& shape, int tiles_top_mm, LayoutSink& sink) {
  const Interval along{plan.wall_mm(), plan.size_mm.y - plan.wall_mm()};
  const int middle = plan.size_mm.x / 2;
  const int beam = shape.beam_half_mm;
  const int depth = plan.scaled_mm(150);
  sink.add(PartKind::ridge,
           {{middle - beam, along.lo_mm, tiles_top_mm - depth}, {middle + beam, along.hi_mm, tiles_top_mm}});
  std::vector<Interval> caps;
  lay_course(along, along.lo_mm, shape.tile_width_mm, caps);
  const int half = beam + plan.scaled_mm(60);
  const int thick = plan.scaled_mm(50);
  for (const Interval& c : caps) {
    sink.add(PartKind::ridge,
             {{middle - half, c.lo_mm, tiles_top_mm}, {middle + half, c.hi_mm, tiles_top_mm + thick}});
  }
}

void build_gabled(const BuildingPlan& plan, int base_mm, LayoutSink& sink) {
  const GableShape shape = gable_shape(plan, base_mm);
  build_gable(plan, shape, {false, 0, true}, sink);
  build_gable(plan, shape, {false, plan.size_mm.y, false}, sink);
  build_kneel(plan, shape, sink);
  const int tiles_top = build_slopes(plan, shape, sink);
  build_ridge(plan, shape, tiles_top, sink);
}

/// Walls of bricks in a ring with a coping on top; returns the top.
int build_parapet(const BuildingPlan& plan, const Ring& ring, LayoutSink& sink) {
  for (const Wall& wall : ring_walls(plan, ring)) build_wall(wall, sink);
  const int top = ring.bottom_mm + ring.courses * plan.brick_mm.z;
  const int out = plan.projection_mm;
  const int in = plan.wall_mm() + std::min(out, plan.wall_mm() / 4);
  const Interval z{top, top + plan.scaled_mm(60)};
  const Interval all_x{ring.lo_mm.x - out, ring.hi_mm.x + out};
  const Interval between_y{ring.lo_mm.y + in, ring.hi_mm.y - in};
  lay_coping({false, ring.lo_mm.y, true}, all_x, {-out, in}, z, sink);
  lay_coping({false, ring.hi_mm.y, false}, all_x, {-out, in}, z, sink);
  lay_coping({true, ring.lo_mm.x, true}, between_y, {-out, in}, z, sink);
  lay_coping({true, ring.hi_mm.x, false}, between_y, {-out, in}, z, sink);
  return z.hi_mm;
}

/// Parapet, gravel, and the stair's brick hut where there is room for one.
void build_flat(const BuildingPlan& plan, int base_mm, LayoutSink& sink) {
  const int parapet = std::max(2, courses_up(plan.scaled_mm(500), plan.brick_mm.z));
  build_parapet(plan, {{0, 0}, plan.size_mm, base_mm, parapet}, sink);
  const int wall = plan.wall_mm();
  const int gravel = std::min(plan.scaled_mm(60), plan.brick_mm.z);
  const glm::ivec2 lo(wall), hi = plan.size_mm - wall;
  sink.add(PartKind::gravel, {{lo.x, lo.y, base_mm}, {hi.x, hi.y, base_mm + gravel}});
  const int brick = plan.brick_mm.x;
  const glm::ivec2 inner = hi - lo;
  const int side = std::max(plan.scaled_mm(2000), 3 * brick) / brick * brick;
  if (inner.x < side * 2 || inner.y < side * 2) return;
  Ring hut;
  hut.lo_mm = lo + (inner - side) / 2 / brick * brick;
  hut.hi_mm = hut.lo_mm + side;
  hut.bottom_mm = base_mm + gravel;
  hut.courses = std::max(2, courses_up(plan.scaled_mm(2000), plan.brick_mm.z));
  for (const Wall& w : ring_walls(plan, hut)) build_wall(w, sink);
  const int top = hut.bottom_mm + hut.courses * plan.brick_mm.z;
  const int out = plan.projection_mm;
  sink.add(PartKind::slab, {{hut.lo_mm.x - out, hut.lo_mm.y - out, top},
                            {hut.hi_mm.x + out, hut.hi_mm.y + out, top + plan.slab_mm / 2 + 1}});
}

}  // namespace

GableShape gable_shape(const BuildingPlan& plan, int base_mm) {
  GableShape shape;
  shape.base_mm = base_mm;
  const int brick = plan.brick_mm.x;
  const int course = plan.brick_mm.z;
  shape.step_width_mm =
      std::max(1, static_cast<int>(std::lround(plan.scaled_mm(500) / static_cast<double>(brick)))) * brick;
  shape.step_courses = std::max(1, static_cast<int>(std::lround(kSteepness * shape.step_width_mm / course)));
  shape.steps = (plan.size_mm.x / 2 + shape.step_width_mm - 1) / shape.step_width_mm;
  shape.exposure_mm = plan.scaled_mm(340);
  shape.lap_mm = shape.exposure_mm / 8;
  shape.tile_mm = plan.scaled_mm(35);
  shape.tile_width_mm = plan.scaled_mm(420);
  shape.beam_half_mm = std::min(plan.scaled_mm(90), plan.size_mm.x / 8);

  // The steps climb by `rise`; a tile is flatter than the roof by the angle of its lap.
  const double rise = static_cast<double>(shape.step_courses) * course / shape.step_width_mm;
  const double lap = static_cast<double>(shape.tile_mm) / shape.exposure_mm;
  const double tile_rise = std::max(0.0, (rise - lap) / (1.0 + rise * lap));
  shape.cosine = 1.0 / std::sqrt(1.0 + tile_rise * tile_rise);
  shape.sine = tile_rise * shape.cosine;
  // The overhang ends above the slab's projecting edge.
  const double drop = course * 0.8 / std::max(shape.sine, 1e-3);
  shape.overhang_mm = static_cast<int>(
      std::min({drop, static_cast<double>(plan.scaled_mm(200)), static_cast<double>(plan.margin_mm)}));

  // Steps hide the tiles' edges: a step's top is above the roof at its inner end by `clear`.
  const double tile_top = course + shape.tile_mm * 2.0 / shape.cosine + plan.scaled_mm(60);
  shape.first_courses = std::max(2, courses_up(static_cast<int>(std::ceil(tile_top)), course));
  return shape;
}

void build_roof(const BuildingPlan& plan, int base_mm, LayoutSink& sink) {
  if (plan.roof == Roof::none) return;
  sink.set_storey(kRoofStorey);
  const int out = plan.projection_mm;
  const int top = base_mm + plan.slab_mm;
  sink.add(PartKind::slab, {{-out, -out, base_mm}, {plan.size_mm.x + out, plan.size_mm.y + out, top}});
  if (plan.roof == Roof::gabled)
    build_gabled(plan, top, sink);
  else
    build_flat(plan, top, sink);
}

}  // namespace scenegen::gen
