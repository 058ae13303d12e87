// An octree that is built and brought up to date in slices ends where one that followed every change is.
#include "render/spatial/scene_octree.h"

#include <algorithm>
#include <array>
#include <set>

#include "scene/random.h"
#include "tests/render/render_support.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;

namespace {

/// Boxes that come and go, some of which travel and turn inside out on the way.
Scene busy_scene(std::size_t objects) {
  Scene scene;
  const MeshId mesh = add_mesh(scene, box_geometry(), plain({0.5F, 0.5F, 0.5F, 1}));
  const Random random{5, "busy"};
  const auto unit = [&](std::size_t i, std::size_t k) { return random.unit(16 * i + k); };
  for (std::size_t i = 0; i < objects; ++i) {
    FrameId frame;
    if (i % 7 == 0) {
      frame = FrameId(static_cast<std::uint32_t>(scene.frames.size()));
      scene.frames.emplace_back();
      scene.frame_tracks.push_back(
          {frame,
           scene.add_track(Property::translation, Interpolation::step, std::array{0.0F, 10 * unit(i, 6)},
                           std::array{0.0F, 0.0F, 0.0F, 60 * unit(i, 4) - 30, 0.0F, 9.0F})});
      scene.frame_tracks.push_back(
          {frame, scene.add_track(Property::scale, Interpolation::step, std::array{0.0F, 10 * unit(i, 5)},
                                  std::array{1.0F, 1.0F, 1.0F, -1.0F, 1.0F, 1.0F})});
    }
    Transform at;
    at.translation_m = {50 * unit(i, 0), 8 * unit(i, 1), 50 * unit(i, 2)};
    const ObjectId id = scene.objects.add("box " + std::to_string(i), mesh, at, frame);
    const float t = 9.0F * unit(i, 3);
    scene.objects.visibility[id.value] =
        scene.add_track(Property::visibility, Interpolation::step, std::array{0.0F, t, t + 0.7F},
                        std::array{1.0F, 0.0F, 1.0F});
  }
  scene.duration_s = 10.0F;
  return scene;
}

std::vector<std::uint32_t> slots_of(const Octree& tree) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t c = 0; c < tree.chunk_numbers(); ++c) {
    if (tree.chunk(c).node == Octree::kNone) continue;
    out.insert(out.end(), tree.chunk(c).slots.begin(), tree.chunk(c).slots.end());
  }
  std::sort(out.begin(), out.end());
  return out;
}

void check_equal(const SceneOctree& late, const SceneOctree& prompt, const DrawScene& scene) {
  CHECK(slots_of(late.tree()) == slots_of(prompt.tree()));
  CHECK(late.tree().root().content.box_m.lo == prompt.tree().root().content.box_m.lo);
  CHECK(late.tree().root().content.box_m.hi == prompt.tree().root().content.box_m.hi);
  CHECK(late.tree().root().content.vertices == prompt.tree().root().content.vertices);
  for (std::uint32_t c = 0; c < late.tree().chunk_numbers(); ++c) {
    const Octree::Chunk& chunk = late.tree().chunk(c);
    if (chunk.node == Octree::kNone) continue;
    Box box;
    for (const std::uint32_t slot : chunk.slots) box.add(scene.boxes().get(slot));
    CHECK(box.lo == chunk.content.box_m.lo);
    CHECK(box.hi == chunk.content.box_m.hi);
  }
}

}  // namespace

TEST_CASE("what was put off is made good in slices, whatever happened in between") {
  const Scene source = busy_scene(3000);
  timeline::Player player(timeline::compile(source));
  DrawScene scene(source, player, std::array{0U, 0U});
  SceneOctree prompt(scene, 20);
  SceneOctree late(scene, 20, SceneOctree::Build::in_slices);
  CHECK(late.behind());
  CHECK(slots_of(late.tree()).empty());
  std::size_t slices = 0;
  std::size_t caught_up = 0;
  for (int frame = 0; frame < 120; ++frame) {
    const double t = frame < 80 ? frame * 0.125 : (120 - frame) * 0.2;  // and back again
    const timeline::ChangeSet& changes = player.seek(t);
    scene.apply(changes, player);
    prompt.update(changes);
    late.note(changes);
    if (frame % 40 < 20) continue;  // others are at work
    const std::size_t before = late.pending();
    const bool done = late.catch_up(1200);
    CHECK(before - late.pending() <= 1200);
    CHECK(done == !late.behind());
    ++slices;
    if (!done) continue;
    ++caught_up;
    check_equal(late, prompt, scene);
  }
  CHECK(slices > caught_up + 3);
  CHECK(caught_up > 10);
}

TEST_CASE("a slot that only went and came again while nobody looked keeps its chunk's commands") {
  const Scene source = busy_scene(200);
  timeline::Player player(timeline::compile(source));
  DrawScene scene(source, player, std::array{0U, 0U});
  SceneOctree late(scene, 20);
  std::set<std::uint32_t> moved;
  const auto go = [&](double t) {
    const timeline::ChangeSet& changes = player.seek(t);
    scene.apply(changes, player);
    late.note(changes);
    for (const ObjectId id : changes.moved) {
      for (const std::uint32_t slot : scene.slots_of(id)) {
        if (slot < scene.solid_end()) moved.insert(slot);
      }
    }
  };
  std::vector<std::uint64_t> revisions;
  for (std::uint32_t c = 0; c < late.tree().chunk_numbers(); ++c)
    revisions.push_back(late.tree().chunk(c).revision);
  go(5.0);
  go(0.0);
  // What moved; what is as visible as before is nothing to do.
  CHECK(late.pending() == moved.size());
  CHECK(moved.size() > 10);
  CHECK(late.catch_up(10'000));
  for (std::uint32_t c = 0; c < late.tree().chunk_numbers(); ++c)
    CHECK(late.tree().chunk(c).revision == revisions[c]);
  go(5.0);
  CHECK(late.catch_up(10'000));
  std::size_t renewed = 0;
  for (std::uint32_t c = 0; c < revisions.size(); ++c)
    renewed += late.tree().chunk(c).revision != revisions[c] ? 1 : 0;
  CHECK(renewed > 5);
}
