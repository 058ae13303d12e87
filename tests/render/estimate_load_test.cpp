// What the model is told about lists of slots and chunks, against sums over all of them.
#include "render/strategy/estimate_load.h"

#include <numeric>

#include "render/spatial/scene_octree.h"
#include "render/strategy/draw_list.h"
#include "render/strategy/picture.h"
#include "render/strategy/touched_chunks.h"
#include "scene/random.h"
#include "tests/render/render_support.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;

namespace {

constexpr glm::uvec2 kSize{400, 300};

/// Boxes and quads of many sizes, each fourth to come later, some of glass.
Scene boxes_scene(std::size_t objects) {
  Scene scene;
  Material glass = plain({1, 1, 1, 0.5F});
  glass.alpha_mode = AlphaMode::blend;
  const std::array meshes{add_mesh(scene, box_geometry(), plain({1, 0, 0, 1})),
                          add_mesh(scene, quad_geometry(), plain({0, 1, 0, 1})),
                          add_mesh(scene, box_geometry(), glass)};
  const Random random(5, "estimates");
  for (std::size_t i = 0; i < objects; ++i) {
    const auto unit = [&](std::uint64_t k) { return random.unit(8 * i + k); };
    const ObjectId id = add_object(scene, "o" + std::to_string(i), meshes[i % 7 == 0 ? 2 : i % 2],
                                   {unit(0) * 40 - 20, unit(1) * 10, unit(2) * 40 - 20},
                                   glm::vec3(0.2F) + glm::vec3(unit(3), unit(4), unit(5)));
    if (i % 4 == 0) appear_at(scene, id, 5.0F);
  }
  return scene;
}

struct Sum {
  double draws = 0, vertices = 0, triangles = 0, fragments = 0;
};
Sum sum_of(const DrawScene& scene, const std::vector<std::uint32_t>& slots, const ScreenArea& screen) {
  Sum sum;
  for (const std::uint32_t slot : slots) {
    sum.draws += 1;
    sum.vertices += scene.primitive(slot).work.vertices;
    sum.triangles += scene.primitive(slot).work.triangles;
    sum.fragments += screen.spot(scene.boxes().get(slot)).fragments();  // all are in the picture
  }
  return sum;
}

}  // namespace

TEST_CASE("loads are exact up to 512 slots, and near above") {
  for (const std::size_t objects : {300, 20'000}) {
    const Scene source = boxes_scene(objects);
    const timeline::Player player(timeline::compile(source));
    const DrawScene scene(source, player, std::vector<std::uint32_t>(source.materials.size() + 1, 0));
    const ScreenArea screen(look({0, 20, 60}, {0, 5, 0}, kSize), kSize);
    DrawList list;
    list_visible(scene, list);
    const Sum all = sum_of(scene, list.solid, screen);
    const double tolerance = objects == 300 ? 1e-9 : 0.1;
    for (const model::Load& load :
         {load_of_slots(scene, list.solid, screen), load_of_visible(scene, screen)}) {
      CHECK(load.draws == all.draws);
      CHECK(load.vertices == Approx(all.vertices).epsilon(tolerance));
      CHECK(load.fragments == Approx(all.fragments).epsilon(tolerance));
      CHECK(load.textured_share == 0);
      // They stand in the lower half of the picture, above one another.
      CHECK(load.screen_share < 1 - std::exp(-load.fragments / 120'000));
      CHECK(load.screen_share > 0.2 * (1 - std::exp(-load.fragments / 120'000)));
    }

    const SceneOctree octree(scene, 20);
    std::vector<std::uint32_t> chunks;
    for (std::uint32_t i = 0; i < octree.tree().chunk_numbers(); ++i) {
      if (octree.tree().chunk(i).node != Octree::kNone) chunks.push_back(i);
    }
    const model::Load load = load_of_chunks(scene, octree.tree(), chunks, screen);
    CHECK(load.draws == all.draws);
    CHECK(load.vertices == all.vertices);
    CHECK(load.triangles == all.triangles);
    CHECK(load.fragments == Approx(all.fragments).epsilon(tolerance));
  }
}

TEST_CASE("what is near the eye does not stand for hundreds of its kind") {
  const Scene source = boxes_scene(20'000);
  const timeline::Player player(timeline::compile(source));
  const DrawScene scene(source, player, std::vector<std::uint32_t>(source.materials.size() + 1, 0));
  // Amid the boxes, looking along them: some are sampled that fill the picture.
  const View view = look({0, 5, 15}, {0, 5, 0}, kSize);
  DrawList list;
  list_in_frustum(scene, cull_planes(frustum_of(view.clip_from_world), scene.bounds_m()), list);
  const ScreenArea screen(view, kSize);
  double all = 0;
  for (const std::uint32_t slot : list.solid) {
    const std::uint32_t one[]{slot};
    all += load_of_slots(scene, one, screen).fragments;
  }
  REQUIRE(list.solid.size() > 2 * kSampledSlots);
  CHECK(load_of_slots(scene, list.solid, screen).fragments == Approx(all).epsilon(0.5));
}

TEST_CASE("a sample of words of slots tells what is in the frustum") {
  const Scene source = boxes_scene(20'000);
  const timeline::Player player(timeline::compile(source));
  const DrawScene scene(source, player, std::vector<std::uint32_t>(source.materials.size() + 1, 0));
  const View view = look({0, 20, 30}, {10, 5, 0}, kSize);
  const CullPlanes planes = cull_planes(frustum_of(view.clip_from_world), scene.bounds_m());
  DrawList all;
  list_in_frustum(scene, planes, all);
  const ScreenArea screen(view, kSize);
  const model::Load whole = load_of_slots(scene, all.solid, screen);
  DrawList some;
  const model::Load estimated = estimated_in_frustum(scene, planes, screen, some);
  CHECK(static_cast<double>(some.tested) < 0.5 * static_cast<double>(all.tested));
  REQUIRE(whole.draws < 0.8 * static_cast<double>(all.tested));  // the frustum leaves something out
  CHECK(estimated.draws == Approx(whole.draws).epsilon(0.1));
  CHECK(estimated.vertices == Approx(whole.vertices).epsilon(0.1));
  CHECK(estimated.fragments == Approx(whole.fragments).epsilon(0.25));
}

TEST_CASE("few heavy things among many light ones are counted as they are") {
  // One in forty takes 500 times as much, and has its slots together.
  Scene source = boxes_scene(20'000);
  Geometry heavy = box_geometry();
  const std::vector<glm::vec3> once = heavy.positions_m;
  for (int i = 1; i < 500; ++i) heavy.positions_m.insert(heavy.positions_m.end(), once.begin(), once.end());
  heavy.normals.clear();
  heavy.tangents.clear();
  for (auto& texcoords : heavy.texcoords) texcoords.clear();
  const MeshId mesh = add_mesh(source, heavy, plain({0, 0, 1, 1}));
  const Random random(6, "heavy");
  for (std::size_t i = 0; i < 500; ++i) {
    const auto unit = [&](std::uint64_t k) { return random.unit(8 * i + k); };
    const ObjectId id = add_object(source, "h" + std::to_string(i), mesh,
                                   {unit(0) * 40 - 20, unit(1) * 10, unit(2) * 40 - 20}, glm::vec3(0.5F));
    if (i % 3 != 0) appear_at(source, id, 5.0F);
  }
  const timeline::Player player(timeline::compile(source));
  DrawScene scene(source, player, std::vector<std::uint32_t>(source.materials.size() + 1, 0));
  REQUIRE(scene.strata().size() >= 2);
  const View view = look({0, 20, 30}, {10, 5, 0}, kSize);
  const CullPlanes planes = cull_planes(frustum_of(view.clip_from_world), scene.bounds_m());
  const ScreenArea screen(view, kSize);
  DrawList all;
  list_in_frustum(scene, planes, all);
  const Sum sum = sum_of(scene, all.solid, screen);
  REQUIRE(all.solid.size() > kSampledSlots);
  const model::Load listed = load_of_slots(scene, all.solid, screen);
  CHECK(listed.vertices == sum.vertices);
  CHECK(listed.triangles == sum.triangles);
  std::vector<std::uint32_t> backwards(all.solid.rbegin(), all.solid.rend());
  CHECK(load_of_slots(scene, backwards, screen).vertices == sum.vertices);
  DrawList some;
  const model::Load estimated = estimated_in_frustum(scene, planes, screen, some);
  CHECK(estimated.draws == Approx(sum.draws).epsilon(0.1));
  CHECK(estimated.vertices == Approx(sum.vertices).epsilon(0.1));
  CHECK(estimated.triangles == Approx(sum.triangles).epsilon(0.1));
}

TEST_CASE("the few that are visible of many that stand together are met") {
  Scene source = boxes_scene(40'000);
  Geometry heavy = box_geometry();
  const std::vector<glm::vec3> once = heavy.positions_m;
  for (int i = 1; i < 100; ++i) heavy.positions_m.insert(heavy.positions_m.end(), once.begin(), once.end());
  heavy.normals.clear();
  heavy.tangents.clear();
  for (auto& texcoords : heavy.texcoords) texcoords.clear();
  const MeshId mesh = add_mesh(source, heavy, plain({0, 0, 1, 1}));
  for (int i = 0; i < 20'000; ++i) {
    const ObjectId id = add_object(source, "s" + std::to_string(i), mesh,
                                   {static_cast<float>(i % 20) - 10.0F, 5, 0}, glm::vec3(0.5F));
    if (i < 9000 || i >= 9200) appear_at(source, id, 5.0F);
  }
  const timeline::Player player(timeline::compile(source));
  const DrawScene scene(source, player, std::vector<std::uint32_t>(source.materials.size() + 1, 0));
  const View view = look({0, 20, 60}, {0, 5, 0}, kSize);
  const CullPlanes planes = cull_planes(frustum_of(view.clip_from_world), scene.bounds_m());
  const ScreenArea screen(view, kSize);
  DrawList all;
  DrawList some;
  list_in_frustum(scene, planes, all);
  const Sum sum = sum_of(scene, all.solid, screen);
  CHECK(estimated_in_frustum(scene, planes, screen, some).vertices == Approx(sum.vertices).epsilon(0.1));
}

TEST_CASE("pictures are alike until a seek or a cut") {
  const Box scene_m{{0, 0, 0}, {30, 0, 40}};  // a twentieth of the diagonal is 2.5 m
  const Picture one{{0, 0, 0}, {1, 0, 0}, 1000};
  CHECK(alike(one, one, scene_m));
  const auto with = [&](const glm::vec3& eye_m, float turned_rad, double visible) {
    const Picture other{eye_m, {std::cos(turned_rad), std::sin(turned_rad), 0}, visible};
    CHECK(alike(one, other, scene_m) == alike(other, one, scene_m));
    return alike(one, other, scene_m);
  };
  CHECK(with({2.4F, 0, 0}, 0, 1000));
  CHECK(!with({2.6F, 0, 0}, 0, 1000));
  CHECK(with({0, 0, 0}, glm::radians(25.0F), 1000));
  CHECK(!with({0, 0, 0}, glm::radians(27.0F), 1000));
  CHECK(with({0, 0, 0}, 0, 1300));
  CHECK(!with({0, 0, 0}, 0, 1400));
  CHECK(with({0, 0, 0}, 0, 760));
  CHECK(!with({0, 0, 0}, 0, 740));
}

TEST_CASE("the ground counts once, whether the sample meets it or not") {
  for (std::size_t objects = 2000; objects < 2012; ++objects) {
    Scene source = boxes_scene(objects);
    const MeshId ground = add_mesh(source, box_geometry(), plain({0, 1, 0, 1}));
    add_object(source, "ground", ground, {0, -1, 0}, {45, 0.1F, 45});
    const timeline::Player player(timeline::compile(source));
    const DrawScene scene(source, player, std::vector<std::uint32_t>(source.materials.size() + 1, 0));
    const ScreenArea screen(look({0, 20, 60}, {0, 5, 0}, kSize), kSize);
    DrawList list;
    list_visible(scene, list);
    CHECK(scene.large_slots().size() == 1);
    const double all = sum_of(scene, list.solid, screen).fragments;
    CHECK(load_of_slots(scene, list.solid, screen).fragments == Approx(all).epsilon(0.1));
    CHECK(load_of_visible(scene, screen).fragments == Approx(all).epsilon(0.1));
  }
}

TEST_CASE("from a sample of changes it is guessed how many chunks they touch") {
  const Scene source = boxes_scene(20'000);
  timeline::Player player(timeline::compile(source));
  DrawScene scene(source, player, std::vector<std::uint32_t>(source.materials.size() + 1, 0));
  SceneOctree octree(scene, 100);
  ChunksTouched touched(scene, 100);
  CHECK(touched.count(player.seek(1.0)).recorded == 0);
  const auto follow = [&](double time_s) {
    const timeline::ChangeSet& changes = player.seek(time_s);
    scene.apply(changes, player);
    octree.update(changes);
    return touched.count(changes);
  };
  // A fourth of all comes, everywhere: every chunk is recorded anew, none loses anything.
  const model::TouchedChunks come = follow(6.0);
  const auto chunks = static_cast<double>(octree.tree().chunk_count());
  CHECK(come.recorded == Approx(chunks).epsilon(0.4));
  CHECK(come.changed == come.recorded);
  CHECK(come.left == 0);
  const std::uint64_t before = octree.tree().refreshed().slots;
  const model::TouchedChunks gone = follow(1.0);
  CHECK(gone.left == gone.recorded);
  const auto slots = static_cast<double>(octree.tree().refreshed().slots - before);
  CHECK(70.0 * gone.left == Approx(slots).epsilon(0.4));
}

TEST_CASE("an orthographic view counts the pixels of a box wherever it is") {
  Lens lens;
  lens.orthographic = true;
  lens.xmag_m = 4;
  lens.ymag_m = 3;
  lens.far_m = 100;
  const ScreenArea screen(make_view(look_at({0, 0, 50}, {0, 0, 0}), lens, 4.0F / 3.0F), kSize);
  for (const float z : {-20.0F, 0.0F, 30.0F})  // 50 pixels a metre
    CHECK(screen.fragments({{-0.5F, -0.5F, z - 0.5F}, {0.5F, 0.5F, z + 0.5F}}) == Approx(2500));
  CHECK(screen.fragments({{-50, -50, -1}, {50, 50, 1}}) == screen.pixels());
  const ScreenArea::Spot spot = screen.spot({{-3, 0, -1}, {-1, 2, 5}});
  CHECK(spot.sides.x == Approx(100));
  CHECK(spot.sides.y == Approx(100));
  CHECK(spot.middle.x == Approx(100));
  CHECK(spot.middle.y == Approx(100));
}

TEST_CASE("a box covers what is seen of it from where the eye is") {
  const ScreenArea screen(look({0, 0, 10}, {0, 0, 0}, kSize), kSize);
  const double face = screen.spot({{-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F}}).fragments();
  // From in front one face, at the distance of the box's middle; from a corner all three.
  const ScreenArea corner(look({5.7735F, 5.7735F, 5.7735F}, {0, 0, 0}, kSize), kSize);
  const double all = corner.spot({{-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F}}).fragments();
  CHECK(all == Approx(std::sqrt(3.0) * face).epsilon(1e-3));
  // What surrounds the eye covers the picture.
  CHECK(screen.spot({{-50, -50, -50}, {50, 50, 50}}).fragments() == Approx(120'000.0));
  // A wall is as wide and as high as it is seen.
  const ScreenArea::Spot wall = screen.spot({{-2, -0.5F, 0}, {2, 0.5F, 0}});
  CHECK(wall.sides.x == Approx(4 * wall.sides.y));
}

TEST_CASE("nothing to draw is no load") {
  const Scene source = boxes_scene(0);
  const timeline::Player player(timeline::compile(source));
  const DrawScene scene(source, player, std::vector<std::uint32_t>(source.materials.size() + 1, 0));
  const ScreenArea screen(look({0, 20, 60}, {0, 5, 0}, kSize), kSize);
  const model::Load load = load_of_visible(scene, screen);
  CHECK(load.draws + load.vertices + load.triangles + load.fragments + load.textured_share +
            load.screen_share ==
        0);
}
