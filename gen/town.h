// A town: buildings on a grid, all copies of a few layouts.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "gen/generate.h"
#include "gen/plan.h"

namespace scenegen::gen {

enum class ExtraKind : std::uint8_t { box, sphere, model };

/// What generate_town and the test sets 23 … 40 are made from: everything checked, models read.
struct TownRecipe {
  glm::uvec2 grid{1, 1};
  double spacing_m = 0;
  BuildingPlan plan;
  std::vector<Layout> layouts;  ///< one, or two: gabled and flat
  glm::dvec2 building_m{0};     ///< outer walls, or the model's box
  std::optional<Scene> building_model;

  std::uint32_t extras_per_floor = 0;
  ExtraKind extra = ExtraKind::box;
  std::uint32_t sphere_slices = 0, sphere_stacks = 0;
  std::optional<Scene> extra_model;
  glm::dvec3 extra_size_m{0};

  MachinePlan machines;
  bool ground = true;
  bool unindexed_boxes = false;
  std::uint64_t seed = 1;

  /// Which layout building `index` has.
  [[nodiscard]] std::size_t layout_of(std::uint64_t index) const;
};

/// Of the highest building.
[[nodiscard]] double height_m(const TownRecipe& recipe);

[[nodiscard]] Prediction predict(const TownRecipe& recipe);
[[nodiscard]] Generated build_town(const TownRecipe& recipe, std::vector<std::string> notes);

/// Refuses more than limits::kMaxObjects. `option` is the one to lower.
[[nodiscard]] Result<void> check_count(const Prediction& prediction, const char* option);

}  // namespace scenegen::gen
