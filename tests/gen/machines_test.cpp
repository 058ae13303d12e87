#include "gen/machines.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "gen/generate.h"
#include "gen/machine_shapes.h"
#include "scene/validate.h"
#include "timeline/appearance.h"
#include "timeline/player.h"

namespace scenegen::gen {
namespace {

TownOptions town(glm::uvec2 grid, std::uint32_t machines) {
  TownOptions o;
  o.grid = grid;
  o.machines = machines;
  return o;
}

Generated driven(const TownOptions& options, double coherence = 1) {
  auto made = generate_town(options);
  if (!made) FAIL(made.error().str());
  timeline::AppearanceOptions appearance;
  appearance.cells = {8, 8, 8};
  appearance.interval_s = 0.05;
  appearance.coherence = coherence;
  REQUIRE(timeline::assign_appearance(made->scene, appearance, made->exempt));
  drive_machines(made->scene, made->machines, 1);
  return std::move(*made);
}

bool is_machine(std::string_view name) {
  return name.starts_with("crane_") || name.starts_with("lorry_");
}

ObjectId object(const Scene& scene, std::string_view name) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects.names[i] == name) return ObjectId(i);
  }
  FAIL("no object " << name);
  return {};
}

struct Rectangle {
  glm::vec2 lo, hi;  // x and z
  [[nodiscard]] bool holds(const glm::vec2& p) const {
    return p.x > lo.x && p.x < hi.x && p.y > lo.y && p.y < hi.y;
  }
};

/// What is higher than a kerb (0.3 m): walls, and cranes' feet.
std::vector<Rectangle> obstacles(const Scene& scene) {
  std::map<std::string, Box> of_building;
  const std::vector<Box> boxes = object_bounds(scene);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const std::string name(scene.objects.names[i]);
    const bool foot = name.ends_with("/base");
    if ((!name.starts_with("building_") && !foot) || boxes[i].hi.y < 0.3F) continue;
    if (boxes[i].lo.y > 3 || name.find("roof") != std::string::npos) continue;
    of_building[name.substr(0, name.find('/'))].add(boxes[i]);
  }
  std::vector<Rectangle> out;
  out.reserve(of_building.size());
  for (const auto& [name, box] : of_building) out.push_back({{box.lo.x, box.lo.z}, {box.hi.x, box.hi.z}});
  return out;
}

glm::vec2 flat(const glm::vec4& v) {
  return {v.x, v.z};
}

}  // namespace

TEST_CASE("machines join a town that stays as it was") {
  const auto without = generate_town(town({3, 2}, 0));
  const Generated with = driven(town({3, 2}, 7));
  REQUIRE(without);
  CHECK(validate(with.scene).empty());
  const auto& old = without->scene.objects;
  const auto& now = with.scene.objects;
  REQUIRE(now.size() > old.size());
  CHECK(
      std::equal(old.frame_from_object.begin(), old.frame_from_object.end(), now.frame_from_object.begin()));
  std::set<std::string> machines;
  std::size_t frameless = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const std::string name(now.names[i]);
    CHECK((i >= old.size()) == is_machine(name));
    if (i < old.size()) continue;
    CHECK(with.exempt[i] == 1);
    machines.insert(name.substr(0, name.find('/')));
    frameless += now.frame[i].valid() ? 0 : 1;
  }
  CHECK(machines == std::set<std::string>{"crane_00", "crane_01", "crane_02", "lorry_00", "lorry_01",
                                          "lorry_02", "lorry_03"});
  // H: upper works and lorries are dynamic; feet and masts of cranes are static like the ground.
  const auto counts = timeline::compile(with.scene)->class_counts();
  CHECK(counts.constant == 2 + frameless);
  CHECK(counts.dynamic == now.size() - old.size() - frameless);
  // Geometry is shared.
  CHECK(with.scene.geometries.size() == without->scene.geometries.size() + 18);
}

TEST_CASE("what machines add is predicted") {
  for (const std::uint32_t machines : {1U, 2U, 5U, 12U}) {
    const TownOptions options = town({4, 3}, machines);
    const auto made = generate_town(options);
    const auto predicted = predict_town(options);
    REQUIRE(made);
    REQUIRE(predicted);
    std::uint64_t vertices = 0, triangles = 0;
    for (const MeshId mesh : made->scene.objects.mesh) {
      for (const Primitive& p : made->scene.meshes[mesh.value].primitives) {
        vertices += made->scene.geometries[p.geometry.value].drawn_vertex_count();
        triangles += made->scene.geometries[p.geometry.value].triangle_count();
      }
    }
    CHECK(predicted->objects == made->scene.objects.size());
    CHECK(predicted->vertices == vertices);
    CHECK(predicted->triangles == triangles);
    CHECK(made->machines.cranes.size() == (machines + 2) / 3);
    CHECK(made->machines.cranes.size() + made->machines.lorries.size() == machines);
  }
}

TEST_CASE("shapes are closed and face outwards") {
  // Every solid encloses a positive volume (divergence theorem), its normals agree with its triangles.
  for (const Geometry& g : {crane_base(1), crane_mast(1, 2), crane_head(1, 20), crane_cab(1),
                            crane_jib(1, 20), crane_counter_jib(1, 20), crane_counterweight(1, 20),
                            crane_trolley(1), crane_cable(1), crane_hook(1), lorry_chassis(1), lorry_cab(1),
                            lorry_glass(1), lorry_bed(1), lorry_load(1), lorry_tyre(1), lorry_hub(1)}) {
    double volume = 0;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < g.indices.size(); i += 3) {
      const glm::vec3 a = g.positions_m[g.indices[i]], b = g.positions_m[g.indices[i + 1]],
                      c = g.positions_m[g.indices[i + 2]];
      volume += static_cast<double>(glm::dot(a, glm::cross(b, c))) / 6;
      const glm::vec3 face = glm::cross(b - a, c - a);
      for (std::size_t k = 0; k < 3; ++k) wrong += glm::dot(face, g.normals[g.indices[i + k]]) > 0 ? 0 : 1;
    }
    CHECK(volume > 0);
    CHECK(wrong == 0);
  }
}

TEST_CASE("lorries keep to the streets, drive forwards and roll") {
  for (const glm::uvec2 grid : {glm::uvec2(1, 1), glm::uvec2(4, 3), glm::uvec2(2, 7)}) {
    const Generated made = driven(town(grid, grid.x == 1 ? 5 : 6));
    const Scene& scene = made.scene;
    const std::vector<Rectangle> walls = obstacles(scene);
    timeline::Player player(timeline::compile(scene));
    const std::size_t lorries = made.machines.lorries.size();
    REQUIRE(lorries >= 3);
    std::vector<ObjectId> bodies, wheels;
    for (std::size_t i = 0; i < lorries; ++i) {
      bodies.push_back(object(scene, "lorry_0" + std::to_string(i) + "/chassis"));
      wheels.push_back(object(scene, "lorry_0" + std::to_string(i) + "/wheel_1_left"));
    }
    const double end_s = scene.duration_s;
    constexpr int kSteps = 1500;
    std::vector<glm::vec2> before(lorries);
    std::vector<double> driven_m(lorries, 0), rolled(lorries, 0);
    std::vector<float> angle_before(lorries, 0);
    int in_walls = 0, collisions = 0, sideways = 0;
    for (int step = 0; step <= kSteps; ++step) {
      player.seek(end_s * step / kSteps);
      for (std::size_t i = 0; i < lorries; ++i) {
        const glm::mat4 world = player.world_from_object(bodies[i]);
        const glm::vec2 at = flat(world[3]);
        for (int k = 0; k < 40; ++k) {  // along the outline
          const float u = static_cast<float>(k) / 39.0F - 0.5F;
          const glm::vec4 p(u * kLorryLength, 1, (k % 2 == 0 ? 0.5F : -0.5F) * kLorryWidth, 1);
          for (const Rectangle& wall : walls) in_walls += wall.holds(flat(world * p)) ? 1 : 0;
        }
        for (std::size_t k = 0; k < i; ++k)
          collisions +=
              glm::distance(at, flat(player.world_from_object(bodies[k])[3])) > kLorryLength ? 0 : 1;
        const glm::mat4 in_lorry = glm::inverse(world) * player.world_from_object(wheels[i]);
        const float angle = std::atan2(in_lorry[0].y, in_lorry[0].x);  // of a spoke, about the axle
        if (step > 0) {
          const glm::vec2 way = at - before[i];
          driven_m[i] += static_cast<double>(glm::length(way));
          if (glm::length(way) > 1e-4F && glm::dot(glm::normalize(way), flat(world[0])) < 0.9F) ++sideways;
          float turned = angle_before[i] - angle;
          turned -= 6.2831853F * std::floor(turned / 6.2831853F);
          rolled[i] += static_cast<double>(turned);
        }
        before[i] = at;
        angle_before[i] = angle;
      }
    }
    CHECK(in_walls == 0);
    CHECK(collisions == 0);
    CHECK(sideways == 0);
    for (std::size_t i = 0; i < lorries; ++i) {
      CHECK(driven_m[i] > 30);
      CHECK(rolled[i] * static_cast<double>(kWheelRadius) == Approx(driven_m[i]).epsilon(0.02));
    }
  }
}

TEST_CASE("cranes turn to the work above the roofs") {
  const Generated made = driven(town({4, 3}, 7), 0.95);
  const Scene& scene = made.scene;
  REQUIRE(made.machines.cranes.size() == 3);
  timeline::Player player(timeline::compile(scene));
  const std::vector<Box> boxes = object_bounds(scene);
  float roofs_m = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!is_machine(scene.objects.names[i])) roofs_m = std::max(roofs_m, boxes[i].hi.y);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      CHECK(glm::distance(made.machines.cranes[a].top_m, made.machines.cranes[b].top_m) >
            made.machines.plan.reach_m + 1);
    }
  }
  int looks = 0, right = 0, hits = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string name = "crane_0" + std::to_string(c);
    const ObjectId jib = object(scene, name + "/jib"), hook = object(scene, name + "/hook");
    const ObjectId cable = object(scene, name + "/cable");
    const float window_s = scene.duration_s / 60;
    glm::vec2 before(0);
    for (int step = 0; step < 240; ++step) {
      const double t = static_cast<double>(scene.duration_s) * step / 240;
      player.seek(t);
      const glm::mat4 world = player.world_from_object(jib);
      CHECK(world[3].y > roofs_m);  // the foot of the jib
      const glm::vec2 top = flat(world[3]), way = glm::normalize(flat(world[0]));
      // It turns, it does not jump.
      if (step > 0) CHECK(glm::dot(before, way) > 0.2F);
      before = way;
      const glm::vec4 at = player.world_from_object(hook)[3];
      CHECK(glm::distance(flat(at), top) < made.machines.plan.reach_m);
      CHECK(glm::dot(glm::normalize(flat(at) - top), way) > 0.999F);  // below the jib
      // The cable ends where the hook hangs.
      CHECK(glm::distance(player.world_from_object(cable) * glm::vec4(0, -1, 0, 1), at) < 0.2F);
      // Nothing that stands is as high as the hook where it hangs; there is work where it points to.
      glm::vec2 sum(0);
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (is_machine(scene.objects.names[i])) continue;
        const glm::vec2 middle(boxes[i].centre().x, boxes[i].centre().z);
        const bool below = player.visible(ObjectId(i)) && glm::distance(middle, flat(at)) < 1.5F;
        if (below && boxes[i].hi.y > at.y - 1) ++hits;
        const TrackId track = scene.objects.visibility[i];
        if (!track.valid() || std::abs(scene.times_s(track).back() - static_cast<float>(t)) > window_s)
          continue;
        float nearest = 1e9F;
        for (const Crane& other : made.machines.cranes)
          nearest = std::min(nearest, glm::distance(middle, {other.top_m.x, other.top_m.z}));
        const float own = glm::distance(middle, top);
        if (own == nearest && own < made.machines.plan.reach_m) sum += middle - top;
      }
      if (glm::length(sum) < 100) continue;  // some hundred objects' worth of one direction
      ++looks;
      if (glm::dot(glm::normalize(sum), way) > 0.8F) ++right;
    }
  }
  CHECK(hits == 0);
  CHECK(looks > 60);
  CHECK(right > looks * 3 / 4);
}

TEST_CASE("towns without room for machines say so") {
  TownOptions narrow = town({2, 2}, 3);
  narrow.spacing_m = 3;
  const auto no_streets = generate_town(narrow);
  REQUIRE_FALSE(no_streets);
  CHECK(no_streets.error().str() ==
        "--spacing: lorries need streets of 5.2 m between buildings for --machines");
  const auto crowded = generate_town(town({1, 1}, 60));
  REQUIRE_FALSE(crowded);
  CHECK_THAT(crowded.error().str(),
             Catch::Matchers::StartsWith("--machines: 60: the town has room for 4 cranes") &&
                 Catch::Matchers::Contains("nearest"));
  // What it says is nearest does fit.
  const std::string text = crowded.error().what;
  const auto nearest = static_cast<std::uint32_t>(std::stoul(text.substr(text.rfind(' '))));
  CHECK(generate_town(town({1, 1}, nearest)));
  CHECK_FALSE(generate_town(town({1, 1}, nearest + 1)));
}

TEST_CASE("a doll's town has a doll's machines") {
  TownOptions doll = town({2, 2}, 3);
  doll.brick_m *= 0.1;
  doll.spacing_m *= 0.1;
  doll.window_m *= 0.1;
  const Generated made = driven(doll);
  CHECK(made.machines.plan.scale == Approx(0.1));
  CHECK(made.machines.plan.reach_m < 3);
  CHECK(validate(made.scene).empty());
}

}  // namespace scenegen::gen
