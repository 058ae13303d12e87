// Towns: counts, names, placement, determinism and refusals.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <limits>
#include <set>

#include "gen/generate.h"
#include "scene/gltf/write.h"
#include "scene/limits.h"
#include "scene/random.h"
#include "scene/validate.h"

using namespace scenegen;
using namespace scenegen::gen;

namespace {

Prediction counted(const Scene& scene) {
  Prediction sum{scene.objects.size(), 0, 0};
  for (const MeshId mesh : scene.objects.mesh) {
    for (const Primitive& p : scene.meshes[mesh.value].primitives) {
      sum.vertices += scene.geometries[p.geometry.value].drawn_vertex_count();
      sum.triangles += scene.geometries[p.geometry.value].triangle_count();
    }
  }
  return sum;
}

TownOptions random_options(std::uint64_t i) {
  const Random random(17, "town options");
  const auto draw = [&](std::uint64_t k) { return static_cast<double>(random.unit(i * 32 + k)); };
  const auto whole = [&](std::uint64_t k, std::uint64_t n) {
    return static_cast<unsigned>(random.below(i * 32 + k, n));
  };
  TownOptions o;
  o.grid = {1 + whole(0, 5), 1 + whole(1, 5)};
  o.spacing_m = whole(2, 4) == 0 ? 0 : 8 * draw(2);
  o.brick_m.x = 0.2 + 0.8 * draw(3);
  o.brick_m.y = o.brick_m.x * (0.3 + 0.6 * draw(4));
  o.brick_m.z = 0.1 + 0.3 * draw(5);
  o.building_bricks = {4 + whole(6, 10), 4 + whole(7, 10)};
  o.floor_courses = 4 + whole(8, 12);
  o.floors = 1 + whole(9, 4);
  o.partitions = whole(10, 2) == 0;
  o.windows = whole(11, 3) > 0;
  o.window_m = {o.brick_m.x * (1 + draw(12)), o.brick_m.z * 2};
  o.extras_per_floor = whole(13, 3) * 7;
  if (whole(14, 2) == 0) o.extra_model = "sphere:12";
  o.roof = static_cast<Roof>(whole(15, 4));
  o.ground = whole(16, 2) == 0;
  o.seed = i;
  return o;
}

void check_refused(const TownOptions& options, const std::string& option) {
  for (const bool is_prediction : {false, true}) {
    Error error;
    if (is_prediction) {
      const Result<Prediction> r = predict_town(options);
      REQUIRE_FALSE(r);
      error = r.error();
    } else {
      const Result<Generated> r = generate_town(options);
      REQUIRE_FALSE(r);
      error = r.error();
    }
    INFO(error.str());
    CHECK(error.kind == ErrorKind::usage);
    CHECK(error.where == option);
    CHECK(error.what.find('\n') == std::string::npos);
    CHECK(error.what.size() > 10);
  }
}

}  // namespace

TEST_CASE("a prediction equals what is generated") {
  for (std::uint64_t i = 0; i < 40; ++i) {
    INFO("options " << i);
    const TownOptions options = random_options(i);
    const Result<Generated> g = generate_town(options);
    if (!g) FAIL(g.error().str());
    const Prediction said = *predict_town(options), is = counted(g->scene);
    CHECK(said.objects == is.objects);
    CHECK(said.vertices == is.vertices);
    CHECK(said.triangles == is.triangles);
    CHECK(g->exempt.size() == is.objects);
    CHECK(std::count(g->exempt.begin(), g->exempt.end(), 1) == (options.ground ? 2 : 0));
    std::set<std::string_view> names;
    for (std::size_t k = 0; k < g->scene.objects.size(); ++k) names.insert(g->scene.objects.names[k]);
    CHECK(names.size() == is.objects);
    for (const Finding& f : validate(g->scene))
      FAIL_CHECK("rule " << f.rule << " " << f.where << ": " << f.what);
    for (const Transform& t : g->scene.objects.frame_from_object) {
      if (!(t.scale.x > 0 && t.scale.y > 0 && t.scale.z > 0)) FAIL("empty object");
    }
  }
}

TEST_CASE("the default town is what the documents say") {
  TownOptions options;
  options.grid = {4, 4};
  const Generated g = *generate_town(options);
  CHECK(g.notes.empty());
  CHECK(g.scene.objects.size() > 30'000);
  CHECK(g.scene.objects.size() < 45'000);
  CHECK(g.scene.geometries.size() == 3);  // bricks and all else, grass, streets
  std::size_t brick_materials = 0, blended = 0;
  for (const Material& m : g.scene.materials) {
    brick_materials += m.name.starts_with("brick");
    blended += m.alpha_mode == AlphaMode::blend;
  }
  CHECK(brick_materials == 3);
  CHECK(blended == 1);
  bool found = false;
  for (std::size_t i = 0; i < g.scene.objects.size(); ++i)
    found |= g.scene.objects.names[i] == "building_02_03/floor_1/brick_0417";
  CHECK(found);
  CHECK(g.scene.info.seed == 1);
  CHECK(g.scene.info.generator == "scenegen " SCENEGEN_VERSION);
  REQUIRE(g.scene.cameras.size() == 1);
}

TEST_CASE("the camera has the town in view and fills the picture") {
  for (const glm::uvec2 grid : {glm::uvec2(1, 1), glm::uvec2(4, 4), glm::uvec2(9, 2), glm::uvec2(1, 7)}) {
    TownOptions options;
    options.grid = grid;
    options.ground = false;
    const Generated g = *generate_town(options);
    const Camera& camera = g.scene.cameras.at(0);
    const glm::mat4 camera_from_world = glm::inverse(camera.frame_from_camera.matrix());
    const float t = std::tan(camera.yfov_rad / 2);
    float widest = 0;
    for (const Box& b : object_bounds(g.scene)) {
      for (int k = 0; k < 8; ++k) {
        const glm::vec4 corner((k & 1) ? b.hi.x : b.lo.x, (k & 2) ? b.hi.y : b.lo.y,
                               (k & 4) ? b.hi.z : b.lo.z, 1);
        const glm::vec4 p = camera_from_world * corner;
        if (-p.z <= camera.znear_m || -p.z >= camera.zfar_m) FAIL("cut by a clipping plane");
        widest = std::max({widest, std::abs(p.y) / (-p.z * t), std::abs(p.x) / (-p.z * t * 16 / 9)});
      }
    }
    CHECK(widest < 1.0F);
    CHECK(widest > 0.8F);
  }
}

TEST_CASE("extra objects stand in rooms and overlap nothing") {
  for (const char* model : {"box", "sphere:8"}) {
    TownOptions options;
    options.grid = {2, 1};
    options.extras_per_floor = 60;
    options.extra_model = model;
    options.ground = false;
    const Generated g = *generate_town(options);
    const std::vector<Box> boxes = object_bounds(g.scene);
    std::vector<std::size_t> extras;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (g.scene.objects.names[i].find("/extra_") != std::string_view::npos) extras.push_back(i);
    }
    REQUIRE(extras.size() == 2 * 3 * 60);
    constexpr float kSlack = 1e-4F;
    for (const std::size_t e : extras) {
      bool rests = false;
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (i == e || g.scene.objects.names[i].find("/tile") != std::string_view::npos) continue;
        const Box &a = boxes[e], &b = boxes[i];
        const bool over = a.lo.x < b.hi.x - kSlack && b.lo.x < a.hi.x - kSlack && a.lo.z < b.hi.z - kSlack &&
                          b.lo.z < a.hi.z - kSlack;
        if (over && a.lo.y < b.hi.y - kSlack && b.lo.y < a.hi.y - kSlack) {
          FAIL(g.scene.objects.names[e] << " overlaps " << g.scene.objects.names[i]);
        }
        rests |= over && std::abs(a.lo.y - b.hi.y) < kSlack;
      }
      CHECK(rests);
    }
  }
}

TEST_CASE("the seed changes tints and extras, a second run nothing") {
  TownOptions options;
  options.grid = {2, 2};
  options.extras_per_floor = 5;
  const Generated a = *generate_town(options);
  const Generated b = *generate_town(options);
  options.seed = 2;
  const Generated c = *generate_town(options);
  CHECK(a.scene.objects.frame_from_object == b.scene.objects.frame_from_object);
  CHECK(a.scene.objects.mesh == b.scene.objects.mesh);
  CHECK(a.scene.objects.names == b.scene.objects.names);
  CHECK(a.scene.images == b.scene.images);
  CHECK(a.scene.objects.mesh != c.scene.objects.mesh);
  CHECK(a.scene.objects.frame_from_object != c.scene.objects.frame_from_object);
}

TEST_CASE("options that cannot be are refused by name") {
  const auto with = [](auto change) {
    TownOptions o;
    change(o);
    return o;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  check_refused(with([](auto& o) { o.grid = {0, 4}; }), "--grid");
  check_refused(with([](auto& o) { o.grid = {1'000'000, 1}; }), "--grid");
  check_refused(with([](auto& o) { o.grid = {100'000, 100'000}; }), "--grid");
  check_refused(with([](auto& o) { o.grid = {3000, 1}, o.spacing_m = 1000; }), "--grid");
  check_refused(with([](auto& o) { o.grid = {500, 500}; }), "--grid");
  check_refused(with([](auto& o) { o.spacing_m = -1; }), "--spacing");
  check_refused(with([&](auto& o) { o.spacing_m = kNan; }), "--spacing");
  check_refused(with([](auto& o) { o.brick_m.x = 0; }), "--brick");
  check_refused(with([](auto& o) { o.brick_m.y = 0.6; }), "--brick");
  check_refused(with([&](auto& o) { o.brick_m.z = kNan; }), "--brick");
  check_refused(with([](auto& o) { o.building_bricks = {1, 16}; }), "--building-size");
  check_refused(with([](auto& o) { o.building_bricks = {16, 4'000'000'000U}; }), "--building-size");
  check_refused(
      with([](auto& o) {
        o.building_bricks = {10'000, 10'000}, o.floors = 1000, o.floor_courses = 1000, o.windows = false;
      }),
      "--building-size");
  check_refused(with([](auto& o) { o.floor_courses = 0; }), "--floor-courses");
  check_refused(with([](auto& o) { o.floors = 0; }), "--floors");
  check_refused(with([](auto& o) { o.window_m.y = 2.8; }), "--window");
  check_refused(with([](auto& o) { o.window_m.x = -1; }), "--window");
  check_refused(with([](auto& o) { o.floor_courses = 1; }), "--window");
  check_refused(with([](auto& o) { o.extras_per_floor = 2'000'000; }), "--extras");
  check_refused(with([](auto& o) { o.grid = {50, 50}, o.extras_per_floor = 1'000'000; }), "--extras");
  check_refused(with([](auto& o) { o.extras_per_floor = 1, o.extra_model = "sphere:3"; }), "--extra-model");
  check_refused(with([](auto& o) { o.extras_per_floor = 1, o.extra_model = "sphere:1x"; }), "--extra-model");
  check_refused(with([](auto& o) { o.seed = limits::kMaxSeed + 1; }), "--seed");
  check_refused(with([](auto& o) { o.roof = Roof::gabled, o.building_bricks = {60, 4}; }), "--roof");
}

TEST_CASE("small and odd buildings work, and say what they left out") {
  TownOptions options;
  options.building_bricks = {2, 2};
  CHECK(generate_town(options));
  options = {};
  options.brick_m = {0.25, 0.12, 0.065};
  options.floor_courses = 40;
  CHECK(generate_town(options));
  options.window_m = {1.01, 1.2};
  const Generated g = *generate_town(options);
  REQUIRE(g.notes.size() == 1);
  CHECK(g.notes[0].find("windows are 1 m x 1.17 m") != std::string::npos);
}

TEST_CASE("windows that fit nowhere are noted") {
  const auto says_so = [](const TownOptions& options) {
    const Generated g = *generate_town(options);
    return std::count(g.notes.begin(), g.notes.end(),
                      "no window fits between the walls: the buildings have none") == 1;
  };
  TownOptions options;
  CHECK_FALSE(says_so(options));
  options.building_bricks = {2, 2};
  CHECK(says_so(options));
  options.windows = false;
  CHECK_FALSE(says_so(options));
}

TEST_CASE("the ground's texture repeats every 6 m without a texture transform") {
  TownOptions options;
  options.grid = {3, 2};
  const Generated g = *generate_town(options);
  for (const Material& m : g.scene.materials) {
    CHECK(m.base_color_texture.uv_scale == glm::vec2(1));
    CHECK(m.base_color_texture.uv_offset == glm::vec2(0));
  }
  std::size_t checked = 0;
  for (std::size_t i = 0; i < g.exempt.size() && g.exempt[i] == 1; ++i) {
    const Primitive& p = g.scene.meshes[g.scene.objects.mesh[i].value].primitives.at(0);
    const TextureId texture = g.scene.materials[p.material.value].base_color_texture.texture;
    REQUIRE(texture.valid());
    CHECK(g.scene.textures[texture.value].sampler.wrap_s == 10497);
    const Geometry& box = g.scene.geometries[p.geometry.value];
    const glm::vec3 scale = g.scene.objects.frame_from_object[i].scale;
    for (std::size_t a = 0; a + 1 < box.vertex_count(); ++a) {
      const std::size_t b = a + 1;
      if (a % 4 == 3) continue;  // the next face
      const float metres = glm::length((box.positions_m[a] - box.positions_m[b]) * scale);
      CHECK(glm::length(box.texcoords[0][a] - box.texcoords[0][b]) * 6.0F == Approx(metres));
      ++checked;
    }
  }
  CHECK(checked == 2 * 6 * 3);
}

TEST_CASE("model files stand in for buildings and extra objects") {
  // The model is a small town of our own, written and read back.
  TownOptions small;
  small.building_bricks = {4, 4};
  small.floors = 1;
  small.ground = false;
  const Generated model = *generate_town(small);
  const std::string path = (std::filesystem::temp_directory_path() / "scenegen_gen_town_model.glb").string();
  REQUIRE(gltf::write(model.scene, path, {}));

  TownOptions options;
  options.grid = {3, 2};
  options.building_model = path;
  const Result<Generated> town = generate_town(options);
  if (!town) FAIL(town.error().str());
  const std::size_t of_model = model.scene.objects.size();
  REQUIRE(town->scene.objects.size() == 2 + 6 * of_model);
  CHECK(predict_town(options)->objects == town->scene.objects.size());
  CHECK(predict_town(options)->vertices == counted(town->scene).vertices);
  CHECK(town->scene.objects.names[2].starts_with("building_00_00/building_00_00/"));
  CHECK(validate(town->scene).empty());
  // Neighbours are `spacing_m` apart, on the ground.
  std::vector<Box> of_building(6);
  const std::vector<Box> boxes = object_bounds(town->scene);
  for (std::size_t i = 2; i < boxes.size(); ++i) of_building[(i - 2) / of_model].add(boxes[i]);
  for (const Box& b : of_building) CHECK(b.lo.y == Approx(0).margin(1e-4));
  CHECK(of_building[1].lo.x - of_building[0].hi.x == Approx(options.spacing_m).margin(1e-3));
  CHECK(of_building[0].lo.z - of_building[3].hi.z == Approx(options.spacing_m).margin(1e-3));

  TownOptions with_extras;
  with_extras.extras_per_floor = 3;
  with_extras.extra_model = path;
  const Generated filled = *generate_town(with_extras);
  CHECK(filled.scene.objects.size() == predict_town(with_extras)->objects);
  CHECK(counted(filled.scene).vertices == predict_town(with_extras)->vertices);
  REQUIRE(filled.notes.size() == 1);
  CHECK(filled.notes[0].find("scaled") != std::string::npos);  // a house does not fit into a room
  std::size_t extras = 0;
  for (std::size_t i = 0; i < filled.scene.objects.size(); ++i) {
    extras += filled.scene.objects.names[i].find("/extra_") != std::string_view::npos;
  }
  CHECK(extras == 3 * 3 * of_model);
  std::filesystem::remove(path);

  options.building_model = "/nowhere/model.glb";
  const Result<Generated> missing = generate_town(options);
  REQUIRE_FALSE(missing);
  CHECK(missing.error().str().find("/nowhere/model.glb") != std::string::npos);
  options.building_model.clear();
  with_extras.building_model = path;
  CHECK_FALSE(generate_town(with_extras));
}
