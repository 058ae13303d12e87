#include "timeline/player.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "naive_player.h"
#include "random_scene.h"
#include "tests/support/counting_allocator.h"

namespace scenegen::timeline {
namespace {

using test::naive_state;
using test::NaiveState;
using test::RandomScene;

constexpr double kEps = 1e-9;

/// One object on one frame, one material, one mesh beside the default.
Scene one_object() {
  Scene s;
  s.duration_s = 10.0F;
  s.geometries.resize(1);
  s.geometries[0].positions_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  s.materials.resize(1);
  s.meshes = {{"a", {{GeometryId(0), MaterialId(0)}}}, {"b", {{GeometryId(0), MaterialId(0)}}}};
  s.frames.resize(1);
  s.frames[0].name = "frame";
  s.objects.add("object", MeshId(0), Transform{}, FrameId(0));
  return s;
}

/// The whole observable state, for comparing bit for bit.
struct Snapshot {
  std::vector<std::uint8_t> visible;
  std::vector<MeshId> mesh;
  std::vector<glm::mat4> world;
  std::vector<glm::vec4> base_color;
  std::vector<glm::vec3> emissive;
  std::vector<glm::mat4> cameras;

  explicit Snapshot(const Player& p) {
    for (std::size_t i = 0; i < p.timeline().object_count(); ++i) {
      visible.push_back(p.visible(ObjectId(i)));
      mesh.push_back(p.mesh(ObjectId(i)));
      world.push_back(p.world_from_object(ObjectId(i)));
    }
    for (std::size_t i = 0; i < p.timeline().material_count(); ++i) {
      base_color.push_back(p.base_color(MaterialId(i)));
      emissive.push_back(p.emissive(MaterialId(i)));
    }
    for (std::size_t i = 0; i < p.timeline().camera_count(); ++i) {
      cameras.push_back(p.world_from_camera(CameraId(i)));
    }
  }
  friend bool operator==(const Snapshot& a, const Snapshot& b) {
    const auto same = [](const auto& x, const auto& y) {
      return x.size() == y.size() &&
             (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0);
    };
    return same(a.visible, b.visible) && same(a.mesh, b.mesh) && same(a.world, b.world) &&
           same(a.base_color, b.base_color) && same(a.emissive, b.emissive) && same(a.cameras, b.cameras);
  }
};

template <class Id>
std::vector<Id> to_vector(std::span<const Id> ids) {
  return {ids.begin(), ids.end()};
}

/// Exactly what differs between two states, by looking at everything.
void check_changes(const ChangeSet& changes, const Snapshot& before, const Snapshot& after) {
  std::vector<ObjectId> shown, hidden, moved, remeshed;
  std::vector<MaterialId> recolored;
  for (std::size_t i = 0; i < before.visible.size(); ++i) {
    if (before.visible[i] < after.visible[i]) shown.emplace_back(i);
    if (before.visible[i] > after.visible[i]) hidden.emplace_back(i);
    if (std::memcmp(&before.world[i], &after.world[i], sizeof(glm::mat4)) != 0) moved.emplace_back(i);
    if (before.mesh[i] != after.mesh[i]) remeshed.emplace_back(i);
  }
  for (std::size_t i = 0; i < before.base_color.size(); ++i) {
    if (std::memcmp(&before.base_color[i], &after.base_color[i], sizeof(glm::vec4)) != 0 ||
        std::memcmp(&before.emissive[i], &after.emissive[i], sizeof(glm::vec3)) != 0) {
      recolored.emplace_back(i);
    }
  }
  REQUIRE(to_vector(changes.shown) == shown);
  REQUIRE(to_vector(changes.hidden) == hidden);
  REQUIRE(to_vector(changes.moved) == moved);
  REQUIRE(to_vector(changes.remeshed) == remeshed);
  REQUIRE(to_vector(changes.recolored) == recolored);
  REQUIRE(changes.count() ==
          shown.size() + hidden.size() + moved.size() + remeshed.size() + recolored.size());
}

void check_against_naive(const Player& p, const NaiveState& expected) {
  for (std::size_t i = 0; i < expected.visible.size(); ++i) {
    REQUIRE(p.visible(ObjectId(i)) == (expected.visible[i] != 0));
    REQUIRE(p.mesh(ObjectId(i)) == expected.mesh[i]);
    const glm::mat4 world = p.world_from_object(ObjectId(i));
    double largest = 1.0;
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 4; ++r) largest = std::max(largest, std::abs(expected.world_from_object[i][c][r]));
    }
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 4; ++r) {
        REQUIRE(static_cast<double>(world[c][r]) ==
                Approx(expected.world_from_object[i][c][r]).margin(4e-6 * largest));
      }
    }
  }
  REQUIRE(p.visible_count() ==
          static_cast<std::size_t>(std::count(expected.visible.begin(), expected.visible.end(), 1)));
  for (std::size_t m = 0; m < expected.base_color.size(); ++m) {
    for (int i = 0; i < 4; ++i) {
      REQUIRE(p.base_color(MaterialId(m))[i] == Approx(expected.base_color[m][i]).margin(1e-6));
    }
    for (int i = 0; i < 3; ++i) {
      REQUIRE(p.emissive(MaterialId(m))[i] == Approx(expected.emissive[m][i]).margin(1e-6));
    }
  }
}

/// A time on a key, just beside one, or anywhere.
double random_time(RandomScene& random) {
  const double key = 0.25 * static_cast<double>(random.below(33));
  switch (random.below(4)) {
    case 0:
      return key;
    case 1:
      return key - kEps;
    case 2:
      return key + kEps;
    default:
      return 8.0 * static_cast<double>(random.unit());
  }
}

// ---- Tables of (time, expected), in both directions

struct Row {
  double time_s;
  glm::vec4 expected;
};

/// Plays the rows forwards, backwards and each from a fresh player; `read` gives the state that a row is
/// about.
template <class Read>
void check_table(const Scene& scene, const std::vector<Row>& rows, const Read& read) {
  const auto timeline = compile(scene);
  const auto check = [&](const Player& p, const Row& row) {
    INFO("time " << row.time_s);
    const glm::vec4 got = read(p);
    for (int i = 0; i < 4; ++i) REQUIRE(got[i] == Approx(row.expected[i]).margin(2e-7));
  };
  Player p(timeline);
  for (const Row& row : rows) {
    p.seek(row.time_s);
    check(p, row);
  }
  p.seek(10.0);
  for (auto row = rows.rbegin(); row != rows.rend(); ++row) {
    p.seek(row->time_s);
    check(p, *row);
  }
  for (const Row& row : rows) {
    Player fresh(timeline);
    fresh.seek(row.time_s);
    check(fresh, row);
  }
}

glm::vec4 read_visible(const Player& p) {
  return glm::vec4(p.visible(ObjectId(0)) ? 1.0F : 0.0F);
}
glm::vec4 read_position(const Player& p) {
  return p.world_from_object(ObjectId(0))[3];
}
/// Where the frame's rotation takes +x.
glm::vec4 read_x_axis(const Player& p) {
  return p.world_from_object(ObjectId(0))[0];
}
glm::vec4 on(bool v) {
  return glm::vec4(v ? 1.0F : 0.0F);
}

TEST_CASE("visibility holds from its key on, exactly") {
  Scene s = one_object();
  s.objects.visibility[0] =
      s.add_track(Property::visibility, Interpolation::step, std::vector{0.0F, 1.0F, 2.5F, 4.0F},
                  std::vector{0.0F, 1.0F, 0.0F, 1.0F});
  check_table(s,
              {{0, on(false)},
               {1 - kEps, on(false)},
               {1, on(true)},
               {1 + kEps, on(true)},
               {2.5 - kEps, on(true)},
               {2.5, on(false)},
               {2.5 + kEps, on(false)},
               {4 - kEps, on(false)},
               {4, on(true)},
               {9, on(true)}},
              read_visible);
}

TEST_CASE("key times are compared as the float32 they are") {
  Scene s = one_object();
  s.objects.visibility[0] = s.add_track(Property::visibility, Interpolation::step, std::vector{0.0F, 0.1F},
                                        std::vector{0.0F, 1.0F});
  const double key = static_cast<double>(0.1F);  // 0.100000001490116…
  check_table(s, {{0.1, on(false)}, {std::nextafter(key, 0.0), on(false)}, {key, on(true)}}, read_visible);
}

TEST_CASE("STEP motion") {
  Scene s = one_object();
  s.frame_tracks = {
      {FrameId(0), s.add_track(Property::translation, Interpolation::step, std::vector{1.0F, 3.0F},
                               std::vector{1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F})}};
  check_table(s,
              {{0, {1, 2, 3, 1}},
               {1, {1, 2, 3, 1}},
               {3 - kEps, {1, 2, 3, 1}},
               {3, {4, 5, 6, 1}},
               {3 + kEps, {4, 5, 6, 1}},
               {10, {4, 5, 6, 1}}},
              read_position);
}

TEST_CASE("LINEAR translation") {
  Scene s = one_object();
  s.frame_tracks = {{FrameId(0), s.add_track(Property::translation, Interpolation::linear,
                                             std::vector{1.0F, 2.0F, 4.0F, 5.0F},
                                             std::vector{0.0F, 0.0F, 0.0F, 8.0F, 0.0F, 4.0F,  //
                                                         8.0F, 0.0F, 4.0F, 0.0F, 2.0F, 0.0F})}};
  check_table(s,
              {{0, {0, 0, 0, 1}},
               {1 - kEps, {0, 0, 0, 1}},
               {1, {0, 0, 0, 1}},
               {1.25, {2, 0, 1, 1}},
               {2 - kEps, {8, 0, 4, 1}},
               {2, {8, 0, 4, 1}},
               {3, {8, 0, 4, 1}},
               {4 + kEps, {8, 0, 4, 1}},
               {4.5, {4, 1, 2, 1}},
               {5, {0, 2, 0, 1}},
               {6, {0, 2, 0, 1}}},
              read_position);
}

TEST_CASE("LINEAR rotation is spherical, along the shortest path") {
  Scene s = one_object();
  const float h = std::sqrt(0.5F);
  // 0 -> 90 degrees about y, the second key with the other sign: the long way round would pass 270 degrees.
  s.frame_tracks = {
      {FrameId(0), s.add_track(Property::rotation, Interpolation::linear, std::vector{0.0F, 3.0F},
                               std::vector{0.0F, 0.0F, 0.0F, 1.0F, 0.0F, -h, 0.0F, -h})}};
  const auto x_axis = [](double degrees) {
    const double a = glm::radians(degrees);
    return glm::vec4(static_cast<float>(std::cos(a)), 0.0F, static_cast<float>(-std::sin(a)), 0.0F);
  };
  check_table(s,
              {{0, x_axis(0)},
               {1, x_axis(30)},
               {1.5, x_axis(45)},
               {2, x_axis(60)},
               {3 - kEps, x_axis(90)},
               {3, x_axis(90)},
               {4, x_axis(90)}},
              read_x_axis);
}

TEST_CASE("CUBICSPLINE follows glTF's formula") {
  Scene s = one_object();
  // One segment of 2 s, p0 = 1, m0 = 3, p1 = 5, m1 = -1:
  // p(u) = (2u3-3u2+1) + 2(u3-2u2+u)*3 + (3u2-2u3)*5 + 2(u3-u2)*(-1); p(1/4) = 2.5625, p(1/2) = 4, p(3/4)
  // = 4.9375
  const std::vector<float> values{9, 9, 9, 1, 0, 0, 3, 0, 0, -1, 0, 0, 5, 0, 0, 9, 9, 9};
  s.frame_tracks = {{FrameId(0), s.add_track(Property::translation, Interpolation::cubic_spline,
                                             std::vector{1.0F, 3.0F}, values)}};
  check_table(s,
              {{0, {1, 0, 0, 1}},
               {1, {1, 0, 0, 1}},
               {1 + kEps, {1, 0, 0, 1}},
               {1.5, {2.5625F, 0, 0, 1}},
               {2, {4, 0, 0, 1}},
               {2.5, {4.9375F, 0, 0, 1}},
               {3, {5, 0, 0, 1}},
               {7, {5, 0, 0, 1}}},
              read_position);
}

TEST_CASE("CUBICSPLINE rotations are normalised") {
  Scene s = one_object();
  const float h = std::sqrt(0.5F);
  const std::vector<float> values{0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, h, 0, h, 0, 0, 0, 0};
  s.frame_tracks = {{FrameId(0), s.add_track(Property::rotation, Interpolation::cubic_spline,
                                             std::vector{0.0F, 1.0F}, values)}};
  // Half-way the unnormalised value is the mean of the two, which points at 45 degrees.
  check_table(s, {{0, {1, 0, 0, 0}}, {0.5, {h, 0, -h, 0}}, {1, {0, 0, -1, 0}}}, read_x_axis);
}

TEST_CASE("mesh and material tracks") {
  Scene s = one_object();
  s.object_mesh_tracks = {{ObjectId(0), s.add_track(Property::mesh, Interpolation::step,
                                                    std::vector{0.0F, 2.0F}, std::vector{0.0F, 1.0F})}};
  s.material_tracks = {
      {MaterialId(0), s.add_track(Property::base_color, Interpolation::linear, std::vector{0.0F, 4.0F},
                                  std::vector{0.0F, 0.0F, 0.0F, 1.0F, 1.0F, 0.5F, 0.0F, 1.0F})},
      {MaterialId(0), s.add_track(Property::emissive, Interpolation::step, std::vector{0.0F, 3.0F},
                                  std::vector{0.0F, 0.0F, 0.0F, 7.0F, 8.0F, 9.0F})}};
  const auto mesh = [](const Player& p) { return glm::vec4(static_cast<float>(p.mesh(ObjectId(0)).value)); };
  check_table(s, {{0, on(false)}, {2 - kEps, on(false)}, {2, on(true)}, {5, on(true)}}, mesh);
  const auto color = [](const Player& p) { return p.base_color(MaterialId(0)); };
  check_table(s, {{0, {0, 0, 0, 1}}, {1, {0.25F, 0.125F, 0, 1}}, {4, {1, 0.5F, 0, 1}}, {5, {1, 0.5F, 0, 1}}},
              color);
  const auto emissive = [](const Player& p) { return glm::vec4(p.emissive(MaterialId(0)), 0.0F); };
  check_table(s, {{0, {0, 0, 0, 0}}, {3 - kEps, {0, 0, 0, 0}}, {3, {7, 8, 9, 0}}}, emissive);
}

// ---- Change sets

TEST_CASE("an object toggled twice in one step is not reported") {
  Scene s = one_object();
  s.objects.visibility[0] = s.add_track(Property::visibility, Interpolation::step,
                                        std::vector{0.0F, 1.0F, 2.0F}, std::vector{0.0F, 1.0F, 0.0F});
  Player p(compile(s));
  p.seek(0.5);
  REQUIRE(p.seek(3.0).count() == 0);
  REQUIRE(p.seek(0.0).count() == 0);
  REQUIRE(p.seek(1.0).shown.size() == 1);
  REQUIRE(p.seek(1.0).count() == 0);
  REQUIRE(p.seek(0.0).hidden.size() == 1);
}

TEST_CASE("the first seek reports against the state before the first key") {
  Scene s = one_object();
  s.objects.visibility[0] = s.add_track(Property::visibility, Interpolation::step, std::vector{1.0F, 2.0F},
                                        std::vector{0.0F, 1.0F});
  s.objects.add("always", MeshId(0), Transform{});
  const auto timeline = compile(s);
  Player a(timeline);
  REQUIRE_FALSE(a.visible(ObjectId(0)));
  REQUIRE(a.visible(ObjectId(1)));
  REQUIRE(a.visible_count() == 1);
  REQUIRE(a.seek(0.0).count() == 0);
  Player b(timeline);
  REQUIRE(to_vector(b.seek(5.0).shown) == std::vector{ObjectId(0)});
  REQUIRE(b.visible_count() == 2);
}

TEST_CASE("times are clamped, NaN is 0") {
  Scene s = one_object();
  s.objects.visibility[0] = s.add_track(Property::visibility, Interpolation::step, std::vector{0.0F, 10.0F},
                                        std::vector{0.0F, 1.0F});
  Player p(compile(s));
  REQUIRE(p.seek(1e300).time_s == 10.0);
  REQUIRE(p.visible(ObjectId(0)));
  REQUIRE(p.seek(-1e300).time_s == 0.0);
  REQUIRE_FALSE(p.visible(ObjectId(0)));
  REQUIRE(p.seek(std::numeric_limits<double>::infinity()).time_s == 10.0);
  REQUIRE(p.seek(std::numeric_limits<double>::quiet_NaN()).time_s == 0.0);
  REQUIRE(p.time_s() == 0.0);
  REQUIRE(p.advance(4.0).time_s == 4.0);
  REQUIRE(p.advance(-1.5).time_s == 2.5);
  REQUIRE(p.advance(-99.0).time_s == 0.0);
}

TEST_CASE("the scale of a camera is ignored") {
  Scene s = one_object();
  s.frames[0].local.scale = glm::vec3(2.0F, 3.0F, 4.0F);
  s.cameras.resize(2);
  s.cameras[0].frame_from_camera.scale = glm::vec3(3.0F);
  s.cameras[1].frame_from_camera.translation_m = {1, 1, 1};
  s.cameras[1].frame = FrameId(0);
  const Player p(compile(s));
  REQUIRE(p.world_from_camera(CameraId(0)) == glm::mat4(1.0F));
  REQUIRE(p.world_from_camera(CameraId(1))[1] == glm::vec4(0, 1, 0, 0));
  REQUIRE(p.world_from_camera(CameraId(1))[3] == glm::vec4(2, 3, 4, 1));
}

TEST_CASE("frames carry their children, objects and cameras") {
  Scene s = one_object();
  s.frames.resize(2);
  s.frames[1].name = "arm";
  s.frames[1].parent = FrameId(0);
  s.frames[1].local.translation_m = {0, 1, 0};
  s.objects.add("hand", MeshId(0), Transform{}, FrameId(1));
  s.objects.add("ground", MeshId(0), Transform{});
  s.cameras.resize(1);
  s.cameras[0].frame = FrameId(1);
  s.cameras[0].frame_from_camera.scale = glm::vec3(3.0F);
  s.frame_tracks = {
      {FrameId(0), s.add_track(Property::translation, Interpolation::linear, std::vector{0.0F, 1.0F},
                               std::vector{0.0F, 0.0F, 0.0F, 2.0F, 0.0F, 0.0F})},
      {FrameId(0), s.add_track(Property::scale, Interpolation::step, std::vector{0.0F, 2.0F},
                               std::vector{1.0F, 1.0F, 1.0F, 5.0F, 5.0F, 5.0F})}};
  Player p(compile(s));
  REQUIRE(to_vector(p.seek(0.5).moved) == std::vector{ObjectId(0), ObjectId(1)});
  REQUIRE(p.world_from_object(ObjectId(1))[3] == glm::vec4(1, 1, 0, 1));
  REQUIRE(p.world_from_camera(CameraId(0))[3] == glm::vec4(1, 1, 0, 1));
  p.seek(2.0);
  REQUIRE(p.world_from_object(ObjectId(1))[3] == glm::vec4(2, 5, 0, 1));
  REQUIRE(p.world_from_camera(CameraId(0))[0] == glm::vec4(1, 0, 0, 0));  // no scale in a camera
}

// ---- Random scenes

TEST_CASE(
    "the state equals that of a naive evaluator, of a fresh player, and the changes are the difference") {
  for (std::uint64_t seed = 0; seed < 25; ++seed) {
    INFO("seed " << seed);
    RandomScene random(seed);
    const Scene scene = random.make();
    const auto timeline = compile(scene);
    Player p(timeline);
    Snapshot before(p);
    for (int step = 0; step < 30; ++step) {
      const double t = random_time(random);
      INFO("step " << step << " to " << t);
      const ChangeSet& changes = random.chance(2) ? p.seek(t) : p.advance(t - p.time_s());
      const Snapshot after(p);
      check_changes(changes, before, after);
      check_against_naive(p, naive_state(scene, p.time_s()));
      Player fresh(timeline);
      const Snapshot at_start(fresh);
      check_changes(fresh.seek(p.time_s()), at_start, after);
      REQUIRE(Snapshot(fresh) == after);
      before = after;
    }
  }
}

TEST_CASE("small steps forwards and backwards meet the same states") {
  for (std::uint64_t seed = 100; seed < 110; ++seed) {
    RandomScene random(seed);
    const auto timeline = compile(random.make());
    Player p(timeline);
    std::vector<Snapshot> states;
    for (int i = 0; i <= 160; ++i) {
      p.seek(0.05 * i);
      states.emplace_back(p);
    }
    for (int i = 160; i >= 0; --i) {
      p.seek(0.05 * i);
      REQUIRE(Snapshot(p) == states[static_cast<std::size_t>(i)]);
    }
  }
}

/// Tracks with many keys, so that a far seek passes more events than evaluating all tracks costs.
Scene many_events() {
  Scene s = one_object();
  std::vector<float> times, flips, positions;
  for (int k = 0; k < 500; ++k) {
    times.push_back(static_cast<float>(k) * 0.02F);
    flips.push_back(static_cast<float>(k % 3 == 0));
    for (int i = 0; i < 3; ++i) positions.push_back(static_cast<float>((k * 7 + i) % 11));
  }
  s.objects.visibility[0] = s.add_track(Property::visibility, Interpolation::step, times, flips);
  s.frame_tracks = {
      {FrameId(0), s.add_track(Property::translation, Interpolation::linear, times, positions)}};
  return s;
}

TEST_CASE("a far seek through many events gives what small steps give") {
  const Scene scene = many_events();
  const auto timeline = compile(scene);
  RandomScene random(7);
  Player far(timeline);
  for (int i = 0; i < 200; ++i) {
    const double t = static_cast<double>(random.in(0, 10));
    const Snapshot before(far);
    const ChangeSet& changes = far.seek(t);
    check_changes(changes, before, Snapshot(far));
    check_against_naive(far, naive_state(scene, t));
    Player near(timeline);
    for (double s = 0; s < t; s += 0.03) near.seek(s);
    near.seek(t);
    REQUIRE(Snapshot(near) == Snapshot(far));
  }
}

TEST_CASE("nothing is allocated after construction") {
  RandomScene random(3);
  for (const Scene& scene : {random.make(5000, 300), many_events()}) {
    Player p(compile(scene));
    std::size_t changed = 0;
    const std::uint64_t before = scenegen::test::allocation_count();
    for (int i = 0; i < 500; ++i) {
      changed += p.seek(random_time(random)).count();
      changed += p.advance(static_cast<double>(random.in(-0.5F, 0.5F))).count();
    }
    REQUIRE(scenegen::test::allocation_count() == before);
    REQUIRE(changed > 500);
  }
}

}  // namespace
}  // namespace scenegen::timeline
