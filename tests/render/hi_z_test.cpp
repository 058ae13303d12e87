// In which blocks, and in what order, `hi-z` draws. That it draws what `brute` does is
// tests/render/strategy_test.cpp's business.
#include <algorithm>
#include <array>

#include "render/passes/hi_z_layout.h"
#include "render/spatial/frustum_cull.h"
#include "scene/random.h"
#include "tests/render/strategy_paths.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;

namespace {

/// Small boxes of two geometries and two states, all over a flat place in no order; every fifth one moves
/// far away and back.
Scene scattered_scene(std::size_t objects) {
  Scene scene;
  Material both_sides = plain({0.2F, 0.8F, 0.2F, 1});
  both_sides.double_sided = true;
  const std::array meshes{add_mesh(scene, box_geometry(), plain({0.8F, 0.2F, 0.2F, 1})),
                          add_mesh(scene, quad_geometry(), plain({0.2F, 0.2F, 0.8F, 1})),
                          add_mesh(scene, box_geometry(), both_sides)};
  const Random random{7, "scattered"};
  for (std::size_t i = 0; i < objects; ++i) {
    FrameId frame;
    if (i % 5 == 0) {
      frame = FrameId(static_cast<std::uint32_t>(scene.frames.size()));
      scene.frames.emplace_back();
      scene.frame_tracks.push_back(
          {frame, scene.add_track(Property::translation, Interpolation::step, std::array{0.0F, 2.0F, 4.0F},
                                  std::array{0.0F, 0.0F, 0.0F, 0.0F, 40.0F, 0.0F, 0.0F, 0.0F, 0.0F})});
    }
    Transform at;
    at.translation_m = {100 * random.unit(3 * i) - 50, random.unit(3 * i + 1),
                        100 * random.unit(3 * i + 2) - 50};
    at.scale = glm::vec3(0.3F);
    scene.objects.add("box " + std::to_string(i), meshes[i % meshes.size()], at, frame);
  }
  scene.duration_s = 6;
  return scene;
}

struct Laid {
  explicit Laid(std::size_t objects)
      : source(scattered_scene(objects)),
        player(timeline::compile(source)),
        scene(source, player, std::vector<std::uint32_t>(source.materials.size() + 1, 0)),
        ranges(source.geometries.size(), GeometryRange{0, 36, 0, PrimitiveKind::triangles}),
        layout(scene, ranges, false),
        order(layout, scene) {}

  void seek(double time_s) {
    const timeline::ChangeSet& changes = player.seek(time_s);
    scene.apply(changes, player);
    for (const ObjectId id : changes.moved) {
      for (const std::uint32_t slot : scene.slots_of(id)) order.moved(slot, scene.boxes().get(slot));
    }
  }
  /// Slots whose blocks the frame looks at.
  [[nodiscard]] std::vector<bool> looked_at() const {
    std::vector<bool> out(scene.slot_count());
    for (const std::uint32_t b : order.blocks()) {
      const HiZBlock& block = layout.blocks[b];
      for (std::uint32_t i = 0; i < block.count; ++i) out[layout.slots[block.first + i]] = true;
    }
    return out;
  }

  Scene source;
  timeline::Player player;
  DrawScene scene;
  std::vector<GeometryRange> ranges;
  HiZLayout layout;
  HiZOrder order;
};

}  // namespace

TEST_CASE("blocks hold each slot once, of one state and geometry, and are compact") {
  const Laid laid(6000);
  std::vector<int> times(laid.scene.slot_count());
  double area = 0;
  for (std::size_t b = 0; b < laid.layout.blocks.size(); ++b) {
    const HiZBlock& block = laid.layout.blocks[b];
    REQUIRE(block.count > 0);
    REQUIRE(block.count <= laid.layout.block_slots);
    const DrawPrimitive& first = laid.scene.primitive(laid.layout.slots[block.first]);
    Box box;
    for (std::uint32_t i = 0; i < block.count; ++i) {
      const std::uint32_t slot = laid.layout.slots[block.first + i];
      ++times[slot];
      REQUIRE(laid.layout.block_of_slot[slot] == b);
      REQUIRE(laid.scene.primitive(slot).geometry == first.geometry);
      REQUIRE(laid.scene.primitive(slot).batch == first.batch);
      box.add(laid.scene.boxes().get(slot));
    }
    REQUIRE(laid.layout.runs[laid.layout.run_of_block[b]].batch == first.batch);
    area += double(box.size().x) * box.size().z;
  }
  CHECK(std::all_of(times.begin(), times.end(), [](int n) { return n == 1; }));
  CHECK(laid.layout.runs.size() == 2);
  // Three groups cover the place once each, and blocks of a group hardly overlap; in slot order each would
  // cover all of it.
  CHECK(area < 3 * 1.5 * 100 * 100);
}

TEST_CASE("how many blocks there will be is known before they are laid out") {
  for (const std::size_t objects : {1U, 100U, 300U, 6000U}) {
    const Laid laid(objects);
    const HiZCut cut(laid.scene);
    CHECK(cut.blocks() == laid.layout.blocks.size());
    CHECK(cut.block_slots == (objects == 6000 ? 256 : 64));
  }
}

TEST_CASE("a frame looks at the blocks in the frustum, also where their slots moved to, nearer ones first") {
  Laid laid(6000);
  const std::array views{look({0, 2, 0}, {30, 2, 5}, kPathSize), look({-45, 3, 40}, {0, 0, 0}, kPathSize),
                         look({0, 41, 0}, {-30, 41, 20}, kPathSize)};
  std::size_t least = laid.layout.blocks.size();
  for (const double time_s : {0.0, 3.0, 5.0}) {
    laid.seek(time_s);
    for (const View& view : views) {
      laid.order.rank(view);
      const auto blocks = laid.order.blocks();
      least = std::min(least, blocks.size());
      std::vector<std::uint64_t> inside(laid.scene.visible().words().size());
      cull_boxes(laid.scene.boxes(), cull_planes(frustum_of(view.clip_from_world), laid.scene.bounds_m()),
                 laid.scene.visible().words(), inside);
      const std::vector<bool> looked_at = laid.looked_at();
      std::size_t missed = 0;
      std::size_t in_frustum = 0;
      for (std::uint32_t slot = 0; slot < laid.scene.slot_count(); ++slot) {
        const bool in = (inside[slot / 64] >> (slot % 64) & 1U) != 0;
        in_frustum += in ? 1 : 0;
        missed += in && !looked_at[slot] ? 1 : 0;
      }
      CHECK(missed == 0);
      CHECK((in_frustum > 0) == (&view != &views[2] || time_s == 3.0));

      std::uint32_t next = 0;
      for (std::size_t r = 0; r < laid.layout.runs.size(); ++r) {
        const auto [first, count] = laid.order.parts()[r];
        CHECK(first == next);
        next += count;
        float before = 0;
        for (const std::uint32_t b : blocks.subspan(first, count)) {
          CHECK(laid.layout.run_of_block[b] == r);
          if (time_s > 0) continue;  // the middles of blocks are known here only at first
          Box box;
          for (std::uint32_t i = 0; i < laid.layout.blocks[b].count; ++i)
            box.add(laid.scene.boxes().get(laid.layout.slots[laid.layout.blocks[b].first + i]));
          const float distance_m = std::max(glm::dot(view.forward(), box.centre() - view.eye_m()), 0.0F);
          CHECK(distance_m > before - 0.3F);  // buckets are that wide
          before = std::max(before, distance_m);
        }
      }
      CHECK(next == blocks.size());
    }
  }
  CHECK(laid.layout.blocks.size() > 20);
  CHECK(least < laid.layout.blocks.size() / 2);
}

TEST_CASE("within a block what comes nearer is drawn first, whatever the order of the slots") {
  // Two quads in one plane, each with a spike towards the eye beside what is looked at: of equal depths the
  // first that is drawn stays, and that is the one with the longer spike.
  Geometry geometry = quad_geometry();
  const auto corner = static_cast<std::uint32_t>(geometry.positions_m.size());
  for (const glm::vec3 at : {glm::vec3(0.45F, 0.45F, 0), glm::vec3(0.5F, 0.5F, 0), glm::vec3(0.5F, 0.5F, 1)})
    geometry.positions_m.push_back(at);
  geometry.normals.resize(geometry.positions_m.size(), {0, 0, 1});
  geometry.texcoords[0].resize(geometry.positions_m.size());
  for (std::uint32_t i = 0; i < 3; ++i) geometry.indices.push_back(corner + i);
  for (const bool longer_first : {false, true}) {
    Path path{"spikes", {}, {}};
    const MeshId mesh = add_mesh(path.scene, geometry, plain({1, 0, 0, 1}));
    const ObjectId one = add_object(path.scene, "one", mesh, {0, 0, 0}, {4, 4, longer_first ? 2.0F : 1.0F});
    const ObjectId two = add_object(path.scene, "two", mesh, {0, 0, 0}, {4, 4, longer_first ? 1.0F : 2.0F});
    path.scene.duration_s = 1;
    path.frames.assign(3, {0, {0, 0, 8}, {0, 0, 0}});
    RendererOptions options = test_options();
    options.size = kPathSize;
    options.strategy = "hi-z";
    for (const FrameResult& frame : run_path(path, options).frames) {
      CHECK(frame.report.drawn == 2);
      CHECK(frame.ids[std::size_t{kPathSize.y / 2} * kPathSize.x + kPathSize.x / 2] ==
            (longer_first ? one : two).value);
    }
  }
}
