// Test sets 5 … 48 of D's table 1, from recipes that give its counts exactly (METHODS 2).
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "gen/building.h"
#include "gen/camera.h"
#include "gen/generate.h"
#include "gen/palette.h"
#include "gen/primitives.h"
#include "gen/town.h"
#include "scene/random.h"

namespace scenegen::gen {
namespace {

constexpr std::array<std::uint32_t, 9> kBoxes{1000,   10000,  40000,  60000, 80000,
                                              100001, 120000, 150000, 180000};  // 5 … 13

struct SphereSet {
  std::uint32_t slices, stacks;
};
constexpr std::array<SphereSet, 9> kSpheres{
    {{9, 4}, {16, 8}, {22, 11}, {35, 17}, {46, 23}, {79, 39}, {145, 72}, {112, 56}, {200, 100}}};  // 14 … 22
constexpr std::uint32_t kSphereCount = 256;

constexpr std::array<std::uint32_t, 8> kTextured{4, 8, 16, 32, 64, 96, 192, 384};  // 41 … 48

constexpr std::array<Look, 5> kBoxLooks{Look::cargo, Look::tile_red, Look::stone, Look::door, Look::plaster};

bool in(int set, int first, int last) {
  return set >= first && set <= last;
}

Result<void> check_set(int set) {
  if (in(set, 5, 48)) return {};
  if (in(set, 1, 4)) {
    return fail(ErrorKind::usage, "--test-set",
                std::to_string(set) +
                    ": sets 1 to 4 are private models of the paper's authors; allowed 5 to 48, nearest 5");
  }
  return fail(
      ErrorKind::usage, "--test-set",
      std::to_string(set) + " is out of range; allowed 5 to 48, nearest " + std::to_string(set < 5 ? 5 : 48));
}

void add_numbered(Scene& scene, const char* kind, std::size_t number, MeshId mesh, const Transform& t) {
  std::string digits = std::to_string(number);
  if (digits.size() < 6) digits.insert(0, 6 - digits.size(), '0');
  scene.objects.add(std::string(kind) + "_" + digits, mesh, t);
}

void finish(Generated& out, std::uint64_t seed, float azimuth_slope, float elevation_slope) {
  Scene& scene = out.scene;
  Box bounds;
  for (const Box& b : object_bounds(scene)) bounds.add(b);
  scene.cameras.push_back(framing_camera(bounds, azimuth_slope, elevation_slope));
  scene.info.generator = "scenegen " SCENEGEN_VERSION;
  scene.info.seed = seed;
  out.exempt.assign(scene.objects.size(), 0);
}

/// Boxes of random size, one in each of randomly chosen cells of a cube of cells: spread, all in view.
Generated random_boxes(std::uint32_t count, std::uint64_t seed) {
  Generated out;
  Palette palette(out.scene, unit_box_unindexed(false), {500, 250, 200});
  out.scene.objects.reserve(count, count * 10ULL);
  std::uint32_t side = 1;
  while (side * side * side < count) ++side;
  std::vector<std::uint32_t> cells(std::size_t{side} * side * side);
  std::iota(cells.begin(), cells.end(), 0U);
  const Random random(seed, "boxes");
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint64_t first = 8ULL * i;
    std::swap(cells[i], cells[i + random.below(first, cells.size() - i)]);
    const std::uint32_t c = cells[i];
    Transform t;
    for (int k = 0; k < 3; ++k) {
      t.scale[k] = 0.25F + 0.65F * random.unit(first + 1 + static_cast<std::uint64_t>(k));
      const float room = 1.0F - t.scale[k];
      const auto cell = static_cast<float>(k == 0 ? c % side : k == 1 ? c / side % side : c / side / side);
      t.translation_m[k] =
          cell + 0.5F * t.scale[k] + room * random.unit(first + 4 + static_cast<std::uint64_t>(k));
    }
    const Look look = kBoxLooks[random.below(first + 7, kBoxLooks.size())];
    add_numbered(out.scene, "box", i, palette.box(look), t);
  }
  finish(out, seed, 0.6F, 0.5F);
  return out;
}

/// 16 x 16 spheres of slightly different size, rows and columns seen from above.
Generated spheres(const SphereSet& shape, std::uint64_t seed) {
  Generated out;
  Palette palette(out.scene, uv_sphere(shape.slices, shape.stacks), {500, 250, 200});
  const Random random(seed, "spheres");
  for (std::uint32_t i = 0; i < kSphereCount; ++i) {
    const std::uint32_t column = i % 16, row = i / 16;
    Transform t;
    t.scale = glm::vec3(0.6F + 0.35F * random.unit(2ULL * i));
    t.translation_m = {static_cast<float>(column), 0.5F * t.scale.y, static_cast<float>(row)};
    add_numbered(out.scene, "sphere", i, palette.box(kBoxLooks[random.below(2ULL * i + 1, kBoxLooks.size())]),
                 t);
  }
  finish(out, seed, 0.45F, 0.8F);
  return out;
}

/// Closed boxes of walls: a floor is 120 bricks (8 x 8 brick lengths, 4 courses of 30) and the slab above
/// them.
TownRecipe buildings(int set, std::uint64_t seed) {
  const bool has_spheres = set >= 33;
  TownRecipe recipe;
  recipe.grid = {10, 10};
  recipe.spacing_m = 6;
  recipe.ground = false;
  recipe.unindexed_boxes = true;
  recipe.seed = seed;
  BuildingPlan& plan = recipe.plan;
  plan.brick_mm = {1000, 500, 700};
  plan.size_mm = {8000, 8000};
  plan.floor_courses = 4;
  plan.floors = has_spheres ? 6 : 10;
  plan.margin_mm = 0;
  plan.fitted = false;
  plan.partitions = false;
  plan.slab_on_top = true;
  plan.roof = Roof::none;
  recipe.building_m = {8, 8};
  recipe.extras_per_floor = static_cast<std::uint32_t>(has_spheres ? set - 33 : 10 * (set - 23));
  if (has_spheres) {
    recipe.extra = ExtraKind::sphere;
    recipe.sphere_slices = 102;
    recipe.sphere_stacks = 51;
    recipe.extra_size_m = glm::dvec3(1.0);
  } else {
    recipe.extra_size_m = glm::dvec3(0.5);
  }
  build_building(plan, 1'000'000, recipe.layouts.emplace_back());
  return recipe;
}

/// A wall of textured boxes in rows, filling the picture.
Generated textured_boxes(std::uint32_t count, std::uint64_t seed) {
  Generated out;
  // Regions of the brick texture, as in the town: every face shows brick and mortar.
  Palette palette(out.scene, unit_box_unindexed(false), {500, 250, 200});
  std::uint32_t rows = 1;
  while (rows * rows * 2 < count) rows *= 2;
  while (count % rows != 0) rows /= 2;
  const std::uint32_t columns = count / rows;
  const Random random(seed, "textured boxes");
  for (std::uint32_t i = 0; i < count; ++i) {
    constexpr std::array<Look, 3> kBricks{Look::brick_red, Look::brick_dark, Look::brick_pale};
    const std::uint32_t column = i % columns, row = i / columns;
    Transform t;
    t.scale = {0.9F, 0.6F, 0.45F};
    t.translation_m = {static_cast<float>(column), 0.7F * static_cast<float>(row),
                       0.25F * random.unit(2ULL * i)};
    add_numbered(out.scene, "box", i, palette.box(kBricks[random.below(2ULL * i + 1, kBricks.size())]), t);
  }
  finish(out, seed, 0.2F, 0.15F);
  return out;
}

}  // namespace

Result<Generated> generate_test_set(int set, std::uint64_t seed) {
  if (auto r = check_set(set); !r) return forward_error(r);
  const auto of = [&](int first) { return static_cast<std::size_t>(set - first); };
  if (in(set, 5, 13)) return random_boxes(kBoxes[of(5)], seed);
  if (in(set, 14, 22)) return spheres(kSpheres[of(14)], seed);
  if (in(set, 23, 40)) return build_town(buildings(set, seed), {});
  return textured_boxes(kTextured[of(41)], seed);
}

Result<Prediction> predict_test_set(int set) {
  if (auto r = check_set(set); !r) return forward_error(r);
  const auto of = [&](int first) { return static_cast<std::size_t>(set - first); };
  const auto boxes = [](std::uint64_t count) { return Prediction{count, 36 * count, 12 * count}; };
  if (in(set, 5, 13)) return boxes(kBoxes[of(5)]);
  if (in(set, 14, 22)) {
    const SphereSet& s = kSpheres[of(14)];
    const std::uint64_t triangles = 2ULL * kSphereCount * s.slices * (s.stacks - 1);
    return Prediction{kSphereCount, 3 * triangles, triangles};
  }
  if (in(set, 23, 40)) return predict(buildings(set, 0));
  return boxes(kTextured[of(41)]);
}

}  // namespace scenegen::gen
