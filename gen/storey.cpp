#include "gen/storey.h"

#include <algorithm>
#include <cmath>

namespace scenegen::gen {
namespace {

int rounded_div(int a, int b) {
  return (a + b / 2) / b;
}

/// Equal windows, evenly in [bay], on the joints of the bond: lower edges at multiples of half a brick.
void add_windows(const BuildingPlan& plan, Interval bay, std::vector<Opening>& out) {
  const int half = plan.half_brick_mm();
  const int width = plan.window_width_mm;
  if (width == 0) return;
  const int between = std::max(plan.brick_mm.x, width * 3 / 4);  // lintels of neighbours must not meet
  const int room = bay.hi_mm - bay.lo_mm;
  const int count = (room + between) / (width + between);
  int least = bay.lo_mm;
  for (int i = 0; i < count; ++i) {
    const int slack = room - count * width;
    const int wish =
        bay.lo_mm + static_cast<int>((std::int64_t{slack} * (2 * i + 1)) / (2 * count)) + i * width;
    int lo = rounded_div(wish, half) * half;
    if (lo < least) lo = (least + half - 1) / half * half;
    if (lo + width > bay.hi_mm) break;
    out.push_back(
        {OpeningKind::window, {lo, lo + width}, plan.sill_course, plan.sill_course + plan.window_courses});
    least = lo + width + plan.brick_mm.x;
  }
}

struct DoorSize {
  int width_mm = 0, courses = 0;
};

/// Width in half bricks, height leaving a course for the lintel; none when courses is 0.
DoorSize door_size(const BuildingPlan& plan, int width_mm, int course_mm) {
  const int half = plan.half_brick_mm();
  const int courses_in_wall = plan.wall_height_mm() / course_mm;
  DoorSize door;
  door.width_mm = std::max(1, rounded_div(plan.scaled_mm(width_mm), half)) * half;
  door.courses = std::min(rounded_div(plan.scaled_mm(2100), course_mm), courses_in_wall - 1);
  return door;
}

/// Bays of an outer wall: the spans between partitions, away from corners.
std::vector<Interval> bays_of(const BuildingPlan& plan, const Division& division, bool along_y) {
  const int clearance = plan.scaled_mm(80);
  std::vector<Interval> bays = division.spans(along_y);
  for (Interval& bay : bays) {
    bay.lo_mm += clearance;
    bay.hi_mm -= clearance;
  }
  const int corner = plan.half_brick_mm();  // a lintel's bearing, beside the other wall
  bays.front().lo_mm = std::max(bays.front().lo_mm, plan.wall_mm() + corner);
  const int length = along_y ? plan.size_mm.y : plan.size_mm.x;
  bays.back().hi_mm = std::min(bays.back().hi_mm, length - plan.wall_mm() - corner);
  return bays;
}

/// The front door in the middle of a bay; windows beside it where there is room.
void add_door(const BuildingPlan& plan, Interval bay, std::vector<Opening>& out) {
  const DoorSize door = door_size(plan, 1000, plan.brick_mm.z);
  const int half = plan.half_brick_mm();
  const int lo = rounded_div(bay.lo_mm + (bay.hi_mm - bay.lo_mm - door.width_mm) / 2, half) * half;
  if (door.courses < 1 || lo < bay.lo_mm || lo + door.width_mm > bay.hi_mm) {
    add_windows(plan, bay, out);
    return;
  }
  add_windows(plan, {bay.lo_mm, lo - plan.brick_mm.x}, out);
  out.push_back({OpeningKind::door, {lo, lo + door.width_mm}, 0, door.courses});
  add_windows(plan, {lo + door.width_mm + plan.brick_mm.x, bay.hi_mm}, out);
}

void build_outer_walls(const BuildingPlan& plan, const Division& division, int floor, int bottom_mm,
                       LayoutSink& sink) {
  std::array<Wall, 4> walls = ring_walls(plan, {{0, 0}, plan.size_mm, bottom_mm, plan.floor_courses});
  for (std::size_t side = 0; side < walls.size(); ++side) {
    Wall& wall = walls[side];
    if (plan.fitted) {
      const std::vector<Interval> bays = bays_of(plan, division, wall.place.along_y);
      for (std::size_t b = 0; b < bays.size(); ++b) {
        const bool has_door = floor == 0 && side == kFront && b == bays.size() / 2;
        if (has_door)
          add_door(plan, bays[b], wall.openings);
        else
          add_windows(plan, bays[b], wall.openings);
      }
    }
    build_wall(wall, sink);
    const JoinerySizes sizes = joinery_sizes(plan);
    const Interval step{plan.pavement_mm, plan.pavement_mm + std::max(1, plan.slab_mm / 2)};
    for (const Opening& opening : wall.openings) {
      if (opening.kind == OpeningKind::door) {
        fit_door(wall, opening, sizes, step, sink);
      } else {
        fit_window(wall, opening, sizes, sink);
        sink.add_window();
      }
    }
  }
}

/// A partition along one axis with a passage in the middle of each of `rooms` (spans along it).
void build_partition(const BuildingPlan& plan, const WallPlace& place, Interval u, int bottom_mm,
                     const std::vector<Interval>& rooms, LayoutSink& sink) {
  if (sink.overflowed()) return;
  Wall wall;
  wall.place = place;
  wall.kind = PartKind::block;
  wall.thickness_mm = std::max(1, plan.wall_mm() / 2);
  wall.brick_length_mm = plan.brick_mm.x;
  wall.course_height_mm = plan.brick_mm.z * (plan.brick_mm.z < plan.scaled_mm(300) ? 2 : 1);
  wall.bottom_mm = bottom_mm;
  wall.top_mm = bottom_mm + plan.wall_height_mm();
  wall.bearing_mm = plan.half_brick_mm();
  const int courses = (plan.wall_height_mm() + wall.course_height_mm - 1) / wall.course_height_mm;
  for (int c = 0; c < courses; ++c) wall.courses.push_back({u, u.lo_mm + (c % 2) * plan.half_brick_mm()});
  const DoorSize door = door_size(plan, 900, wall.course_height_mm);
  for (const Interval& room : rooms) {
    const int half = plan.half_brick_mm();
    const int wish = (room.lo_mm + room.hi_mm - door.width_mm) / 2 - u.lo_mm;
    const int lo = u.lo_mm + std::max(0, rounded_div(std::max(0, wish), half)) * half;
    if (door.courses < 1 || lo < room.lo_mm + half || lo + door.width_mm + half > room.hi_mm) continue;
    wall.openings.push_back({OpeningKind::passage, {lo, lo + door.width_mm}, 0, door.courses});
  }
  build_wall(wall, sink);
}

void build_partitions(const BuildingPlan& plan, const Division& division, int bottom_mm, LayoutSink& sink) {
  const std::vector<Interval> rooms_x = division.spans(false);
  const std::vector<Interval> rooms_y = division.spans(true);
  for (const int x : division.spines_x_mm) {
    build_partition(plan, {true, x, true}, {division.inner_lo_mm.y, division.inner_hi_mm.y}, bottom_mm,
                    rooms_y, sink);
  }
  for (const int y : division.crosses_y_mm) {
    for (const Interval& room : rooms_x)
      build_partition(plan, {false, y, true}, room, bottom_mm, {room}, sink);
  }
}

}  // namespace

JoinerySizes joinery_sizes(const BuildingPlan& plan) {
  JoinerySizes sizes;
  sizes.bar_mm = plan.scaled_mm(60);
  sizes.depth_mm = std::min(plan.scaled_mm(70), std::max(1, plan.wall_mm() / 2));
  sizes.pane_mm = plan.scaled_mm(12);
  sizes.sill_mm = plan.scaled_mm(50);
  sizes.projection_mm = plan.projection_mm;
  sizes.step_projection_mm = plan.projection_mm;
  sizes.step_depth_mm = std::min(plan.scaled_mm(350), plan.margin_mm - plan.projection_mm);
  return sizes;
}

std::array<Wall, 4> ring_walls(const BuildingPlan& plan, const Ring& ring) {
  const int thickness = plan.wall_mm();
  std::array<Wall, 4> walls;
  for (std::size_t side = 0; side < walls.size(); ++side) {
    Wall& wall = walls[side];
    const bool along_y = side == kLeft || side == kRight;
    const std::size_t axis = along_y ? 1 : 0;
    const std::size_t across = 1 - axis;
    const bool at_lo = side == kFront || side == kLeft;
    wall.place = {along_y,
                  at_lo ? ring.lo_mm[static_cast<int>(across)] : ring.hi_mm[static_cast<int>(across)], at_lo};
    wall.thickness_mm = thickness;
    wall.brick_length_mm = plan.brick_mm.x;
    wall.course_height_mm = plan.brick_mm.z;
    wall.bottom_mm = ring.bottom_mm;
    wall.top_mm = ring.bottom_mm + ring.courses * plan.brick_mm.z;
    wall.bearing_mm = plan.half_brick_mm();
    const Interval through{ring.lo_mm[static_cast<int>(axis)], ring.hi_mm[static_cast<int>(axis)]};
    const Interval between{through.lo_mm + thickness, through.hi_mm - thickness};
    for (int c = 0; c < ring.courses; ++c) {
      const bool odd = c % 2 == 1;
      const bool takes_corners = odd == along_y;
      const int phase = through.lo_mm + (takes_corners ? 0 : plan.half_brick_mm());
      wall.courses.push_back({takes_corners ? through : between, phase});
    }
  }
  return walls;
}

std::vector<Interval> Division::spans(bool along_y) const {
  std::vector<Interval> out;
  int lo = along_y ? inner_lo_mm.y : inner_lo_mm.x;
  for (const int wall : along_y ? crosses_y_mm : spines_x_mm) {
    out.push_back({lo, wall});
    lo = wall + thickness_mm;
  }
  out.push_back({lo, along_y ? inner_hi_mm.y : inner_hi_mm.x});
  return out;
}

Division divide_floor(const BuildingPlan& plan) {
  Division division;
  division.thickness_mm = std::max(1, plan.wall_mm() / 2);
  division.inner_lo_mm = glm::ivec2(plan.wall_mm());
  division.inner_hi_mm = plan.size_mm - plan.wall_mm();
  const glm::ivec2 inner = division.inner_hi_mm - division.inner_lo_mm;
  const int wish = std::max(plan.scaled_mm(3600), 3 * plan.brick_mm.x);  // a room's side
  const auto divide = [&](int lo, int length, std::vector<int>& out) {
    const int rooms = std::max(1, rounded_div(length, wish));
    for (int i = 1; i < rooms; ++i) {
      out.push_back(lo + static_cast<int>(std::int64_t{length} * i / rooms) - division.thickness_mm / 2);
    }
  };
  divide(division.inner_lo_mm.x, inner.x, division.spines_x_mm);
  divide(division.inner_lo_mm.y, inner.y, division.crosses_y_mm);
  return division;
}

void build_storey(const BuildingPlan& plan, int floor, int bottom_mm, LayoutSink& sink) {
  Division division;
  if (plan.fitted) {
    division = divide_floor(plan);
  } else {
    division.inner_lo_mm = glm::ivec2(plan.wall_mm());
    division.inner_hi_mm = plan.size_mm - plan.wall_mm();
  }
  const int out = plan.fitted ? plan.projection_mm : 0;
  const int slab_lo = plan.slab_on_top ? bottom_mm + plan.wall_height_mm() : bottom_mm;
  const int walls_lo = plan.slab_on_top ? bottom_mm : bottom_mm + plan.slab_mm;
  sink.add(PartKind::slab,
           {{-out, -out, slab_lo}, {plan.size_mm.x + out, plan.size_mm.y + out, slab_lo + plan.slab_mm}});
  build_outer_walls(plan, division, floor, walls_lo, sink);
  if (plan.partitions) build_partitions(plan, division, walls_lo, sink);
  if (!plan.partitions) {
    division.spines_x_mm.clear();
    division.crosses_y_mm.clear();
  }
  for (const Interval& x : division.spans(false)) {
    for (const Interval& y : division.spans(true)) {
      sink.add_room({{x.lo_mm, y.lo_mm, walls_lo}, {x.hi_mm, y.hi_mm, walls_lo + plan.wall_height_mm()}});
    }
  }
}

}  // namespace scenegen::gen
