// Bonds and walls: what a course spans is tiled exactly, and joints do not stand above each other.
#include "gen/wall.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "gen/storey.h"
#include "scene/random.h"

using namespace scenegen;
using namespace scenegen::gen;

namespace {

/// Sorted intervals that must follow each other without gap or overlap from lo to hi.
void check_tiles(std::vector<Interval> pieces, Interval span) {
  std::sort(pieces.begin(), pieces.end(), [](Interval a, Interval b) { return a.lo_mm < b.lo_mm; });
  REQUIRE_FALSE(pieces.empty());
  int at = span.lo_mm;
  for (const Interval& p : pieces) {
    if (p.lo_mm != at || p.hi_mm <= p.lo_mm) FAIL("[" << p.lo_mm << ", " << p.hi_mm << ") follows " << at);
    at = p.hi_mm;
  }
  REQUIRE(at == span.hi_mm);
}

Interval along(const Wall& wall, const GridBox& box) {
  return wall.place.along_y ? Interval{box.lo_mm.y, box.hi_mm.y} : Interval{box.lo_mm.x, box.hi_mm.x};
}

/// Bricks, lintels and openings of every course of `wall` tile the course.
void check_wall(const Wall& wall) {
  Layout layout;
  LayoutSink sink(layout, 1'000'000);
  build_wall(wall, sink);
  std::size_t used = 0;
  for (int c = 0; c < static_cast<int>(wall.courses.size()); ++c) {
    const Interval z = wall.course_z(c);
    std::vector<Interval> pieces;
    for (const Part& p : layout.parts) {
      if (p.box.lo_mm.z != z.lo_mm) continue;
      REQUIRE(p.box.hi_mm.z == z.hi_mm);
      const int thickness =
          wall.place.along_y ? p.box.hi_mm.x - p.box.lo_mm.x : p.box.hi_mm.y - p.box.lo_mm.y;
      REQUIRE(thickness == wall.thickness_mm);
      const Interval u = along(wall, p.box);
      if (p.kind == wall.kind) REQUIRE(u.hi_mm - u.lo_mm <= wall.brick_length_mm);
      pieces.push_back(u);
      ++used;
    }
    for (const Opening& o : wall.openings) {
      if (c >= o.first_course && c < o.end_course) pieces.push_back(o.u);
    }
    check_tiles(pieces, wall.courses[static_cast<std::size_t>(c)].u);
  }
  REQUIRE(used == layout.parts.size());
}

BuildingPlan plan_of(const TownOptions& options) {
  std::vector<std::string> notes;
  return *plan_building(options, notes);
}

}  // namespace

TEST_CASE("a course is tiled exactly by pieces no longer than a brick") {
  const Random random(3, "courses");
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const int length = 2 + static_cast<int>(random.below(4 * i, 600));
    const int lo = static_cast<int>(random.below(4 * i + 1, 4000)) - 2000;
    const int hi = lo + 1 + static_cast<int>(random.below(4 * i + 2, 5000));
    const int phase = static_cast<int>(random.below(4 * i + 3, 3000)) - 1500;
    std::vector<Interval> pieces;
    lay_course({lo, hi}, phase, length, pieces);
    check_tiles(pieces, {lo, hi});
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const int size = pieces[k].hi_mm - pieces[k].lo_mm;
      if (size > length) FAIL("longer than a brick");
      if (pieces.size() > 1 && size < length / 4) FAIL("shorter than a quarter");
      if (k >= 2 && k + 2 < pieces.size() && size != length) FAIL("cut within the course");
    }
  }
}

TEST_CASE("end pieces: none, half, shorter than a quarter") {
  const auto lay = [](int lo, int hi, int phase) {
    std::vector<Interval> out;
    lay_course({lo, hi}, phase, 100, out);
    return out;
  };
  CHECK(lay(0, 300, 0) == std::vector<Interval>{{0, 100}, {100, 200}, {200, 300}});
  CHECK(lay(0, 300, 50) == std::vector<Interval>{{0, 50}, {50, 150}, {150, 250}, {250, 300}});
  CHECK(lay(0, 210, 0) == std::vector<Interval>{{0, 100}, {100, 155}, {155, 210}});
  CHECK(lay(90, 300, 0) == std::vector<Interval>{{90, 145}, {145, 200}, {200, 300}});
  CHECK(lay(90, 130, 0) == std::vector<Interval>{{90, 130}});
  CHECK(lay(5, 5, 0).empty());
}

TEST_CASE("walls with openings are tiled by bricks, lintels and openings") {
  const Random random(5, "walls");
  for (std::uint64_t i = 0; i < 60; ++i) {
    TownOptions options;
    const auto draw = [&](std::uint64_t k) { return static_cast<double>(random.unit(16 * i + k)); };
    options.brick_m = {0.2 + 0.6 * draw(0), 0, 0.1 + 0.2 * draw(1)};
    options.brick_m.y = options.brick_m.x * (0.35 + 0.65 * draw(2));
    options.building_bricks = {8 + static_cast<unsigned>(8 * draw(3)),
                               8 + static_cast<unsigned>(8 * draw(4))};
    options.windows = false;
    const BuildingPlan plan = plan_of(options);
    for (Wall& wall : ring_walls(plan, {{0, 0}, plan.size_mm, 0, 12})) {
      const int length = wall.courses[wall.place.along_y ? 1 : 0].u.hi_mm;
      int at = plan.wall_mm() + plan.brick_mm.x / 2 + static_cast<int>(draw(5) * 300);
      for (std::uint64_t k = 0; at + plan.brick_mm.x * 2 + plan.wall_mm() < length; ++k) {
        const int width = 1 + static_cast<int>(draw(6) * plan.brick_mm.x);
        const int first = static_cast<int>(4 * draw(7));
        wall.openings.push_back(
            {OpeningKind::window, {at, at + width}, first, first + 1 + static_cast<int>(6 * draw(8))});
        at += width + plan.brick_mm.x + static_cast<int>(draw(9) * 200);
      }
      REQUIRE((length < 3 * plan.brick_mm.x || !wall.openings.empty()));
      check_wall(wall);
    }
  }
}

TEST_CASE("corners interlock and joints are half a brick apart") {
  const BuildingPlan plan = plan_of({});
  const std::array<Wall, 4> walls = ring_walls(plan, {{0, 0}, plan.size_mm, 0, 6});
  for (std::size_t c = 0; c < 6; ++c) {
    // One of two neighbouring walls takes the corner, and it is the other one in the next course.
    const bool front_takes = walls[kFront].courses[c].u.lo_mm == 0;
    CHECK(front_takes == (c % 2 == 0));
    CHECK((walls[kLeft].courses[c].u.lo_mm == 0) == !front_takes);
  }
  for (const Wall& wall : walls) {
    for (std::size_t c = 0; c + 1 < wall.courses.size(); ++c) {
      std::vector<Interval> lower, upper;
      lay_course(wall.courses[c].u, wall.courses[c].phase_mm, plan.brick_mm.x, lower);
      lay_course(wall.courses[c + 1].u, wall.courses[c + 1].phase_mm, plan.brick_mm.x, upper);
      for (std::size_t i = 1; i < lower.size(); ++i) {
        for (std::size_t j = 1; j < upper.size(); ++j) CHECK(lower[i].lo_mm != upper[j].lo_mm);
      }
    }
  }
}

TEST_CASE("every storey's corner columns are filled") {
  // The ring's four walls together tile the ring in plan: area of bricks = area of the ring, each course.
  const Random random(8, "rings");
  for (std::uint64_t i = 0; i < 40; ++i) {
    TownOptions options;
    options.brick_m.x = 0.2 + 0.8 * static_cast<double>(random.unit(4 * i));
    options.brick_m.y = options.brick_m.x * (0.2 + 0.8 * static_cast<double>(random.unit(4 * i + 1)));
    options.building_bricks = {4, 5 + static_cast<unsigned>(random.below(4 * i + 2, 9))};
    options.windows = false;
    const BuildingPlan plan = plan_of(options);
    Layout layout;
    LayoutSink sink(layout, 1'000'000);
    for (const Wall& wall : ring_walls(plan, {{0, 0}, plan.size_mm, 0, 4})) build_wall(wall, sink);
    std::int64_t area = 0;
    for (const Part& p : layout.parts) {
      const glm::ivec3 size = p.box.hi_mm - p.box.lo_mm;
      area += std::int64_t{size.x} * size.y;
    }
    const glm::ivec2 inner = plan.size_mm - 2 * plan.wall_mm();
    CHECK(area == 4 * (std::int64_t{plan.size_mm.x} * plan.size_mm.y - std::int64_t{inner.x} * inner.y));
  }
}
