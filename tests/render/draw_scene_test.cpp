// Planning: geometry for the device, slots, the visible set, culling lists and orders. No device needed.
#include "render/draw_scene.h"

#include <algorithm>
#include <set>

#include "render/gpu_scene.h"
#include "render/strategy/draw_list.h"
#include "scene/random.h"
#include "tests/render/render_support.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;
using Indices = std::vector<std::uint32_t>;

namespace {

Geometry strip(Topology topology, std::size_t vertices) {
  Geometry g;
  g.topology = topology;
  for (std::size_t i = 0; i < vertices; ++i) g.positions_m.emplace_back(static_cast<float>(i), 0, 0);
  g.normals.assign(vertices, glm::vec3(0, 0, 1));
  return g;
}

/// Random boxes, some blended, with random times of appearance.
Scene random_scene(std::size_t objects) {
  Scene scene;
  Material glass = plain({1, 1, 1, 0.5F});
  glass.alpha_mode = AlphaMode::blend;
  const std::array meshes{add_mesh(scene, box_geometry(), plain({1, 0, 0, 1})),
                          add_mesh(scene, box_geometry(), glass),
                          add_mesh(scene, quad_geometry(), plain({0, 1, 0, 1}))};
  const Random random(3, "random scene");
  for (std::size_t i = 0; i < objects; ++i) {
    const auto unit = [&](std::uint64_t k) { return random.unit(8 * i + k); };
    const ObjectId id = add_object(scene, "o" + std::to_string(i), meshes[random.below(8 * i + 7, 3)],
                                   {unit(0) * 60 - 30, unit(1) * 20, unit(2) * 60 - 30},
                                   {unit(3) + 0.1F, unit(4) + 0.1F, unit(5) + 0.1F});
    if (i % 3 != 0) appear_at(scene, id, 1.0F + 8.0F * unit(6));
  }
  return scene;
}

}  // namespace

TEST_CASE("strips, fans and loops become lists with the winding of the specification") {
  CHECK(make_draw_geometry(strip(Topology::triangles, 7)).indices == Indices{0, 1, 2, 3, 4, 5});
  CHECK(make_draw_geometry(strip(Topology::triangle_strip, 5)).indices == Indices{0, 1, 2, 1, 3, 2, 2, 3, 4});
  CHECK(make_draw_geometry(strip(Topology::triangle_fan, 5)).indices == Indices{1, 2, 0, 2, 3, 0, 3, 4, 0});
  CHECK(make_draw_geometry(strip(Topology::lines, 5)).indices == Indices{0, 1, 2, 3});
  CHECK(make_draw_geometry(strip(Topology::line_strip, 3)).indices == Indices{0, 1, 1, 2});
  CHECK(make_draw_geometry(strip(Topology::line_loop, 3)).indices == Indices{0, 1, 1, 2, 2, 0});
  CHECK(make_draw_geometry(strip(Topology::points, 2)).indices == Indices{0, 1});
  for (const Topology t :
       {Topology::triangle_strip, Topology::triangle_fan, Topology::line_loop, Topology::triangles})
    for (std::size_t n = 0; n < 2; ++n) CHECK(make_draw_geometry(strip(t, n)).indices.empty());
}

TEST_CASE("triangles without normals get flat ones") {
  Geometry g = box_geometry();
  const std::vector<glm::vec3> expected = g.normals;
  const Indices fetched = g.indices;
  g.normals.clear();
  const DrawGeometry d = make_draw_geometry(g);
  REQUIRE(d.positions_m.size() == 36);
  for (std::size_t i = 0; i < 36; ++i) {
    CHECK(glm::vec3(d.attributes[i].normal) / 32767.0F == expected[fetched[i]]);
    CHECK(d.positions_m[i] == g.positions_m[fetched[i]]);
  }
}

TEST_CASE("slots stand in order of state and follow the player in both directions") {
  const Scene scene = random_scene(500);
  timeline::Player player(timeline::compile(scene));
  const TextureSets sets = texture_sets(scene);
  DrawScene drawn(scene, player, sets.of_material);
  REQUIRE(drawn.slot_count() == 500);
  for (const double t : {0.0, 2.5, 9.9, 4.0, 1.0, 7.0}) {
    drawn.apply(player.seek(t), player);
    CHECK(drawn.visible_object_count() == player.visible_count());
    std::set<std::uint32_t> seen;
    for (std::uint32_t slot = 0; slot < 500; ++slot) {
      CHECK(drawn.visible().test(slot) == player.visible(drawn.object(slot)));
      seen.insert(drawn.object(slot).value);
      if (slot > 0) CHECK(drawn.primitive(slot - 1).batch <= drawn.primitive(slot).batch);
    }
    CHECK(seen.size() == 500);
  }
}

TEST_CASE("a swapped mesh shows the new slots and hides the old") {
  Scene scene;
  const MeshId red = add_mesh(scene, box_geometry(), plain({1, 0, 0, 1}));
  const MeshId green = add_mesh(scene, box_geometry(), plain({0, 1, 0, 1}));
  scene.meshes[green.value].primitives.push_back(scene.meshes[red.value].primitives[0]);
  const ObjectId id = add_object(scene, "a", red, {0, 0, 0});
  add_object(scene, "b", green, {3, 0, 0});
  const std::array times{0.0F, 1.0F, 2.0F};
  const std::array values{0.0F, 1.0F, 0.0F};
  scene.object_mesh_tracks.push_back(
      {id, scene.add_track(Property::mesh, Interpolation::step, times, values)});
  scene.duration_s = 3;
  timeline::Player player(timeline::compile(scene));
  DrawScene drawn(scene, player, texture_sets(scene).of_material);
  CHECK(drawn.slot_count() == 5);
  const auto visible_of_a = [&] {
    std::multiset<std::uint32_t> meshes;
    for (std::uint32_t s = 0; s < drawn.slot_count(); ++s)
      if (drawn.object(s) == id && drawn.visible().test(s)) meshes.insert(drawn.primitive(s).mesh.value);
    return meshes;
  };
  CHECK(visible_of_a() == std::multiset<std::uint32_t>{red.value});
  drawn.apply(player.seek(1.5), player);
  CHECK(visible_of_a() == std::multiset<std::uint32_t>{green.value, green.value});
  drawn.apply(player.seek(2.5), player);
  CHECK(visible_of_a() == std::multiset<std::uint32_t>{red.value});
}

TEST_CASE("culling by arrays agrees with the test of one box at a time, and keeps the order") {
  const Scene scene = random_scene(3000);
  timeline::Player player(timeline::compile(scene));
  DrawScene drawn(scene, player, texture_sets(scene).of_material);
  drawn.apply(player.seek(5.0), player);
  for (const glm::vec3 eye : {glm::vec3(0, 5, 50), glm::vec3(0, 5, 0), glm::vec3(-20, 40, -20)}) {
    const View view = look(eye, {1, 4, -3}, {16, 9});
    const Frustum frustum = frustum_of(view.clip_from_world);
    DrawList list, all;
    list_in_frustum(drawn, cull_planes(frustum, drawn.bounds_m()), list);
    list_visible(drawn, all);
    CHECK(list.tested == all.solid.size() + all.blended.size());
    CHECK(std::is_sorted(list.solid.begin(), list.solid.end()));
    CHECK(std::includes(all.solid.begin(), all.solid.end(), list.solid.begin(), list.solid.end()));
    const std::set<std::uint32_t> kept(list.solid.begin(), list.solid.end());
    std::size_t missing = 0, extra = 0;
    for (const std::uint32_t slot : all.solid) {
      const Box box =
          transformed(drawn.primitive(slot).bounds_m, player.world_from_object(drawn.object(slot)));
      const bool touches = intersects(frustum, box);
      missing += touches && kept.count(slot) == 0 ? 1 : 0;
      extra += !touches && kept.count(slot) == 1 ? 1 : 0;
    }
    CHECK(missing == 0);
    CHECK(extra <= 2);  // the arrays' boxes are a few ulp larger
    CHECK(kept.size() < all.solid.size());
  }
}

TEST_CASE("blended slots go back to front, equal ones by object") {
  Scene scene;
  Material glass = plain({1, 1, 1, 0.5F});
  glass.alpha_mode = AlphaMode::blend;
  const MeshId pane = add_mesh(scene, quad_geometry(), glass);
  for (const float z : {1.0F, -4.0F, 3.0F, 1.0F, -9.0F})
    add_object(scene, "p" + std::to_string(scene.objects.size()), pane, {0, 0, z});
  timeline::Player player(timeline::compile(scene));
  DrawScene drawn(scene, player, texture_sets(scene).of_material);
  DrawList list;
  list_visible(drawn, list);
  CHECK(list.solid.empty());
  const auto objects = [&] {
    Indices out;
    for (const std::uint32_t slot : list.blended) out.push_back(drawn.object(slot).value);
    return out;
  };
  sort_back_to_front(drawn, look({0, 0, 10}, {0, 0, 0}, {16, 9}), list.blended);
  CHECK(objects() == Indices{4, 1, 0, 3, 2});
  sort_back_to_front(drawn, look({0, 0, -20}, {0, 0, 0}, {16, 9}), list.blended);
  CHECK(objects() == Indices{2, 0, 3, 1, 4});
}

TEST_CASE("moved objects give dirty records, once, with their new place") {
  Scene scene;
  const MeshId box = add_mesh(scene, box_geometry(), plain({1, 0, 0, 1}));
  scene.frames.push_back({});
  scene.frames[0].name = "lift";
  const ObjectId moving = scene.objects.add("moving", box, Transform{}, FrameId(0));
  add_object(scene, "still", box, {5, 0, 0});
  const std::array times{0.0F, 2.0F};
  const std::array values{0.0F, 0.0F, 0.0F, 0.0F, 4.0F, 0.0F};
  scene.frame_tracks.push_back(
      {FrameId(0), scene.add_track(Property::translation, Interpolation::linear, times, values)});
  scene.duration_s = 2;
  timeline::Player player(timeline::compile(scene));
  DrawScene drawn(scene, player, texture_sets(scene).of_material);
  drawn.apply(player.seek(1.0), player);
  REQUIRE(drawn.dirty_slots().size() == 1);
  CHECK(drawn.object(drawn.dirty_slots()[0]) == moving);
  CHECK(drawn.dirty_records()[0].world_from_object[1].w == Approx(2.0F));
  CHECK(drawn.dirty_records()[0].object == moving.value);
  drawn.clear_dirty();
  drawn.apply(player.seek(1.0), player);
  CHECK(drawn.dirty_slots().empty());

  // What shadows must reach depends on the time, not on where things have been.
  const Box at_1_s = drawn.bounds_m();
  CHECK(at_1_s.hi.y == Approx(2.5F));
  drawn.apply(player.seek(2.0), player);
  CHECK(drawn.bounds_m().hi.y == Approx(4.5F));
  drawn.apply(player.seek(1.0), player);
  CHECK(drawn.bounds_m() == at_1_s);
}
