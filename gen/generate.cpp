#include "gen/generate.h"

#include <algorithm>
#include <charconv>

#include "gen/building.h"
#include "gen/model.h"
#include "gen/town.h"
#include "scene/limits.h"

namespace scenegen::gen {
namespace {

constexpr std::uint32_t kLeastSlices = 4, kMostSlices = 4096;

/// "sphere:SLICES"
Result<std::uint32_t> sphere_slices(const std::string& model) {
  const char* begin = model.data() + model.find(':') + 1;
  const char* end = model.data() + model.size();
  std::uint32_t slices = 0;
  const auto [stop, error] = std::from_chars(begin, end, slices);
  if (error == std::errc() && stop == end && slices >= kLeastSlices && slices <= kMostSlices) return slices;
  return fail(ErrorKind::usage, "--extra-model",
              "'" + model + "': a sphere has " + std::to_string(kLeastSlices) + " to " +
                  std::to_string(kMostSlices) + " slices, as in sphere:32");
}

Result<void> choose_extras(const TownOptions& o, TownRecipe& recipe, std::vector<std::string>& notes) {
  recipe.extras_per_floor = o.extras_per_floor;
  if (o.extras_per_floor > 0 && !o.building_model.empty()) {
    return fail(ErrorKind::usage, "--extras",
                "a building from --building-model has no known rooms to put objects into; nearest 0");
  }
  if (o.extra_model == "box") {
    recipe.extra_size_m = glm::dvec3(recipe.plan.brick_mm) * 0.001;
  } else if (o.extra_model == "sphere" || o.extra_model.starts_with("sphere:")) {
    const Result<std::uint32_t> slices =
        o.extra_model == "sphere" ? Result<std::uint32_t>(32U) : sphere_slices(o.extra_model);
    if (!slices) return tl::unexpected<Error>(slices.error());
    recipe.extra = ExtraKind::sphere;
    recipe.sphere_slices = *slices;
    recipe.sphere_stacks = *slices / 2;
    recipe.extra_size_m = glm::dvec3(recipe.plan.brick_mm.x * 0.8e-3);
  } else if (o.extras_per_floor > 0) {
    Result<Scene> model = read_model(o.extra_model, "--extra-model", notes);
    if (!model) return forward_error(model);
    recipe.extra = ExtraKind::model;
    const glm::dvec3 size(model_bounds(*model).size());
    recipe.extra_size_m = {size.x, size.z, size.y};
    recipe.extra_model = std::move(*model);
  }
  return {};
}

/// Layouts of brick buildings; refuses what would exceed the limit before it is built.
Result<void> lay_out(const TownOptions& o, TownRecipe& recipe, std::vector<std::string>& notes) {
  const std::uint64_t buildings = std::uint64_t{o.grid.x} * o.grid.y;
  const std::uint64_t most_parts = limits::kMaxObjects / buildings;
  std::vector<Roof> roofs{recipe.plan.roof};
  if (o.roof == Roof::mixed && recipe.plan.roof == Roof::gabled && buildings > 1) roofs.push_back(Roof::flat);
  for (const Roof roof : roofs) {
    BuildingPlan plan = recipe.plan;
    plan.roof = roof;
    if (build_building(plan, most_parts, recipe.layouts.emplace_back())) continue;
    std::string what = "more than " + std::to_string(limits::kMaxObjects) + " objects";
    if (buildings == 1)
      return fail(ErrorKind::usage, "--building-size",
                  what + "; take fewer or larger bricks, or fewer floors");
    what += ": a building has more than " + std::to_string(most_parts);
    return fail(ErrorKind::usage, "--grid", what + "; take fewer buildings");
  }
  if (o.windows && recipe.layouts.front().windows == 0)
    notes.emplace_back("no window fits between the walls: the buildings have none");
  return {};
}

Result<TownRecipe> make_recipe(const TownOptions& o, std::vector<std::string>& notes) {
  if (auto r = check_town(o); !r) return forward_error(r);
  TownRecipe recipe;
  recipe.grid = o.grid;
  recipe.spacing_m = o.spacing_m;
  recipe.ground = o.ground;
  recipe.seed = o.seed;
  const std::uint64_t buildings = std::uint64_t{o.grid.x} * o.grid.y;
  if (auto r = check_count({buildings, 0, 0}, "--grid"); !r) return forward_error(r);

  Result<BuildingPlan> plan = plan_building(o, notes);
  if (!plan) return forward_error(plan);
  recipe.plan = *plan;
  recipe.building_m = glm::dvec2(plan->size_mm) * 0.001;
  if (!o.building_model.empty()) {
    Result<Scene> model = read_model(o.building_model, "--building-model", notes);
    if (!model) return forward_error(model);
    const glm::dvec3 size(model_bounds(*model).size());
    recipe.building_m = {size.x, size.z};
    recipe.building_model = std::move(*model);
  }
  if (auto r = check_extent(o, recipe.building_m.x, recipe.building_m.y); !r) return forward_error(r);
  if (auto r = choose_extras(o, recipe, notes); !r) return forward_error(r);
  const std::uint64_t of_model =
      recipe.extra_model ? std::max<std::uint64_t>(1, recipe.extra_model->objects.size()) : 1;
  const double extras =
      static_cast<double>(buildings) * o.floors * o.extras_per_floor * static_cast<double>(of_model);
  if (extras > static_cast<double>(limits::kMaxObjects)) {
    return fail(ErrorKind::usage, "--extras",
                "more than " + std::to_string(limits::kMaxObjects) + " objects; nearest " +
                    std::to_string(limits::kMaxObjects / (buildings * o.floors * of_model)));
  }
  if (recipe.building_model) {
    if (recipe.building_model->objects.size() > limits::kMaxObjects / buildings) {
      return fail(ErrorKind::usage, "--grid",
                  "more than " + std::to_string(limits::kMaxObjects) + " objects; take fewer buildings");
    }
  } else if (auto r = lay_out(o, recipe, notes); !r) {
    return forward_error(r);
  }
  Result<MachinePlan> machines = plan_machines(recipe, o.machines, height_m(recipe));
  if (!machines) return forward_error(machines);
  recipe.machines = std::move(*machines);
  if (auto r = check_count(predict(recipe), "--extras"); !r) return forward_error(r);
  return recipe;
}

}  // namespace

Result<Generated> generate_town(const TownOptions& options) {
  std::vector<std::string> notes;
  Result<TownRecipe> recipe = make_recipe(options, notes);
  if (!recipe) return forward_error(recipe);
  return build_town(*recipe, std::move(notes));
}

Result<Prediction> predict_town(const TownOptions& options) {
  std::vector<std::string> notes;
  Result<TownRecipe> recipe = make_recipe(options, notes);
  if (!recipe) return forward_error(recipe);
  return predict(*recipe);
}

}  // namespace scenegen::gen
