#include "timeline/statistics.h"

#include <catch2/catch.hpp>

#include "timeline/appearance.h"

namespace scenegen::timeline {
namespace {

/// Two kinds of mesh: a quad of two indexed triangles, and a strip of three beside the quad.
Scene sample() {
  Scene s;
  s.duration_s = 9.0F;
  s.geometries.resize(2);
  s.geometries[0].positions_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  s.geometries[0].indices = {0, 1, 2, 0, 2, 3};
  s.geometries[1].topology = Topology::triangle_strip;
  s.geometries[1].positions_m = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}, {0, 0, 2}};
  s.materials.resize(2);
  s.images.resize(1);
  s.textures.resize(3);
  s.cameras.resize(1);
  s.meshes = {{"quad", {{GeometryId(0), MaterialId(0)}}},
              {"both", {{GeometryId(0), MaterialId(1)}, {GeometryId(1), MaterialId(0)}}}};
  for (std::size_t i = 0; i < 5; ++i) {
    Transform at;
    at.translation_m.x = static_cast<float>(i) * 10.0F;
    s.objects.add("o" + std::to_string(i), MeshId(i == 4 ? 1 : 0), at);
  }
  return s;
}

TEST_CASE("counts of a static scene") {
  const Statistics s = statistics(sample());
  REQUIRE(s.objects == 5);
  REQUIRE(s.meshes == 2);
  REQUIRE(s.geometries == 2);
  REQUIRE(s.materials == 2);
  REQUIRE(s.textures == 3);
  REQUIRE(s.images == 1);
  REQUIRE(s.cameras == 1);
  REQUIRE(s.frames == 0);
  REQUIRE(s.vertices == 4 * 6 + 6 + 5);
  REQUIRE(s.triangles == 4 * 2 + 2 + 3);
  REQUIRE(s.unique_vertices == 4 + 5);
  REQUIRE(s.unique_triangles == 2 + 3);
  REQUIRE(s.classes == ClassCounts{5, 0, 0});
  REQUIRE(s.moments == 0);
  REQUIRE(s.events == 0);
  REQUIRE(s.mean_events == 0.0);
  REQUIRE(s.duration_s == 9.0);
  REQUIRE(s.bounds_m == Box{{0, 0, 0}, {41, 1, 2}});
  REQUIRE_FALSE(s.coherence_measured.has_value());
  REQUIRE_FALSE(s.locality_cells.has_value());
  REQUIRE_FALSE(s.jumps.has_value());
}

TEST_CASE("events per moment") {
  Scene scene = sample();
  const auto track = [&](std::vector<float> times, std::vector<float> values) {
    return scene.add_track(Property::visibility, Interpolation::step, times, values);
  };
  const TrackId a = track({0, 1, 9}, {0, 1, 1});
  const TrackId b = track({0, 1, 4}, {0, 1, 0});
  scene.objects.visibility = {a, a, b, TrackId(), TrackId()};
  const Statistics s = statistics(scene);
  REQUIRE(s.tracks == 2);
  REQUIRE(s.keys == 6);
  REQUIRE(s.moments == 2);  // 1 s: three objects, 4 s: one
  REQUIRE(s.events == 4);
  REQUIRE(s.least_events == 1);
  REQUIRE(s.most_events == 3);
  REQUIRE(s.mean_events == 2.0);
  REQUIRE(s.classes == ClassCounts{2, 3, 0});
}

TEST_CASE("coherence is measured again from the tracks, not copied") {
  Scene scene = sample();
  for (std::size_t i = 5; i < 40; ++i) {
    Transform at;
    at.translation_m = {static_cast<float>(i % 8) * 10.0F, 0.0F, static_cast<float>(i / 8) * 10.0F};
    scene.objects.add("o" + std::to_string(i), MeshId(0), at);
  }
  AppearanceOptions options;
  options.cells = {4, 4, 2};
  options.coherence = 0.75;
  REQUIRE(assign_appearance(scene, options));
  Statistics s = statistics(scene);
  REQUIRE(s.coherence_measured == 0.75);
  REQUIRE(s.locality_cells == scene.info.appearance->locality_cells);
  REQUIRE(s.events == 40);
  REQUIRE(s.moments == scene.info.appearance->moments);
  REQUIRE(s.classes == ClassCounts{0, 40, 0});

  scene.info.appearance->coherence_measured = 0.1;  // what a file says is not what is measured
  REQUIRE(statistics(scene).coherence_measured == 0.75);
}

TEST_CASE("jumps are those of the scene's own grid") {
  const auto jumps = [](glm::uvec3 cells, CurveKind curve) {
    Scene scene = sample();
    AppearanceOptions options;
    options.cells = cells;
    options.curve = curve;
    REQUIRE(assign_appearance(scene, options));
    const std::optional<std::uint64_t> found = statistics(scene).jumps;
    REQUIRE(found.has_value());
    CHECK(found == locality(curve, cells, {}).jumps);
    scene.info.appearance->curve = "peano";  // not one of ours: nothing is said
    CHECK_FALSE(statistics(scene).jumps.has_value());
    return *found;
  };
  CHECK(jumps({8, 8, 8}, CurveKind::hilbert) == 0);
  CHECK(jumps({5, 3, 7}, CurveKind::hilbert) > 0);
  CHECK(jumps({5, 3, 7}, CurveKind::row_prime) == 0);
  CHECK(jumps({2, 2, 2}, CurveKind::morton) == 3);
}

TEST_CASE("an empty scene has empty statistics") {
  const Statistics s = statistics(Scene{});
  REQUIRE(s.objects == 0);
  REQUIRE(s.bounds_m.empty());
}

}  // namespace
}  // namespace scenegen::timeline
