// TownOptions checked and turned into whole millimetres.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gen/generate.h"
#include "gen/layout.h"

namespace scenegen::gen {

/// A building in millimetres. `scale` is the height of a floor relative to 2.8 m: doors, slabs and joinery
/// follow it, so that a doll's house looks like a house.
struct BuildingPlan {
  glm::ivec3 brick_mm{500, 250, 200};  ///< length, width, height
  glm::ivec2 size_mm{0};               ///< outer walls
  int floor_courses = 0;
  int floors = 0;
  double scale = 1;

  int slab_mm = 200;       ///< thickness
  int projection_mm = 40;  ///< of slabs, sills and copings before the wall
  int pavement_mm = 100;   ///< thickness
  int margin_mm = 1000;    ///< width of the pavement round the building
  bool partitions = true;
  bool fitted = true;        ///< joinery, door, slab projection; false for the test sets
  bool slab_on_top = false;  ///< slab is the ceiling of its floor (test sets), else what it stands on
  int window_width_mm = 0;   ///< 0: no windows
  int window_courses = 0;
  int sill_course = 0;
  Roof roof = Roof::gabled;  ///< never mixed

  [[nodiscard]] int half_brick_mm() const { return brick_mm.x / 2; }
  [[nodiscard]] int wall_mm() const { return brick_mm.y; }
  [[nodiscard]] int wall_height_mm() const { return floor_courses * brick_mm.z; }
  [[nodiscard]] int storey_mm() const { return wall_height_mm() + slab_mm; }
  /// A length that suits a floor of 2.8 m, scaled; at least 1.
  [[nodiscard]] int scaled_mm(int mm) const;
};

/// Errors are usage errors that name the option. `roof` of the result is gabled, flat or none.
[[nodiscard]] Result<BuildingPlan> plan_building(const TownOptions& options, std::vector<std::string>& notes);

/// Checks grid, spacing, extras and seed.
[[nodiscard]] Result<void> check_town(const TownOptions& options);

/// Refuses a town wider than 32.768 km: beyond +-16.384 km float32 no longer resolves 1 mm.
[[nodiscard]] Result<void> check_extent(const TownOptions& options, double building_x_m, double building_y_m);

}  // namespace scenegen::gen
