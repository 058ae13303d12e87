#include "tools/experiments/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gen/camera.h"
#include "gen/primitives.h"
#include "scene/random.h"
#include "timeline/appearance.h"
#include "timeline/profiles.h"
#include "tools/experiments/paper.h"

namespace scenegen::tools {
namespace {

/// How a stand-in is made.
struct Recipe {
  std::uint32_t floors = 1;
  double length_over_width = 1;
  double bricks = 0.6;  ///< share of objects
  double outdoors = 0;  ///< share of the others that stand outside
  std::uint32_t planes = 0;
  bool windows = true, partitions = true;
};
constexpr std::array<Recipe, 4> kRecipes{{{2, 2.0, 0.6, 0.1, 0, true, true},
                                          {4, 1.3, 0.55, 0.2, 6, true, true},
                                          {5, 1.6, 0.4, 0.9, 2, true, false},
                                          {14, 1.2, 0.6, 0.0, 0, true, true}}};

std::uint64_t sphere_vertices(std::uint32_t slices) {
  return 6ULL * slices * (slices / 2 - 1);
}

/// The largest building of the recipe's form with at most `most` objects.
Result<gen::TownOptions> fit_building(const Recipe& recipe, std::uint64_t most, std::uint64_t seed) {
  gen::TownOptions o;
  o.floors = recipe.floors;
  o.windows = recipe.windows;
  o.partitions = recipe.partitions;
  o.roof = gen::Roof::flat;
  o.seed = seed;
  const auto sized = [&](std::uint32_t width) {
    gen::TownOptions at = o;
    at.building_bricks = {width, static_cast<std::uint32_t>(std::lround(width * recipe.length_over_width))};
    return at;
  };
  std::uint32_t low = 6;
  std::uint32_t high = 400;
  while (low + 1 < high) {
    const std::uint32_t middle = (low + high) / 2;
    auto predicted = gen::predict_town(sized(middle));
    if (!predicted) return forward_error(predicted);
    (predicted->objects <= most ? low : high) = middle;
  }
  o = sized(low);
  // What is too little even so has fewer floors.
  for (auto p = gen::predict_town(o); p && p->objects > most && o.floors > 1; p = gen::predict_town(o))
    --o.floors;
  return o;
}

/// A mesh of the scene's sphere material with another sphere.
MeshId sphere_mesh(Scene& scene, MaterialId material, std::uint32_t slices, const char* name) {
  scene.geometries.push_back(gen::uv_sphere(slices, slices / 2));
  scene.meshes.push_back({name, {{GeometryId(scene.geometries.size() - 1), material}}});
  return MeshId(scene.meshes.size() - 1);
}

MaterialId paint(Scene& scene, const char* name, const glm::vec3& color) {
  Material m;
  m.name = name;
  m.base_color = glm::vec4(color, 1.0F);
  m.metallic = 0;
  m.roughness = 0.7F;
  scene.materials.push_back(m);
  return MaterialId(scene.materials.size() - 1);
}

/// Large thin boxes that stand round the building.
void add_planes(gen::Generated& out, const Box& building, std::uint32_t count) {
  Scene& scene = out.scene;
  scene.geometries.push_back(gen::unit_box_unindexed(true));
  const MaterialId material = paint(scene, "plan", {0.62F, 0.66F, 0.7F});
  scene.meshes.push_back({"plan", {{GeometryId(scene.geometries.size() - 1), material}}});
  const glm::vec3 size = building.size();
  for (std::uint32_t i = 0; i < count; ++i) {
    Transform t;
    t.scale = {1.2F * size.x, 0.2F, 0.9F * size.z};
    t.translation_m = building.centre() + glm::vec3((i % 2 == 0 ? -1.35F : 1.35F) * size.x, 0,
                                                    (static_cast<float>(i - i % 2) / 2.0F - 1.0F) * size.z);
    t.translation_m.y = building.lo.y + 0.2F;
    scene.objects.add("plan_" + std::to_string(i), MeshId(scene.meshes.size() - 1), t);
  }
}

/// Equipment: `count` spheres, inside the building or on the ground round it.
struct Equipment {
  std::uint64_t count = 0, outdoors = 0;
  std::array<MeshId, 3> plain{}, finer{};
  std::uint64_t finer_count = 0;  ///< of the first ones
};

/// Place `i` of open racks beside the building, row behind row: most of what is in them can be seen.
glm::vec3 place_in_racks(const Box& building, std::uint64_t i) {
  constexpr float kPitch = 1.0F;
  constexpr std::uint64_t kDeep = 3;
  const glm::vec3 size = building.size();
  const auto high = std::max<std::uint64_t>(2, static_cast<std::uint64_t>(0.5F * size.y / kPitch));
  const auto along = std::max<std::uint64_t>(4, static_cast<std::uint64_t>(1.5F * size.z / kPitch));
  const std::uint64_t in_rack = i % (kDeep * high * along);
  const std::uint64_t rack = i / (kDeep * high * along);
  const std::uint64_t level = in_rack / kDeep % high;
  const std::uint64_t column = in_rack / kDeep / high;
  const float beside = 4.0F + kPitch * static_cast<float>(in_rack % kDeep) + 7.0F * static_cast<float>(rack);
  return {building.hi.x + beside, building.lo.y + 0.5F + kPitch * static_cast<float>(level),
          building.lo.z + kPitch * static_cast<float>(column)};
}

void add_equipment(gen::Generated& out, const Box& building, const Equipment& what, std::uint64_t seed) {
  Scene& scene = out.scene;
  const Random random(seed, "equipment");
  const glm::vec3 size = building.size();
  for (std::uint64_t i = 0; i < what.count; ++i) {
    Transform t;
    const std::uint64_t at = 8 * i;
    t.scale = glm::vec3(0.25F + 0.35F * random.unit(at));
    if (i < what.outdoors) {
      t.scale *= 1.4F;
      t.translation_m = place_in_racks(building, i);
    } else {
      for (int k = 0; k < 3; ++k) {
        const float share = random.unit(at + 1 + static_cast<std::uint64_t>(k));
        t.translation_m[k] = building.lo[k] + 1.0F + (size[k] - 2.0F) * share;
      }
    }
    const auto& meshes = i < what.finer_count ? what.finer : what.plain;
    scene.objects.add("part_" + std::to_string(i), meshes[random.below(at + 5, 3)], t);
  }
  out.exempt.resize(scene.objects.size(), 0);
}

/// Round the walls, without what lies flat on the ground about them.
Box walls_of(const gen::Generated& generated) {
  Box out;
  const std::vector<Box> boxes = object_bounds(generated.scene);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (generated.exempt[i] == 0 && boxes[i].lo.y > 0.5F && boxes[i].size().x < 3) out.add(boxes[i]);
  }
  out.lo.y = 0;
  return out;
}

Box bounds_of(const Scene& scene, const std::vector<std::uint8_t>* exempt = nullptr) {
  Box out;
  const std::vector<Box> boxes = object_bounds(scene);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (exempt == nullptr || (*exempt)[i] == 0) out.add(boxes[i]);
  }
  return out;
}

/// Meshes for as many vertices as are wanted: spheres of some slices, and as many finer ones as it takes.
Equipment equipment_for(Scene& scene, std::uint64_t count, std::uint64_t vertices) {
  Equipment out;
  out.count = count;
  if (count == 0) return out;
  std::uint32_t slices = 6;
  while (slices < 400 && sphere_vertices(slices + 2) * count <= vertices) slices += 2;
  const std::uint64_t step = sphere_vertices(slices + 2) - sphere_vertices(slices);
  const std::uint64_t left = vertices - std::min(vertices, sphere_vertices(slices) * count);
  out.finer_count = std::min(count, left / step);
  const std::array<MaterialId, 3> paints{paint(scene, "steel", {0.45F, 0.5F, 0.55F}),
                                         paint(scene, "pipes", {0.2F, 0.36F, 0.6F}),
                                         paint(scene, "tanks", {0.75F, 0.55F, 0.2F})};
  for (std::size_t k = 0; k < 3; ++k) {
    out.plain[k] = sphere_mesh(scene, paints[k], slices, "part");
    out.finer[k] = sphere_mesh(scene, paints[k], slices + 2, "fine part");
  }
  return out;
}

}  // namespace

Result<gen::Generated> stand_in(int set, double share, std::uint64_t seed) {
  const Recipe& recipe = kRecipes.at(static_cast<std::size_t>(set - 1));
  const PaperTable sets("test_sets");
  const PaperTable::Where row{{"set", std::to_string(set)}};
  const auto objects = static_cast<std::uint64_t>(std::llround(share * *sets.number(row, "objects")));
  const auto vertices = static_cast<std::uint64_t>(std::llround(share * *sets.number(row, "vertices")));
  auto options =
      fit_building(recipe, static_cast<std::uint64_t>(recipe.bricks * static_cast<double>(objects)), seed);
  if (!options) return forward_error(options);
  auto made = gen::generate_town(*options);
  if (!made) return forward_error(made);
  Scene& scene = made->scene;
  const Box building = walls_of(*made);
  add_planes(*made, building, recipe.planes);
  const std::uint64_t so_far = scene.objects.size();
  if (so_far < objects) {
    const std::uint64_t there = drawn_vertices(scene);
    Equipment equipment = equipment_for(scene, objects - so_far, vertices - std::min(vertices, there));
    equipment.outdoors = static_cast<std::uint64_t>(recipe.outdoors * static_cast<double>(equipment.count));
    add_equipment(*made, building, equipment, seed);
  }
  made->exempt.resize(scene.objects.size(), 0);
  scene.cameras.assign(1, gen::framing_camera(bounds_of(scene, &made->exempt), 0.6F, 0.45F));
  return made;
}

Result<gen::Generated> buildings_with_boxes(bool small, std::uint64_t seed) {
  if (!small) return gen::generate_test_set(32, seed);
  gen::TownOptions o;
  o.grid = {3, 3};
  o.brick_m = {1.0, 0.5, 0.7};
  o.building_bricks = {8, 8};
  o.floor_courses = 4;
  o.floors = 4;
  o.partitions = false;
  o.windows = false;
  o.roof = gen::Roof::flat;
  o.ground = false;
  o.extras_per_floor = 40;
  o.seed = seed;
  return gen::generate_town(o);
}

Result<void> animate_as_project(gen::Generated& generated, std::uint64_t seed) {
  Scene& scene = generated.scene;
  timeline::AppearanceOptions how;
  how.coherence = 0.95;
  how.seed = seed;
  const auto info = timeline::assign_appearance(scene, how, generated.exempt);
  if (!info) return tl::unexpected<Error>(info.error());
  std::vector<ObjectId> lasting;
  std::vector<ObjectId> passing;
  const Random random(seed, "temporary");
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    if (!scene.objects.visibility[i].valid()) continue;
    (random.below(i, 20) == 0 ? passing : lasting).emplace_back(i);
  }
  std::vector<timeline::Activity> activities =
      timeline::activities_of_appearance(scene, {timeline::Profile::construct, 0, glm::vec3(0.0F)}, lasting);
  const double long_s = 4 * timeline::default_activity_s(*info);
  if (!passing.empty()) {
    const auto temporary = timeline::activities_of_appearance(
        scene, {timeline::Profile::temporary, long_s, glm::vec3(0.0F)}, passing);
    activities.insert(activities.end(), temporary.begin(), temporary.end());
  }
  auto applied = timeline::apply_curve_profiles(scene, activities, {});
  if (!applied) return forward_error(applied);
  return {};
}

Scene random_boxes(std::uint32_t count, std::uint64_t seed) {
  Scene scene;
  scene.geometries.push_back(gen::unit_box_unindexed(true));
  std::vector<MeshId> meshes;
  for (const glm::vec3& color : {glm::vec3(0.7F, 0.3F, 0.2F), glm::vec3(0.3F, 0.5F, 0.7F),
                                 glm::vec3(0.8F, 0.7F, 0.4F), glm::vec3(0.5F, 0.55F, 0.5F)}) {
    scene.meshes.push_back({"box", {{GeometryId(0), paint(scene, "paint", color)}}});
    meshes.emplace_back(scene.meshes.size() - 1);
  }
  scene.objects.reserve(count, count * 10ULL);
  // As test sets 5 to 13: one box to a cell of a unit grid on the average, sizes of a quarter to nine tenths.
  const float side = std::cbrt(static_cast<float>(count));
  const Random random(seed, "random boxes");
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint64_t at = 8ULL * i;
    Transform t;
    for (int k = 0; k < 3; ++k) {
      t.translation_m[k] = side * random.unit(at + static_cast<std::uint64_t>(k));
      t.scale[k] = 0.25F + 0.65F * random.unit(at + 3 + static_cast<std::uint64_t>(k));
    }
    scene.objects.add("box_" + std::to_string(i), meshes[random.below(at + 6, meshes.size())], t);
  }
  scene.cameras.push_back(gen::framing_camera(bounds_of(scene), 0.6F, 0.5F));
  return scene;
}

Scene box_grid(std::uint32_t side) {
  Scene scene;
  scene.geometries.push_back(gen::unit_box_unindexed(true));
  scene.meshes.push_back({"box", {{GeometryId(0), paint(scene, "paint", {0.4F, 0.55F, 0.7F})}}});
  for (std::uint32_t i = 0; i < side * side * side; ++i) {
    Transform t;
    t.scale = glm::vec3(0.4F);
    t.translation_m = glm::vec3(i % side, i / side % side, i / side / side);
    scene.objects.add("box_" + std::to_string(i), MeshId(0), t);
  }
  scene.cameras.push_back(gen::framing_camera(bounds_of(scene), 0.6F, 0.5F));
  return scene;
}

std::uint64_t drawn_vertices(const Scene& scene) {
  std::uint64_t sum = 0;
  for (const MeshId mesh : scene.objects.mesh) {
    if (!mesh.valid()) continue;
    for (const Primitive& p : scene.meshes[mesh.value].primitives)
      sum += scene.geometries[p.geometry.value].drawn_vertex_count();
  }
  return sum;
}

std::string stand_in_name(int set) {
  return "stand-in for set " + std::to_string(set);
}

}  // namespace scenegen::tools
