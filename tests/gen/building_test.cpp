// Whole buildings: nothing overlaps, whatever the options.
#include "gen/building.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "gen/storey.h"
#include "scene/random.h"

using namespace scenegen;
using namespace scenegen::gen;

namespace {

bool overlap(const GridBox& a, const GridBox& b) {
  for (int i = 0; i < 3; ++i) {
    if (a.hi_mm[i] <= b.lo_mm[i] || b.hi_mm[i] <= a.lo_mm[i]) return false;
  }
  return true;
}

std::string text(const Part& p) {
  std::string s = name_of(p.kind);
  s += " storey " + std::to_string(p.storey);
  for (int i = 0; i < 3; ++i)
    s += " [" + std::to_string(p.box.lo_mm[i]) + "," + std::to_string(p.box.hi_mm[i]) + ")";
  return s;
}

/// Sweep over z within one frame of coordinates.
void check_no_overlap(const Layout& layout, PartFrame frame) {
  std::vector<const Part*> parts;
  for (const Part& p : layout.parts) {
    if (p.frame == frame) parts.push_back(&p);
  }
  std::sort(parts.begin(), parts.end(),
            [](const Part* a, const Part* b) { return a->box.lo_mm.z < b->box.lo_mm.z; });
  std::vector<const Part*> open;
  std::size_t pairs = 0;
  for (const Part* p : parts) {
    std::erase_if(open, [&](const Part* o) { return o->box.hi_mm.z <= p->box.lo_mm.z; });
    for (const Part* o : open) {
      ++pairs;
      if (overlap(o->box, p->box)) FAIL(text(*o) << " overlaps " << text(*p));
    }
    open.push_back(p);
  }
  CHECK((frame != PartFrame::building || pairs > 0));
}

/// Projection of a box's corners (turned into building axes) on an axis.
struct Span {
  double lo = 1e300, hi = -1e300;
};
struct Turned {
  glm::dvec3 centre, half, x, z;
};
Turned turned(const Layout& layout, const Part& p) {
  Turned t;
  const glm::dvec3 lo(p.box.lo_mm), hi(p.box.hi_mm);
  t.half = (hi - lo) * 0.5;
  const glm::dvec3 c = (lo + hi) * 0.5;
  t.x = {1, 0, 0};
  t.z = {0, 0, 1};
  glm::dvec3 origin(0);
  if (p.frame != PartFrame::building) {
    const bool left = p.frame == PartFrame::left_slope;
    const Slope& s = layout.slopes[left ? 0 : 1];
    const double sine = left ? s.sine : -s.sine;
    t.x = {s.cosine, 0, sine};
    t.z = {-sine, 0, s.cosine};
    origin = glm::dvec3(s.origin_mm);
  }
  t.centre = origin + c.x * t.x + glm::dvec3(0, c.y, 0) + c.z * t.z;
  return t;
}
/// Separating axis test in the xz plane and y; true when they overlap by more than `slack` mm.
bool overlap(const Turned& a, const Turned& b, double slack) {
  if (std::abs(a.centre.y - b.centre.y) >= a.half.y + b.half.y) return false;
  for (const glm::dvec3& axis : {a.x, a.z, b.x, b.z}) {
    const auto reach = [&](const Turned& t) {
      return t.half.x * std::abs(glm::dot(t.x, axis)) + t.half.z * std::abs(glm::dot(t.z, axis));
    };
    if (std::abs(glm::dot(a.centre - b.centre, axis)) >= reach(a) + reach(b) - slack) return false;
  }
  return true;
}

void check_slopes_clear(const Layout& layout) {
  std::vector<Turned> others, left, right;
  for (const Part& p : layout.parts) {
    if (p.frame == PartFrame::left_slope)
      left.push_back(turned(layout, p));
    else if (p.frame == PartFrame::right_slope)
      right.push_back(turned(layout, p));
    else if (p.storey == kRoofStorey)
      others.push_back(turned(layout, p));
  }
  std::size_t bad = 0;
  for (const Turned& t : left) {
    for (const Turned& o : others) bad += overlap(t, o, 1e-6);
    for (const Turned& o : right) bad += overlap(t, o, 1e-6);
  }
  for (const Turned& t : right) {
    for (const Turned& o : others) bad += overlap(t, o, 1e-6);
  }
  CHECK(bad == 0);
}

TownOptions random_options(std::uint64_t i) {
  const Random random(99, "building options");
  const auto draw = [&](std::uint64_t k) { return static_cast<double>(random.unit(i * 32 + k)); };
  TownOptions o;
  o.brick_m.x = 0.1 + 0.9 * draw(0);
  o.brick_m.y = o.brick_m.x * (i % 3 == 0 ? 0.5 : 0.3 + 0.7 * draw(1));
  o.brick_m.z = 0.05 + 0.4 * draw(2);
  o.building_bricks = {3 + static_cast<unsigned>(12 * draw(3)), 3 + static_cast<unsigned>(16 * draw(4))};
  o.floor_courses = 2 + static_cast<unsigned>(14 * draw(5));
  o.floors = 1 + static_cast<unsigned>(2.99 * draw(6));
  o.partitions = draw(7) < 0.7;
  o.windows = draw(8) < 0.8;
  o.window_m = {o.brick_m.x * (0.5 + 3 * draw(9)), o.brick_m.z * (1 + (o.floor_courses - 2) * draw(10))};
  o.spacing_m = draw(11) < 0.2 ? 0 : 8 * draw(11);
  o.roof = static_cast<Roof>(static_cast<int>(3.99 * draw(12)));
  return o;
}

}  // namespace

TEST_CASE("no two parts of a building overlap") {
  for (std::uint64_t i = 0; i < 120; ++i) {
    const TownOptions options = random_options(i);
    std::vector<std::string> notes;
    const Result<BuildingPlan> plan = plan_building(options, notes);
    INFO("options " << i << " brick " << options.brick_m.x << " x " << options.brick_m.y << " x "
                    << options.brick_m.z << ", building " << options.building_bricks.x << " x "
                    << options.building_bricks.y << ", courses " << options.floor_courses);
    if (!plan) FAIL(plan.error().str());
    Layout layout;
    REQUIRE(build_building(*plan, 10'000'000, layout));
    for (const Part& p : layout.parts) {
      if (!(glm::all(glm::lessThan(p.box.lo_mm, p.box.hi_mm)))) FAIL("empty box: " << text(p));
    }
    check_no_overlap(layout, PartFrame::building);
    check_no_overlap(layout, PartFrame::left_slope);
    check_no_overlap(layout, PartFrame::right_slope);
    check_slopes_clear(layout);
  }
}

TEST_CASE("outer walls have no gaps: what a plane through the glass cuts fills the wall exactly") {
  for (std::uint64_t i = 0; i < 80; ++i) {
    TownOptions options = random_options(i);
    if (i == 0) options = {};
    std::vector<std::string> notes;
    const BuildingPlan plan = *plan_building(options, notes);
    INFO("options " << i);
    Layout layout;
    REQUIRE(build_building(plan, 10'000'000, layout));
    // The glass stands at this depth behind the outer face (joinery.cpp).
    const JoinerySizes sizes = joinery_sizes(plan);
    const int depth = std::clamp(sizes.depth_mm, 1, plan.wall_mm());
    const int pane = std::clamp(sizes.pane_mm, 1, depth);
    const int plane = (plan.wall_mm() - depth) * 2 / 5 + (depth - pane) / 2;
    for (int floor = 0; floor < plan.floors; ++floor) {
      std::array<std::int64_t, 4> area{};
      for (const Part& p : layout.parts) {
        if (p.storey != static_cast<std::uint32_t>(floor) || p.kind == PartKind::slab) continue;
        const glm::ivec3 size = p.box.hi_mm - p.box.lo_mm;
        const auto cuts = [&](int axis, int at) { return p.box.lo_mm[axis] <= at && at < p.box.hi_mm[axis]; };
        if (cuts(1, plane)) area[kFront] += std::int64_t{size.x} * size.z;
        if (cuts(1, plan.size_mm.y - 1 - plane)) area[kBack] += std::int64_t{size.x} * size.z;
        if (cuts(0, plane)) area[kLeft] += std::int64_t{size.y} * size.z;
        if (cuts(0, plan.size_mm.x - 1 - plane)) area[kRight] += std::int64_t{size.y} * size.z;
      }
      // Nothing overlaps (above), so equal areas mean no gap.
      for (const std::size_t side : {kFront, kBack}) {
        CHECK(area[side] == std::int64_t{plan.size_mm.x} * plan.wall_height_mm());
      }
      for (const std::size_t side : {kLeft, kRight}) {
        CHECK(area[side] == std::int64_t{plan.size_mm.y} * plan.wall_height_mm());
      }
    }
  }
}

TEST_CASE("slopes of tiles have no gaps: rows follow each other and lap") {
  for (std::uint64_t i = 0; i < 40; ++i) {
    TownOptions options = random_options(i);
    options.roof = Roof::gabled;
    std::vector<std::string> notes;
    const BuildingPlan plan = *plan_building(options, notes);
    Layout layout;
    REQUIRE(build_building(plan, 10'000'000, layout));
    int row_end = 0, row_top = 0;
    std::int64_t width = 0;
    std::size_t rows = 0;
    const int length = plan.size_mm.y - 2 * plan.wall_mm();
    for (const Part& p : layout.parts) {
      if (p.frame != PartFrame::left_slope) continue;
      if (rows == 0 || p.box.lo_mm.z != row_top - (p.box.hi_mm.z - p.box.lo_mm.z)) {
        if (rows > 0) {
          CHECK(width == length);
          CHECK(p.box.lo_mm.z == row_top);
          CHECK(p.box.lo_mm.x <= row_end);
        }
        ++rows;
        width = 0;
      }
      width += p.box.hi_mm.y - p.box.lo_mm.y;
      row_end = p.box.hi_mm.x;
      row_top = p.box.hi_mm.z;
    }
    CHECK(rows > 0);
    CHECK(width == length);
  }
}

TEST_CASE("a default building has every kind of part") {
  std::vector<std::string> notes;
  const TownOptions options;
  Layout layout;
  REQUIRE(build_building(*plan_building(options, notes), 10'000'000, layout));
  std::array<std::size_t, kPartKinds> count{};
  for (const Part& p : layout.parts) ++count[static_cast<std::size_t>(p.kind)];
  for (std::size_t k = 0; k < kPartKinds; ++k) {
    INFO(name_of(static_cast<PartKind>(k)));
    if (k != static_cast<std::size_t>(PartKind::gravel)) CHECK(count[k] > 0);  // gravel lies on flat roofs
  }
  CHECK(count[static_cast<std::size_t>(PartKind::brick)] > 1000);
  CHECK(count[static_cast<std::size_t>(PartKind::door)] == 1);
  CHECK(notes.empty());
}
