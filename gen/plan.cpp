#include "gen/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "scene/limits.h"

namespace scenegen::gen {
namespace {

constexpr double kReferenceFloorMm = 2800;
constexpr double kWidestGableMm = 24'000;
constexpr double kWidestTownM = 32'768;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

tl::unexpected<Error> usage(const char* option, std::string what) {
  return fail(ErrorKind::usage, option, std::move(what));
}

/// "0 is out of range; allowed 1 … 10000, nearest 1"
std::string out_of_range(double value, double least, double most) {
  const double nearest = std::isnan(value) ? least : std::clamp(value, least, most);
  return number(value) + " is out of range; allowed " + number(least) + " to " + number(most) + ", nearest " +
         number(nearest);
}

Result<void> in_range(const char* option, const char* what, double value, double least, double most) {
  if (value >= least && value <= most) return {};
  return usage(option, std::string(what) + " " + out_of_range(value, least, most));
}

int whole_mm(double metres, int multiple = 1) {
  return std::max(multiple, static_cast<int>(std::lround(metres * 1000.0 / multiple)) * multiple);
}

Result<void> check_bricks(const TownOptions& o) {
  if (auto r = in_range("--brick", "length", o.brick_m.x, 0.02, 10); !r) return r;
  if (auto r = in_range("--brick", "width", o.brick_m.y, 0.01, 10); !r) return r;
  if (auto r = in_range("--brick", "height", o.brick_m.z, 0.005, 10); !r) return r;
  if (o.brick_m.y > o.brick_m.x) {
    return usage("--brick", "width " + number(o.brick_m.y) + " is more than the length " +
                                number(o.brick_m.x) + "; nearest " + number(o.brick_m.x));
  }
  if (auto r = in_range("--floor-courses", "courses", o.floor_courses, 1, 1000); !r) return r;
  if (auto r = in_range("--floors", "floors", o.floors, 1, 1000); !r) return r;
  // Opposite walls and one brick between them.
  const double least =
      std::ceil((2.0 * whole_mm(o.brick_m.y) + whole_mm(o.brick_m.x, 2)) / whole_mm(o.brick_m.x, 2));
  if (auto r = in_range("--building-size", "width in bricks", o.building_bricks.x, least, 10'000); !r)
    return r;
  return in_range("--building-size", "length in bricks", o.building_bricks.y, least, 10'000);
}

/// Windows in half bricks and courses; a course remains for the lintel.
Result<void> plan_windows(const TownOptions& o, BuildingPlan& plan, std::vector<std::string>& notes) {
  if (auto r = in_range("--window", "width", o.window_m.x, 0.01, 100); !r) return r;
  if (auto r = in_range("--window", "height", o.window_m.y, 0.01, 100); !r) return r;
  const int half = plan.half_brick_mm();
  const int halves = std::max(1, static_cast<int>(std::lround(o.window_m.x * 1000.0 / half)));
  plan.window_width_mm = halves * half;
  plan.window_courses = std::max(1, static_cast<int>(std::lround(o.window_m.y * 1000.0 / plan.brick_mm.z)));
  if (plan.window_courses + 1 > plan.floor_courses) {
    const std::string floor = "a floor has " + std::to_string(plan.floor_courses) + " courses of " +
                              number(plan.brick_mm.z / 1000.0) + " m";
    if (plan.floor_courses < 2) return usage("--window", "no window fits: " + floor + "; use --windows off");
    return usage("--window", "height " + number(o.window_m.y) + " and its lintel need " +
                                 std::to_string(plan.window_courses + 1) + " courses, but " + floor +
                                 "; nearest height " +
                                 number((plan.floor_courses - 1) * plan.brick_mm.z / 1000.0));
  }
  const int wish = static_cast<int>(std::lround(plan.scaled_mm(900) / static_cast<double>(plan.brick_mm.z)));
  plan.sill_course = std::clamp(wish, 0, plan.floor_courses - 1 - plan.window_courses);
  const double height_m = plan.window_courses * plan.brick_mm.z / 1000.0;
  const double width_m = plan.window_width_mm / 1000.0;
  if (std::abs(height_m - o.window_m.y) > 1e-3 || std::abs(width_m - o.window_m.x) > 1e-3) {
    notes.push_back("windows are " + number(width_m) + " m x " + number(height_m) +
                    " m: whole half bricks and courses");
  }
  return {};
}

Result<void> plan_roof(const TownOptions& o, BuildingPlan& plan, std::vector<std::string>& notes) {
  plan.roof = o.roof == Roof::mixed ? Roof::gabled : o.roof;
  if (plan.roof != Roof::gabled || plan.size_mm.x <= kWidestGableMm) return {};
  const std::string why = "a building " + number(plan.size_mm.x / 1000.0) +
                          " m wide is too wide for a gable (at most " + number(kWidestGableMm / 1000.0) +
                          " m)";
  if (o.roof == Roof::gabled) return usage("--roof", why + "; nearest flat");
  plan.roof = Roof::flat;
  notes.push_back(why + ": flat roofs");
  return {};
}

}  // namespace

int BuildingPlan::scaled_mm(int mm) const {
  return std::max(1, static_cast<int>(std::lround(mm * scale)));
}

Result<BuildingPlan> plan_building(const TownOptions& o, std::vector<std::string>& notes) {
  if (auto r = check_bricks(o); !r) return forward_error(r);
  BuildingPlan plan;
  plan.brick_mm = {whole_mm(o.brick_m.x, 2), 0, whole_mm(o.brick_m.z)};
  plan.brick_mm.y = std::min(whole_mm(o.brick_m.y), plan.brick_mm.x);
  plan.size_mm = glm::ivec2(o.building_bricks) * plan.brick_mm.x;
  plan.floor_courses = static_cast<int>(o.floor_courses);
  plan.floors = static_cast<int>(o.floors);
  plan.scale = std::clamp(plan.wall_height_mm() / kReferenceFloorMm, 0.02, 1.5);
  plan.slab_mm = plan.scaled_mm(200);
  plan.pavement_mm = plan.scaled_mm(100);
  // Twice each must fit between neighbours.
  const int clear = static_cast<int>(o.spacing_m * 1000.0);
  plan.margin_mm = std::min(plan.scaled_mm(1000), clear / 2);
  plan.projection_mm = std::min(plan.scaled_mm(40), plan.margin_mm);
  plan.partitions = o.partitions;
  if (o.windows) {
    if (auto r = plan_windows(o, plan, notes); !r) return forward_error(r);
  }
  if (auto r = plan_roof(o, plan, notes); !r) return forward_error(r);
  return plan;
}

Result<void> check_town(const TownOptions& o) {
  if (auto r = in_range("--grid", "buildings along x", o.grid.x, 1, 100'000); !r) return r;
  if (auto r = in_range("--grid", "buildings along y", o.grid.y, 1, 100'000); !r) return r;
  if (auto r = in_range("--spacing", "distance", o.spacing_m, 0, 1000); !r) return r;
  if (auto r = in_range("--extras", "objects per floor", o.extras_per_floor, 0, 1'000'000); !r) return r;
  return in_range("--seed", "seed", static_cast<double>(o.seed), 0, static_cast<double>(limits::kMaxSeed));
}

Result<void> check_extent(const TownOptions& o, double building_x_m, double building_y_m) {
  const double x = o.grid.x * (building_x_m + o.spacing_m);
  const double y = o.grid.y * (building_y_m + o.spacing_m);
  if (x <= kWidestTownM && y <= kWidestTownM) return {};
  const bool is_x = x > kWidestTownM;
  const double pitch = is_x ? building_x_m + o.spacing_m : building_y_m + o.spacing_m;
  return usage("--grid", std::string("the town would be ") + number(is_x ? x : y) + " m along " +
                             (is_x ? "x" : "y") + ", at most 32768 m (float32 resolves 1 mm); nearest " +
                             number(std::max(1.0, std::floor(kWidestTownM / pitch))) + " buildings");
}

}  // namespace scenegen::gen
