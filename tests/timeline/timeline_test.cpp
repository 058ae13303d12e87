#include "timeline/timeline.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "scene/random.h"
#include "timeline/event_sort.h"
#include "timeline/keys.h"
#include "timeline/ordered_marks.h"
#include "timeline/timeline_data.h"

namespace scenegen::timeline {
namespace {

Scene base_scene(std::size_t objects) {
  Scene s;
  s.duration_s = 10.0F;
  s.geometries.resize(1);
  s.materials.resize(2);
  s.meshes = {{"plain", {{GeometryId(0), MaterialId(0)}}}, {"bright", {{GeometryId(0), MaterialId(1)}}}};
  for (std::size_t i = 0; i < objects; ++i) s.objects.add("o" + std::to_string(i), MeshId(0), Transform{});
  return s;
}

TrackId visibility(Scene& s, std::vector<float> times, std::vector<float> values) {
  return s.add_track(Property::visibility, Interpolation::step, times, values);
}

template <class T>
std::vector<T> to_vector(std::span<const T> s) {
  return {s.begin(), s.end()};
}

TEST_CASE("classes: constant, pseudo-dynamic, dynamic") {
  Scene s = base_scene(9);
  s.frames.resize(4);
  s.frames[1].parent = FrameId(0);
  s.frame_tracks = {
      {FrameId(0), s.add_track(Property::translation, Interpolation::linear, std::vector{0.0F, 1.0F},
                               std::vector{0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F})},
      // Two equal keys move nothing.
      {FrameId(2), s.add_track(Property::scale, Interpolation::linear, std::vector{0.0F, 1.0F},
                               std::vector{2.0F, 2.0F, 2.0F, 2.0F, 2.0F, 2.0F})}};
  s.material_tracks = {
      {MaterialId(1), s.add_track(Property::emissive, Interpolation::step, std::vector{0.0F, 1.0F},
                                  std::vector{0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F})}};
  // 0: no track at all
  s.objects.visibility[1] = visibility(s, {0, 1}, {0, 1});  // appears
  s.objects.visibility[2] = visibility(s, {0, 1}, {1, 1});  // always visible
  s.objects.visibility[3] = visibility(s, {0, 1}, {0, 0});  // never visible
  s.objects.frame[4] = FrameId(1);                          // carried by its parent's motion
  s.objects.visibility[4] = s.objects.visibility[1];
  s.objects.frame[5] = FrameId(2);  // on a frame that never moves
  s.object_mesh_tracks = {{ObjectId(6), s.add_track(Property::mesh, Interpolation::step,
                                                    std::vector{0.0F, 2.0F}, std::vector{0.0F, 1.0F})}};
  s.objects.mesh[7] = MeshId(1);    // its material changes colour
  s.objects.frame[8] = FrameId(3);  // at rest
  const auto t = compile(s);
  using enum ObjectClass;
  const std::vector<ObjectClass> expected{constant, pseudo_dynamic, constant,       pseudo_dynamic, dynamic,
                                          constant, pseudo_dynamic, pseudo_dynamic, constant};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    INFO("object " << i);
    REQUIRE(t->object_class(ObjectId(i)) == expected[i]);
  }
  REQUIRE(t->class_counts() == ClassCounts{4, 4, 1});
  REQUIRE(to_vector(t->moving_objects()) == std::vector{ObjectId(4)});
  REQUIRE(t->object_count() == 9);
  REQUIRE(t->material_count() == 2);
  REQUIRE(t->duration_s() == 10.0);
}

TEST_CASE("the event index holds what changes, once, in order of time") {
  Scene s = base_scene(5);
  const TrackId a = visibility(s, {0, 1, 2, 10}, {0, 1, 1, 1});  // only the key at 1 changes anything
  const TrackId b = visibility(s, {0, 1, 3}, {1, 0, 1});
  visibility(s, {0, 5}, {0, 1});  // nobody's
  s.objects.visibility = {a, b, a, TrackId(), a};
  s.frames.resize(1);
  // Moves between 4 and 6 and between 7 and 8: four events.
  s.frame_tracks = {
      {FrameId(0), s.add_track(Property::translation, Interpolation::linear,
                               std::vector{0.0F, 4.0F, 6.0F, 6.5F, 7.0F, 8.0F},
                               std::vector<float>{0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 2, 0, 0})}};
  const auto t = compile(s);
  REQUIRE(to_vector(t->visibility_times_s()) == std::vector{1.0F, 3.0F});
  REQUIRE(to_vector(t->visibility_changes()) == std::vector<std::uint64_t>{4, 1});
  REQUIRE(to_vector(t->event_times_s()) == std::vector{1.0F, 3.0F, 4.0F, 6.0F, 7.0F, 8.0F});
  REQUIRE(t->data().visibility.track_count() == 2);
  REQUIRE(to_vector(t->data().visibility.objects[0]) == std::vector<std::uint32_t>{0, 2, 4});
  REQUIRE(to_vector(t->data().visibility.objects[1]) == std::vector<std::uint32_t>{1});
  REQUIRE(t->data().keys.time_s.size() == 4);
}

TEST_CASE("an empty scene compiles") {
  const auto t = compile(Scene{});
  REQUIRE(t->object_count() == 0);
  REQUIRE(t->event_times_s().empty());
  REQUIRE(t->class_counts() == ClassCounts{});
}

TEST_CASE("sort_by_time is stable and in order, below and above the radix threshold") {
  for (const std::size_t count : {0UL, 1UL, 100UL, 5000UL, 70000UL}) {
    const Random random(count, "sort");
    std::vector<TimedItem> events;
    for (std::uint32_t i = 0; i < count; ++i) {
      const float t = static_cast<float>(random.below(i, 1000)) * 0.37F - 90.0F;
      events.push_back({i % 17 == 0 ? (i % 2 == 0 ? -0.0F : 0.0F) : t, i});
    }
    std::vector<TimedItem> expected = events;
    std::stable_sort(expected.begin(), expected.end(),
                     [](const TimedItem& a, const TimedItem& b) { return a.time_s < b.time_s; });
    sort_by_time(events);
    const bool same = std::equal(events.begin(), events.end(), expected.begin(), expected.end(),
                                 [](const TimedItem& a, const TimedItem& b) { return a.item == b.item; });
    REQUIRE(same);
  }
}

TEST_CASE("OrderedMarks drains ascending, without duplicates, and is then empty") {
  constexpr std::uint32_t kCount = 2'000'000;  // eight words at the top
  OrderedMarks marks(kCount);
  const Random random(5, "marks");
  std::vector<std::uint32_t> expected{0, kCount - 1};
  for (std::uint64_t i = 0; i < 3000; ++i)
    expected.push_back(static_cast<std::uint32_t>(random.below(i, kCount)));
  for (const std::uint32_t i : expected) marks.set(i);
  std::sort(expected.begin(), expected.end());
  expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
  std::vector<std::uint32_t> got;
  marks.drain([&](std::uint32_t i) { got.push_back(i); });
  REQUIRE(got == expected);
  marks.drain([&](std::uint32_t) { FAIL("not empty"); });

  // Greater ones set on the way are visited on the way.
  got.clear();
  marks.set(3);
  marks.drain([&](std::uint32_t i) {
    got.push_back(i);
    if (i < 200'000) marks.set(i * 9 + 1);
  });
  REQUIRE(got == std::vector<std::uint32_t>{3, 28, 253, 2278, 20503, 184528, 1660753});
}

TEST_CASE("OrderedMarks: what is flipped twice is gone") {
  OrderedMarks marks(1000);
  for (const std::uint32_t i : {5U, 900U, 5U, 64U, 65U, 64U}) marks.flip(i);
  std::vector<std::uint64_t> got;
  marks.drain_words([&](std::size_t word, std::uint64_t bits) {
    got.push_back(word);
    got.push_back(bits);
  });
  REQUIRE(got == std::vector<std::uint64_t>{1, 2, 14, 16});
}

TEST_CASE("segment_at counts the keys passed") {
  const std::vector<float> times{1.0F, 2.0F, 4.0F};
  REQUIRE(segment_at(times, 0.0) == -1);
  REQUIRE(segment_at(times, 1.0) == 0);
  REQUIRE(segment_at(times, 1.999999999) == 0);
  REQUIRE(segment_at(times, 2.0) == 1);
  REQUIRE(segment_at(times, 99.0) == 2);
}

}  // namespace
}  // namespace scenegen::timeline
