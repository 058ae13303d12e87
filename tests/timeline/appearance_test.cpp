#include "timeline/appearance.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

#include "scene/random.h"
#include "timeline/track_table.h"

using namespace scenegen;
using namespace scenegen::timeline;

namespace {

/// A unit box mesh, and nothing placed.
Scene empty_scene() {
  Scene scene;
  Geometry box;
  for (unsigned corner = 0; corner < 8; ++corner) {
    box.positions_m.emplace_back((corner & 1U) != 0 ? 0.5F : -0.5F, (corner & 2U) != 0 ? 0.5F : -0.5F,
                                 (corner & 4U) != 0 ? 0.5F : -0.5F);
  }
  box.topology = Topology::points;
  scene.geometries.push_back(box);
  scene.meshes.push_back({"box", {{GeometryId(0), MaterialId()}}});
  return scene;
}

void add_box(Scene& scene, glm::vec3 at_z_up_m, float side_m = 1.0F) {
  Transform transform;
  transform.translation_m = y_up_from_z_up(at_z_up_m);
  transform.scale = glm::vec3(side_m);
  scene.objects.add("box_" + std::to_string(scene.objects.size()), MeshId(0), transform);
}

Scene scattered(std::size_t count, std::uint64_t seed) {
  Scene scene = empty_scene();
  const Random random(seed, "places");
  for (std::size_t i = 0; i < count; ++i) {
    add_box(
        scene,
        {random.unit(4 * i) * 30.0F - 7.0F, random.unit(4 * i + 1) * 20.0F, random.unit(4 * i + 2) * 10.0F},
        0.1F + random.unit(4 * i + 3));
  }
  return scene;
}

/// Unit boxes on every place of a lattice, author's frame, x fastest: the boxes' own cells are known.
Scene lattice(glm::uvec3 cells) {
  Scene scene = empty_scene();
  for (std::uint32_t z = 0; z < cells.z; ++z) {
    for (std::uint32_t y = 0; y < cells.y; ++y) {
      for (std::uint32_t x = 0; x < cells.x; ++x) add_box(scene, glm::vec3(x, y, z) + 0.5F);
    }
  }
  return scene;
}

float appears_s(const Scene& scene, std::size_t object) {
  return first_appearance_s(scene, ObjectId(object)).value();
}

std::string error_of(Scene scene, const AppearanceOptions& options) {
  const std::size_t tracks = scene.tracks.size();
  const Result<AppearanceInfo> info = assign_appearance(scene, options);
  REQUIRE_FALSE(info.has_value());
  CHECK(info.error().kind == ErrorKind::usage);
  CHECK(scene.tracks.size() == tracks);  // a refused scene is left alone
  CHECK_FALSE(scene.info.appearance.has_value());
  return info.error().str();
}

struct Assigned {
  Scene scene;
  AppearanceInfo info;
};

Assigned assigned(Scene scene, const AppearanceOptions& options, std::span<const std::uint8_t> exempt = {}) {
  Result<AppearanceInfo> info = assign_appearance(scene, options, exempt);
  if (!info) FAIL(info.error().str());
  return {std::move(scene), std::move(*info)};
}

}  // namespace

TEST_CASE("Cell n along the curve appears at n * interval", "[appearance]") {
  AppearanceOptions options;
  options.cells = {4, 3, 5};
  options.interval_s = 0.25;
  for (const CurveKind kind : {CurveKind::hilbert, CurveKind::morton, CurveKind::row_prime}) {
    for (const std::string_view order : {"+x+y+z", "+x+y-z", "-y+z+x"}) {
      options.curve = kind;
      options.order = parse_axis_order(order).value();
      const Assigned a = assigned(lattice(options.cells), options);
      const std::vector<std::uint32_t> ranks = cell_ranks(kind, options.cells, options.order);
      for (std::size_t i = 0; i < ranks.size(); ++i) {
        CHECK(appears_s(a.scene, i) == static_cast<float>((ranks[i] + 1) * 0.25));
      }
      CHECK(a.info.moments == ranks.size());
      CHECK(a.info.timed_objects == ranks.size());
      CHECK(a.info.displaced_objects == 0);
      CHECK(a.info.coherence_measured == 1.0);
      CHECK(a.info.grid_z_up_m == Box{{0.0F, 0.0F, 0.0F}, {4.0F, 3.0F, 5.0F}});
      CHECK(a.scene.duration_s == 60 * 0.25F + 1.0F);
    }
  }
}

TEST_CASE("Top-down order lets the top of the author's Z axis appear first", "[appearance]") {
  AppearanceOptions options;
  options.curve = CurveKind::row_prime;
  options.cells = {1, 1, 8};
  options.order = parse_axis_order("+x+y-z").value();
  const Assigned a = assigned(lattice(options.cells), options);
  for (std::size_t i = 1; i < 8; ++i) CHECK(appears_s(a.scene, i) < appears_s(a.scene, i - 1));
}

TEST_CASE("Objects of a moment share one track, tracks stand in ascending time", "[appearance]") {
  AppearanceOptions options;
  options.cells = {3, 4, 2};
  options.coherence = 0.7;
  const Assigned a = assigned(scattered(5000, 2), options);
  std::set<float> moments;
  for (std::size_t i = 0; i < a.scene.objects.size(); ++i) moments.insert(appears_s(a.scene, i));
  REQUIRE(a.scene.tracks.size() == moments.size());
  CHECK(a.info.moments == moments.size());
  std::size_t at = 0;
  for (const float moment : moments) {
    const TrackId track(at++);
    CHECK(a.scene.tracks[track.value].property == Property::visibility);
    CHECK(a.scene.tracks[track.value].interpolation == Interpolation::step);
    const auto times = a.scene.times_s(track);
    const auto values = a.scene.values(track);
    CHECK(std::vector(times.begin(), times.end()) == std::vector{0.0F, moment});
    CHECK(std::vector(values.begin(), values.end()) == std::vector{0.0F, 1.0F});
  }
  CHECK(a.scene.duration_s == static_cast<float>(double{*moments.rbegin()} + options.hold_s));
}

TEST_CASE("Measured coherence is (N - V) / N for any coherence, grid, curve and seed", "[coherence]") {
  const Random random(99, "parameters");
  for (std::uint64_t round = 0; round < 300; ++round) {
    const auto draw = [&](std::uint64_t k, std::uint64_t n) { return random.below(round * 16 + k, n); };
    AppearanceOptions options;
    options.cells = {1 + draw(0, 9), 1 + draw(1, 9), 1 + draw(2, 9)};
    options.curve = std::array{CurveKind::hilbert, CurveKind::morton, CurveKind::row_prime}[draw(3, 3)];
    options.order = parse_axis_order(std::array{"+x+y+z", "-z+y-x", "+y-z+x"}[draw(4, 3)]).value();
    options.interval_s = std::array{0.01, 1.0 / 3.0, 1e-6, 86400.0}[draw(5, 4)];
    options.seed = draw(6, 1ULL << 53);
    options.coherence = round % 10 == 0 ? 0.0 : round % 10 == 1 ? 1.0 : random.unit(round * 16 + 7);
    const bool one_cell = options.cells == glm::uvec3(1U);
    if (one_cell) options.coherence = 1.0;
    const std::uint64_t n = 1 + draw(8, 700);
    Scene scene = scattered(n, round);
    std::vector<std::uint8_t> exempt(draw(9, 2) == 0 ? 0 : n);
    for (std::size_t i = 0; i < exempt.size(); ++i)
      exempt[i] = random.below(1000000 + round * 1000 + i, 5) == 0;
    const auto timed = n - static_cast<std::uint64_t>(std::count(exempt.begin(), exempt.end(), 1));
    const auto displaced =
        static_cast<std::uint64_t>(std::llround(double(timed) * (1.0 - options.coherence)));

    const Assigned a = assigned(std::move(scene), options, exempt);
    CHECK(a.info.timed_objects == timed);
    CHECK(a.info.displaced_objects == displaced);
    const double expected = timed == 0 ? 1.0 : double(timed - displaced) / double(timed);
    CHECK(a.info.coherence_measured == expected);
    CHECK(measure_coherence(a.scene).value() == expected);
    for (std::size_t i = 0; i < exempt.size(); ++i) {
      CHECK(a.scene.objects.visibility[i].valid() == (exempt[i] == 0));
    }
    // Every time is one of the cells' times.
    const std::uint64_t cells = std::uint64_t{options.cells.x} * options.cells.y * options.cells.z;
    for (std::size_t i = 0; i < n; ++i) {
      if (!a.scene.objects.visibility[i].valid()) continue;
      const float time_s = appears_s(a.scene, i);
      const auto nearest = static_cast<std::uint64_t>(std::llround(double{time_s} / options.interval_s));
      CHECK((nearest >= 1 && nearest <= cells));
      CHECK(time_s == static_cast<float>(double(nearest) * options.interval_s));
    }
  }
}

TEST_CASE("Displaced objects are spread evenly over the indices", "[coherence]") {
  AppearanceOptions options;
  options.cells = {4, 4, 4};
  Scene scene = scattered(1000, 4);
  const std::vector<std::uint8_t> exempt = [] {
    std::vector<std::uint8_t> e(1000, 0);
    e[0] = e[17] = 1;
    return e;
  }();
  const Scene in_order = assigned(scene, options, exempt).scene;
  options.coherence = 0.9;
  const Assigned a = assigned(scene, options, exempt);
  std::vector<std::size_t> timed;
  for (std::size_t i = 0; i < 1000; ++i) {
    if (exempt[i] == 0) timed.push_back(i);
  }
  REQUIRE(a.info.displaced_objects == 100);
  std::set<std::size_t> expected;
  for (std::size_t i = 0; i < 100; ++i) expected.insert(timed[i * 998 / 100]);
  for (const std::size_t i : timed) {
    CHECK((appears_s(a.scene, i) != appears_s(in_order, i)) == (expected.count(i) == 1));
  }
}

TEST_CASE("Displaced objects take the times of the other cells evenly", "[coherence]") {
  AppearanceOptions options;
  options.cells = {2, 2, 2};
  options.coherence = 0.0;
  options.interval_s = 1.0;
  options.curve = CurveKind::row_prime;
  Scene scene = empty_scene();
  add_box(scene, {-1.0F, -1.0F, -1.0F}, 0.1F);
  add_box(scene, {1.0F, 1.0F, 1.0F}, 0.1F);
  for (int i = 0; i < 70000; ++i) add_box(scene, {0.5F, -0.5F, -0.5F}, 0.1F);  // cell 2
  const Assigned a = assigned(std::move(scene), options);
  std::array<int, 9> count{};
  for (std::size_t i = 2; i < 70002; ++i) ++count.at(static_cast<std::size_t>(appears_s(a.scene, i)));
  CHECK(count[0] == 0);
  CHECK(count[2] == 0);
  double chi_square = 0;
  for (const std::size_t n : {1U, 3U, 4U, 5U, 6U, 7U, 8U})
    chi_square += std::pow(count[n] - 10000.0, 2) / 10000.0;
  CHECK(chi_square < 22.5);  // 6 degrees of freedom: above with probability 0.001 were it uniform
  CHECK(chi_square > 0.3);   // below with probability 0.001: suspiciously even
}

TEST_CASE("Seeds matter, threads do not", "[appearance]") {
  AppearanceOptions options;
  options.coherence = 0.5;
  const Scene scene = scattered(20000, 5);
  const auto times = [&](std::uint64_t seed, unsigned threads) {
    options.seed = seed;
    options.threads = threads;
    const Assigned a = assigned(scene, options);
    CHECK(a.scene.info.seed == seed);
    CHECK(measure_coherence(a.scene, threads).value() == 0.5);
    std::vector<std::uint32_t> tracks;
    for (const TrackId id : a.scene.objects.visibility) tracks.push_back(id.value);
    return std::pair(tracks, a.scene.track_times_s);
  };
  const auto one = times(0, 1);
  CHECK(one == times(0, 2));
  CHECK(one == times(0, 8));
  CHECK(one != times(1, 1));
}

TEST_CASE("What the file should hold is filled in", "[appearance]") {
  AppearanceOptions options;
  options.order = parse_axis_order("-z+x+y").value();
  options.cells = {5, 6, 7};
  options.coherence = 0.25;
  options.hold_s = 2.5;
  options.interval_s = 0.125;
  options.seed = 77;
  const Assigned a = assigned(scattered(400, 6), options);
  REQUIRE(a.scene.info.appearance.has_value());
  const AppearanceInfo& info = *a.scene.info.appearance;
  CHECK(info.curve == "hilbert");
  CHECK(info.curve_variant == "skilling-2004");
  CHECK(info.order == "-z+x+y");
  CHECK(info.cells == options.cells);
  CHECK(info.interval_s == 0.125);
  CHECK(info.hold_s == 2.5);
  CHECK(info.coherence_given == 0.25);
  CHECK(info.coherence_measured == 0.25);
  CHECK(info.displaced_objects == 300);
  CHECK(info.locality_cells == Approx(13.3).margin(0.05));
  CHECK(a.scene.info.seed == 77U);
  Box all;
  for (const Box& b : object_bounds(a.scene)) all.add(b);
  CHECK(info.grid_z_up_m.lo == glm::vec3(all.lo.x, -all.hi.z, all.lo.y));
  CHECK(info.grid_z_up_m.hi == glm::vec3(all.hi.x, -all.lo.z, all.hi.y));
}

TEST_CASE("Exempt objects neither take a time nor widen the grid", "[appearance]") {
  AppearanceOptions options;
  options.cells = {2, 2, 2};
  Scene scene = lattice(options.cells);
  add_box(scene, glm::vec3(0.0F), 1000.0F);
  std::vector<std::uint8_t> exempt(9, 0);
  exempt[8] = 1;
  const Assigned a = assigned(scene, options, exempt);
  CHECK(a.info.grid_z_up_m == Box{glm::vec3(0.0F), glm::vec3(2.0F)});
  CHECK_FALSE(a.scene.objects.visibility[8].valid());
  CHECK(a.info.timed_objects == 8);

  const Assigned none = assigned(scene, options, std::vector<std::uint8_t>(9, 1));
  CHECK(none.info.timed_objects == 0);
  CHECK(none.info.moments == 0);
  CHECK(none.scene.duration_s == 1.0F);
  CHECK(none.info.grid_z_up_m == Box{glm::vec3(0.0F), glm::vec3(0.0F)});
  CHECK(measure_coherence(none.scene).value() == 1.0);

  exempt.pop_back();
  CHECK(assign_appearance(scene, options, exempt).error().where == "exempt");
}

TEST_CASE("Centres on a border of cells belong to the upper one, ulps or not", "[cells]") {
  AppearanceOptions options;
  options.curve = CurveKind::row_prime;
  options.cells = {4, 1, 1};
  options.interval_s = 1.0;
  Scene scene = empty_scene();
  add_box(scene, {0.5F, 0.0F, 0.0F});
  add_box(scene, {3.5F, 0.0F, 0.0F});
  add_box(scene, {1.0F, 0.0F, 0.0F});
  add_box(scene, {std::nextafter(1.0F, 0.0F), 0.0F, 0.0F});
  add_box(scene, {std::nextafter(1.0F, 2.0F), 0.0F, 0.0F});
  add_box(scene, {0.999F, 0.0F, 0.0F});
  const Scene timed = assigned(std::move(scene), options).scene;
  CHECK(appears_s(timed, 2) == 2.0F);
  CHECK(appears_s(timed, 3) == 2.0F);
  CHECK(appears_s(timed, 4) == 2.0F);
  CHECK(appears_s(timed, 5) == 1.0F);
  CHECK(appears_s(timed, 1) == 4.0F);
}

TEST_CASE("Flat scenes, single objects and meshes without vertices have a place", "[cells]") {
  AppearanceOptions options;
  options.cells = {3, 3, 3};
  Scene flat = empty_scene();
  for (int i = 0; i < 9; ++i) add_box(flat, {float(i), 2.0F, 0.0F}, 0.0F);
  const Assigned a = assigned(std::move(flat), options);
  CHECK(a.info.moments == 3);

  Scene hollow = empty_scene();
  hollow.meshes.push_back({"nothing", {}});
  add_box(hollow, {0.0F, 0.0F, 0.0F});
  add_box(hollow, {10.0F, 0.0F, 0.0F});
  hollow.objects.mesh[1] = MeshId(1);
  const Assigned b = assigned(std::move(hollow), options);
  CHECK(b.info.grid_z_up_m.hi.x == 10.0F);
  CHECK(appears_s(b.scene, 0) != appears_s(b.scene, 1));
}

TEST_CASE("Frames place their objects before cells are chosen", "[cells]") {
  AppearanceOptions options;
  options.curve = CurveKind::row_prime;
  options.cells = {2, 1, 1};
  Scene scene = empty_scene();
  add_box(scene, {0.0F, 0.0F, 0.0F});
  add_box(scene, {0.0F, 0.0F, 0.0F});
  scene.frames.push_back({});
  scene.frames[0].local.translation_m = {100.0F, 0.0F, 0.0F};
  scene.objects.frame[0] = FrameId(0);
  const Scene timed = assigned(std::move(scene), options).scene;
  CHECK(appears_s(timed, 0) > appears_s(timed, 1));
}

TEST_CASE("Earlier visibility is replaced, other tracks stay whole", "[tracks]") {
  AppearanceOptions options;
  options.cells = {2, 2, 2};
  Scene scene = scattered(50, 8);
  scene.frames.push_back({});
  scene.materials.push_back({});
  const std::array once{0.0F, 3.0F};
  const std::array hidden_shown{0.0F, 1.0F};
  const std::array move_times{0.0F, 1.0F, 500.0F};
  const std::array moves{0.0F, 0.0F, 0.0F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F};
  const std::array colors{1.0F, 0.0F, 0.0F, 0.0F, 0.0F, 1.0F};
  const std::array looks{0.0F, 0.0F};
  const TrackId old = scene.add_track(Property::visibility, Interpolation::step, once, hidden_shown);
  const TrackId move = scene.add_track(Property::translation, Interpolation::linear, move_times, moves);
  const TrackId older = scene.add_track(Property::visibility, Interpolation::step, once, hidden_shown);
  const TrackId color = scene.add_track(Property::emissive, Interpolation::step, once, colors);
  const TrackId look = scene.add_track(Property::mesh, Interpolation::step, once, looks);
  scene.frame_tracks.push_back({FrameId(0), move});
  scene.material_tracks.push_back({MaterialId(0), color});
  scene.object_mesh_tracks.push_back({ObjectId(3), look});
  scene.objects.visibility[0] = old;
  scene.objects.visibility[49] = older;
  // A reader may let tracks share keys: the visibility track's times are the colour track's too.
  scene.tracks[color.value].first_time = scene.tracks[older.value].first_time;
  scene.tracks[look.value].first_time = scene.tracks[color.value].first_time;

  std::vector<std::uint8_t> exempt(50, 0);
  exempt[49] = 1;
  Assigned a = assigned(std::move(scene), options, exempt);
  const auto same = [&](TrackId id, Property property, std::span<const float> times,
                        std::span<const float> values) {
    REQUIRE(id.value < a.scene.tracks.size());
    CHECK(a.scene.tracks[id.value].property == property);
    const auto t = a.scene.times_s(id);
    const auto v = a.scene.values(id);
    CHECK(std::equal(t.begin(), t.end(), times.begin(), times.end()));
    CHECK(std::equal(v.begin(), v.end(), values.begin(), values.end()));
  };
  const auto whole = [&] {
    same(a.scene.frame_tracks[0].track, Property::translation, move_times, moves);
    same(a.scene.material_tracks[0].track, Property::emissive, once, colors);
    same(a.scene.object_mesh_tracks[0].track, Property::mesh, once, looks);
  };
  whole();
  CHECK_FALSE(a.scene.objects.visibility[49].valid());
  CHECK(a.scene.tracks.size() == 3 + a.info.moments);
  CHECK(a.scene.track_times_s.size() == 3 + 2 + 2 * a.info.moments);
  CHECK(a.scene.track_values.size() == 9 + 6 + 2 + 2 * a.info.moments);
  CHECK(a.scene.duration_s == 500.0F);  // the movement lasts longer than the appearing
  for (std::size_t i = 0; i < 49; ++i) CHECK(appears_s(a.scene, i) <= 0.081F);

  // Doing it again changes nothing: no keys are left behind.
  const Scene first = a.scene;
  a = assigned(a.scene, options, exempt);
  CHECK(a.scene.track_times_s == first.track_times_s);
  CHECK(a.scene.track_values == first.track_values);
  CHECK(a.scene.objects.visibility == first.objects.visibility);
  whole();
}

TEST_CASE("First appearance of other people's tracks", "[tracks]") {
  Scene scene = scattered(4, 9);
  const auto give = [&](std::size_t object, std::span<const float> times, std::span<const float> values) {
    scene.objects.visibility[object] =
        scene.add_track(Property::visibility, Interpolation::step, times, values);
  };
  give(1, std::array{2.0F, 3.0F}, std::array{1.0F, 0.0F});
  give(2, std::array{1.0F, 2.0F, 4.0F, 5.0F}, std::array{0.0F, 0.0F, 1.0F, 0.0F});
  give(3, std::array{0.0F}, std::array{0.0F});
  CHECK(first_appearance_s(scene, ObjectId(0)) == 0.0F);
  CHECK(first_appearance_s(scene, ObjectId(1)) == 0.0F);
  CHECK(first_appearance_s(scene, ObjectId(2)) == 4.0F);
  CHECK_FALSE(first_appearance_s(scene, ObjectId(3)).has_value());
}

TEST_CASE("Coherence is measured from the tracks, not remembered", "[coherence]") {
  AppearanceOptions options;
  options.cells = {3, 3, 3};
  Assigned a = assigned(scattered(100, 10), options);
  a.scene.info.appearance->coherence_measured = 0.123;
  CHECK(measure_coherence(a.scene).value() == 1.0);
  const std::size_t other = a.scene.objects.visibility[0] == TrackId(0) ? 1 : 0;
  a.scene.objects.visibility[0] = TrackId(other);
  CHECK(measure_coherence(a.scene).value() == 0.99);
  const TrackId never =
      a.scene.add_track(Property::visibility, Interpolation::step, std::array{0.0F}, std::array{0.0F});
  a.scene.objects.visibility[1] = never;
  CHECK(measure_coherence(a.scene).value() == 0.98);
  a.scene.objects.frame_from_object[50].translation_m += glm::vec3(1000.0F);
  CHECK(measure_coherence(a.scene).value() <= 0.98);
}

TEST_CASE("A hostile file's appearance is refused, not followed", "[coherence]") {
  const Assigned good = assigned(scattered(10, 11), {});
  const auto error = [&](const auto& spoil) {
    Scene scene = good.scene;
    spoil(*scene.info.appearance);
    const Result<double> measured = measure_coherence(scene);
    REQUIRE_FALSE(measured.has_value());
    CHECK(measured.error().kind == ErrorKind::bad_input);
    return measured.error().where;
  };
  CHECK(error([](AppearanceInfo& i) { i.curve = "peano"; }) == "appearance.curve");
  CHECK(error([](AppearanceInfo& i) { i.curve_variant = "butz"; }) == "appearance.curveVariant");
  CHECK(error([](AppearanceInfo& i) { i.order = "+x"; }) == "appearance.order");
  CHECK(error([](AppearanceInfo& i) { i.cells = {0, 1, 1}; }) == "appearance.cells");
  CHECK(error([](AppearanceInfo& i) {
          i.cells = {4000000000U, 4000000000U, 4000000000U};
        }) == "appearance.cells");
  CHECK(error([](AppearanceInfo& i) { i.cells = {1024, 1024, 1024}; }) == "appearance.cells");
  CHECK(error([](AppearanceInfo& i) { i.interval_s = NAN; }) == "appearance.interval");
  CHECK(error([](AppearanceInfo& i) { i.interval_s = INFINITY; }) == "appearance.interval");
  CHECK(error([](AppearanceInfo& i) { i.interval_s = 0.0; }) == "appearance.interval");
  Scene without = good.scene;
  without.info.appearance.reset();
  CHECK_FALSE(measure_coherence(without).has_value());
  // Numbers that are no places put objects into some cell, never outside the table.
  for (const float v : {NAN, INFINITY, -INFINITY, 3e38F}) {
    Scene scene = good.scene;
    scene.info.appearance->grid_z_up_m.hi.x = v;
    scene.info.appearance->grid_z_up_m.lo.y = v;
    scene.objects.frame_from_object[2].translation_m.x = v;
    CHECK(measure_coherence(scene).value() <= 1.0);
  }
}

TEST_CASE("Options out of range are refused with what is allowed", "[errors]") {
  const Scene scene = scattered(10, 12);
  const auto error = [&](const auto& change) {
    AppearanceOptions options;
    change(options);
    return error_of(scene, options);
  };
  CHECK(error([](auto& o) { o.coherence = 1.2; }) == "--coherence: 1.2: from 0 to 1");
  CHECK(error([](auto& o) { o.coherence = -0.1; }).find("--coherence") == 0);
  CHECK(error([](auto& o) { o.coherence = NAN; }).find("--coherence") == 0);
  CHECK(error([](auto& o) {
          o.coherence = 0.5;
          o.cells = {1, 1, 1};
        }).find("--coherence: 0.5: must be 1 with one cell") == 0);
  CHECK(error([](auto& o) { o.cells = {0, 4, 4}; }).find("--cells: 0x4x4: from 1 to 1024") == 0);
  CHECK(error([](auto& o) { o.cells = {1025, 1, 1}; }).find("--cells") == 0);
  CHECK(error([](auto& o) { o.cells = {512, 512, 512}; }).find("at most 16777216") != std::string::npos);
  CHECK(error([](auto& o) { o.interval_s = 0; }).find("--interval") == 0);
  CHECK(error([](auto& o) { o.interval_s = -1; }).find("--interval") == 0);
  CHECK(error([](auto& o) { o.interval_s = NAN; }).find("--interval") == 0);
  CHECK(error([](auto& o) { o.interval_s = 1e-40; }).find("1.1754943508222875e-38") != std::string::npos);
  CHECK(error([](auto& o) { o.interval_s = 1e36; }).find("--interval") == 0);
  CHECK(error([](auto& o) { o.interval_s = INFINITY; }).find("--interval") == 0);
  CHECK(error([](auto& o) { o.hold_s = -1; }).find("--hold") == 0);
  CHECK(error([](auto& o) { o.hold_s = INFINITY; }).find("--hold") == 0);
  CHECK(error([](auto& o) { o.seed = 1ULL << 53; }).find("--seed") == 0);
}

TEST_CASE("Times that float32 cannot tell apart are refused, naming an interval that works", "[errors]") {
  Scene scene = scattered(10, 13);
  AppearanceOptions options;
  options.cells = {256, 256, 256};
  const std::string error = error_of(scene, options);
  CHECK(error.find("--interval: 0.01 s") == 0);
  REQUIRE(error.find("is 0.015625 s") != std::string::npos);
  // It does work, what is finer by a thousandth does not.
  options.interval_s = 0.01561;
  CHECK(error_of(scene, options).find("is 0.015625 s") != std::string::npos);
  options.interval_s = 0.015625;
  CHECK(assign_appearance(scene, options).has_value());
  // Half as many cells are told apart at any interval.
  options.cells = {256, 256, 128};
  for (const double interval_s : {0.01, 0.1, 1.0 / 3.0, 0.999999, 7e-30}) {
    options.interval_s = interval_s;
    CHECK(assign_appearance(scene, options).has_value());
  }
}
