// Scenes from parameters: a town of brick buildings (D 3.4), and the test sets of D's table 1.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gen/machines.h"
#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::gen {

/// `mixed`: most buildings gabled, some flat, seeded. Gables wider than 24 m are not built: `mixed` is flat
/// there.
enum class Roof : std::uint8_t { mixed, gabled, flat, none };

/// Sizes in metres, author's frame (Z up): x along the building's width, y along its length. Lengths are
/// rounded to whole millimetres (the brick's length to two), windows to half bricks and whole courses.
struct TownOptions {
  glm::uvec2 grid{1, 1};               ///< buildings along x and y
  double spacing_m = 6.0;              ///< clear distance between neighbouring buildings
  glm::dvec3 brick_m{0.5, 0.25, 0.2};  ///< length, width (= wall thickness), height of a brick
  glm::uvec2 building_bricks{10, 14};  ///< width and length of a building in brick lengths
  std::uint32_t floor_courses = 14;    ///< height of a floor in courses of bricks
  std::uint32_t floors = 3;
  bool partitions = true;
  bool windows = true;
  glm::dvec2 window_m{1.0, 1.2};       ///< width, height
  std::uint32_t extras_per_floor = 0;  ///< 0: no extra objects
  std::string extra_model = "box";     ///< "box", "sphere:SLICES", or a file
  std::string building_model;  ///< a file whose content stands in for each building; empty: build of bricks
  Roof roof = Roof::mixed;
  bool ground = true;
  std::uint32_t machines = 0;  ///< moving equipment: a crane, two lorries, a crane, …
  std::uint64_t seed = 1;
};

struct Generated {
  Scene scene;
  std::vector<std::uint8_t> exempt;  ///< per object: 1 = takes no appearance time (ground, machines)
  std::vector<std::string> notes;
  Machines machines;  ///< to be driven (drive_machines) when the objects have their times
};

/// What a scene will hold, computed without building it (for --dry-run); equal to what generating gives.
/// Vertices and triangles are those drawn: a shared mesh counts once an object (as in D's table 1).
struct Prediction {
  std::uint64_t objects = 0, vertices = 0, triangles = 0;
};

[[nodiscard]] Result<Generated> generate_town(const TownOptions& options);
[[nodiscard]] Result<Prediction> predict_town(const TownOptions& options);

/// Test sets 5 … 48 of D's table 1; counts equal reference/test_sets.csv exactly. Sets 1 … 4 are private
/// models: an error.
[[nodiscard]] Result<Generated> generate_test_set(int set, std::uint64_t seed);
[[nodiscard]] Result<Prediction> predict_test_set(int set);

}  // namespace scenegen::gen
