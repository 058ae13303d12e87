// optimize(): less of everything, and nothing else to see at any time.
#include "scene/optimize/optimize.h"

#include <catch2/catch.hpp>
#include <string>

#include "scene/validate.h"
#include "tests/support/synthetic_scene.h"
#include "tests/timeline/random_scene.h"
#include "timeline/compare.h"

namespace {

using namespace scenegen;

OptimizeReport optimized(Scene& scene) {
  const Scene before = scene;
  const OptimizeReport report = optimize(scene);
  const auto findings = validate(scene);
  if (!findings.empty()) FAIL(findings.front().where + ": " + findings.front().what);
  const timeline::Comparison comparison = timeline::compare(before, scene);
  if (!comparison.equal())
    FAIL(comparison.differences.front().where + ": " + comparison.differences.front().what);
  return report;
}

/// 24 vertices with normals and, if wanted, texture coordinates.
Geometry box(const glm::vec3& lo, const glm::vec3& hi, bool textured = false) {
  Geometry g;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const auto first = static_cast<std::uint32_t>(g.positions_m.size());
      for (int corner = 0; corner < 4; ++corner) {
        glm::vec3 p;
        p[axis] = side == 0 ? lo[axis] : hi[axis];
        p[(axis + 1) % 3] = corner % 2 == 0 ? lo[(axis + 1) % 3] : hi[(axis + 1) % 3];
        p[(axis + 2) % 3] = corner / 2 == 0 ? lo[(axis + 2) % 3] : hi[(axis + 2) % 3];
        glm::vec3 normal(0.0F);
        normal[axis] = side == 0 ? -1.0F : 1.0F;
        g.positions_m.push_back(p);
        g.normals.push_back(normal);
        if (textured) g.texcoords[0].emplace_back(p[(axis + 1) % 3], p[(axis + 2) % 3]);
      }
      for (const std::uint32_t i : {0U, 1U, 2U, 2U, 1U, 3U}) g.indices.push_back(first + i);
    }
  }
  return g;
}

/// An octahedron: its normals lean, so stretching it along one axis would bend them.
Geometry octahedron(const glm::vec3& size) {
  Geometry g;
  for (const float x : {-1.0F, 1.0F}) {
    for (const float y : {-1.0F, 1.0F}) {
      for (const float z : {-1.0F, 1.0F}) {
        for (const glm::vec3& p : {glm::vec3(x, 0, 0), glm::vec3(0, y, 0), glm::vec3(0, 0, z)}) {
          g.positions_m.push_back(size * p);
          g.normals.push_back(glm::normalize(glm::vec3(x, y, z)));
        }
      }
    }
  }
  return g;
}

Transform turned(const glm::vec3& at) {
  return {at, glm::normalize(glm::quat(0.9F, 0.1F, 0.3F, -0.2F)), {1.5F, 0.5F, 2.0F}};
}

/// One object for each geometry, all of one material.
Scene scene_of(const std::vector<Geometry>& geometries) {
  Scene s;
  s.duration_s = 4.0F;
  s.materials.resize(1);
  for (const Geometry& g : geometries) {
    const std::string number = std::to_string(s.geometries.size());
    s.meshes.push_back({"mesh " + number, {{GeometryId(s.geometries.size()), MaterialId(0)}}});
    s.objects.add("object " + number, MeshId(s.geometries.size()),
                  turned({3.0F * static_cast<float>(s.geometries.size()), 1, 2}));
    s.geometries.push_back(g);
  }
  return s;
}

}  // namespace

TEST_CASE("random scenes look the same at every event and between, and optimizing again changes nothing") {
  std::uint64_t left = 0, constant = 0, keys = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    INFO("seed " << seed);
    Scene scene = timeline::test::RandomScene(seed).make(60, seed % 3 == 0 ? 0 : 9);
    for (Frame& frame : scene.frames)
      frame.local.scale = glm::vec3(frame.local.scale.x);  // turned, but no shear
    const OptimizeReport report = optimized(scene);
    left += report.unframed_objects;
    constant += report.constant_tracks;
    keys += report.idle_keys;
    const OptimizeReport again = optimized(scene);
    CHECK(again.constant_tracks + again.idle_keys + again.equal_tracks + again.equal_meshes +
              again.unframed_objects + again.stretched_objects ==
          0);
  }
  CHECK(left > 100);
  CHECK(constant > 20);
  CHECK(keys > 100);
}

TEST_CASE("a scene with a little of everything stays as it is to see") {
  Scene scene = testing::everything_scene();
  const OptimizeReport report = optimized(scene);
  CHECK(report.after.tracks < report.before.tracks);
  Scene town = testing::town_scene(3000, 64);
  optimized(town);
}

TEST_CASE("equal content becomes one, whatever its name") {
  Scene scene = scene_of({box({0, 0, 0}, {1, 1, 1}, true), box({0, 0, 0}, {1, 1, 1}, true)});
  scene.images = {
      {"a", "image/png", {1, 2, 3}}, {"b", "image/png", {1, 2, 3}}, {"c", "image/png", {1, 2, 4}}};
  scene.textures = {{ImageId(0), {}}, {ImageId(1), {}}, {ImageId(2), {}}};
  scene.materials.resize(4);
  for (std::uint32_t m = 0; m < 4; ++m) scene.materials[m].name = "material " + std::to_string(m);
  for (std::uint32_t m = 0; m < 3; ++m) scene.materials[m].base_color_texture.texture = TextureId(m);
  scene.meshes[1].primitives[0].material = MaterialId(1);
  scene.meshes.push_back({"another image", {{GeometryId(0), MaterialId(2)}}});
  scene.objects.add("object 2", MeshId(2), {});
  const OptimizeReport report = optimized(scene);
  CHECK(report.equal_images == 1);
  CHECK(report.equal_textures == 1);
  CHECK(report.equal_materials == 1);
  CHECK(report.equal_geometries == 1);
  CHECK(report.equal_meshes == 1);
  CHECK(report.after.materials == 2);  // the unused one is gone
  CHECK(scene.objects.mesh == std::vector{MeshId(0), MeshId(0), MeshId(1)});
  CHECK(scene.meshes[0].name == "mesh 0");
}

TEST_CASE("materials with other timelines are other materials") {
  Scene scene = scene_of({box({0, 0, 0}, {1, 1, 1}), box({0, 0, 0}, {1, 1, 1}), box({0, 0, 0}, {1, 1, 1})});
  scene.materials.resize(3);
  for (std::uint32_t m = 0; m < 3; ++m) scene.meshes[m].primitives[0].material = MaterialId(m);
  const auto track = [&](float late) {
    return scene.add_track(Property::base_color, Interpolation::step, std::vector{0.0F, late},
                           std::vector<float>{1, 0, 0, 1, 0, 1, 0, 1});
  };
  scene.material_tracks = {
      {MaterialId(0), track(1.0F)}, {MaterialId(1), track(1.0F)}, {MaterialId(2), track(2.0F)}};
  const OptimizeReport report = optimized(scene);
  CHECK(report.equal_tracks == 1);
  CHECK(report.equal_materials == 1);
  CHECK(scene.materials.size() == 2);
  CHECK(scene.material_tracks.size() == 2);
  CHECK(scene.objects.mesh[0] == scene.objects.mesh[1]);
  CHECK(scene.objects.mesh[0] != scene.objects.mesh[2]);
}

TEST_CASE("boxes of any size and place are one box, stretched by their objects") {
  Scene scene = scene_of({box({0, 0, 0}, {1, 1, 1}), box({-0.3F, 0.1F, 2}, {0.7F, 0.35F, 2.6F}),
                          box({10, 10, 10}, {14, 11, 10.1F})});
  const OptimizeReport report = optimized(scene);
  CHECK(report.stretched_meshes == 2);
  CHECK(report.stretched_objects == 2);
  CHECK(scene.meshes.size() == 1);
  CHECK(scene.geometries.size() == 1);

  SECTION("and compare sees when one is not where it was") {
    const Scene before = scene_of({box({0, 0, 0}, {1, 1, 1}), box({0, 0, 0}, {2, 1, 1})});
    Scene wrong = before;
    optimize(wrong);
    CHECK(timeline::compare(before, wrong).equal());
    CHECK(timeline::compare(wrong, before).equal());
    wrong.objects.frame_from_object[1].scale.x *= 1.001F;
    CHECK_FALSE(timeline::compare(before, wrong).equal());
    CHECK_FALSE(timeline::compare(wrong, before).equal());
  }
}

TEST_CASE("what would look different stretched is left alone") {
  // Texture coordinates that follow the size; leaning normals along one axis; another material; objects with
  // looks.
  Scene textured = scene_of({box({0, 0, 0}, {1, 1, 1}, true), box({0, 0, 0}, {2, 1, 1}, true)});
  CHECK(optimized(textured).stretched_meshes == 0);
  Scene leaning = scene_of({octahedron({1, 1, 1}), octahedron({1, 2, 1}), octahedron({3, 3, 3})});
  CHECK(optimized(leaning).stretched_meshes == 1);  // the one that is larger all round
  Scene flat = scene_of({box({0, 0, 0}, {1, 1, 1}), box({0, 0, 0}, {1, 1, 0})});
  CHECK(optimized(flat).stretched_meshes == 0);
  Scene painted = scene_of({box({0, 0, 0}, {1, 1, 1}), box({0, 0, 0}, {2, 1, 1})});
  painted.materials.resize(2);
  painted.materials[1].base_color = {1, 0, 0, 1};
  painted.meshes[1].primitives[0].material = MaterialId(1);
  CHECK(optimized(painted).stretched_meshes == 0);
  Scene looks = scene_of({box({0, 0, 0}, {1, 1, 1}), box({0, 0, 0}, {2, 1, 1}), box({0, 0, 0}, {3, 1, 1})});
  looks.object_mesh_tracks = {
      {ObjectId(0), looks.add_track(Property::mesh, Interpolation::step, std::vector{0.0F, 2.0F},
                                    std::vector{0.0F, 1.0F})}};
  CHECK(optimized(looks).stretched_objects == 1);  // object 2 shows mesh 1, which looks still use
}

TEST_CASE("timelines that say the same become one, keys that say nothing go") {
  Scene scene = scene_of({box({0, 0, 0}, {1, 1, 1})});
  const auto add = [&](const std::vector<float>& times, const std::vector<float>& values) {
    const std::string name = "object " + std::to_string(scene.objects.size());
    const ObjectId id = scene.objects.add(name, MeshId(0), {});
    scene.objects.visibility[id.value] =
        scene.add_track(Property::visibility, Interpolation::step, times, values);
  };
  add({0, 1, 4}, {0, 1, 1});
  add({0.5F, 1}, {0, 1});  // hidden before its first key, too
  add({0, 0.5F, 1}, {0, 0, 1});
  add({2}, {1});  // always there
  add({0, 3}, {1, 1});
  add({1, 2}, {0, 0});  // never
  add({0}, {0});
  const OptimizeReport report = optimized(scene);
  CHECK(scene.tracks.size() == 2);
  CHECK(report.equal_tracks == 3);
  CHECK(report.constant_tracks == 2);
  CHECK(report.idle_keys == 4);
  CHECK(scene.track_times_s == std::vector{0.0F, 1.0F, 0.0F});
  CHECK_FALSE(scene.objects.visibility[4].valid());
  CHECK_FALSE(scene.objects.visibility[5].valid());
  CHECK(scene.objects.visibility[6] == scene.objects.visibility[7]);
}

TEST_CASE("objects leave frames that do not move, moving ones stay") {
  Scene scene = scene_of({box({0, 0, 0}, {1, 1, 1}), box({0, 0, 0}, {1, 1, 1}), box({0, 0, 0}, {1, 1, 1}),
                          box({0, 0, 0}, {1, 1, 1})});
  scene.frames.resize(4);
  scene.frames[0].local = {{5, 0, 0}, glm::quat(0.6F, 0.8F, 0, 0), {2, 2, 2}};
  scene.frames[1].parent = FrameId(0);  // moves
  scene.frames[2].parent = FrameId(1);
  scene.frames[2].local.translation_m = {0, 7, 0};
  scene.frames[3].parent = FrameId(0);  // "moves" with one key
  for (std::uint32_t i = 0; i < 4; ++i) scene.objects.frame[i] = FrameId(i);
  scene.frame_tracks = {
      {FrameId(1), scene.add_track(Property::translation, Interpolation::linear, std::vector{1.0F, 2.0F},
                                   std::vector<float>{0, 0, 0, 1, 2, 3})},
      {FrameId(3), scene.add_track(Property::translation, Interpolation::linear, std::vector{1.0F, 2.0F},
                                   std::vector<float>{9, 0, 0, 9, 0, 0})}};
  scene.cameras.resize(1);
  scene.cameras[0].frame = FrameId(0);
  const OptimizeReport report = optimized(scene);
  CHECK(report.unframed_objects == 3);
  CHECK(report.constant_tracks == 1);
  CHECK(scene.frames.size() == 2);
  CHECK(scene.objects.frame == std::vector{FrameId(), FrameId(1), FrameId(1), FrameId()});

  Scene sheared = scene_of({box({0, 0, 0}, {1, 1, 1})});
  sheared.frames.resize(1);
  sheared.frames[0].has_matrix = true;
  sheared.frames[0].matrix[1][0] = 0.5F;
  sheared.objects.frame[0] = FrameId(0);
  CHECK(optimized(sheared).unframed_objects == 0);
  CHECK(sheared.frames.size() == 1);
}

TEST_CASE("looks that become equal are no looks any more") {
  Scene scene = scene_of({box({0, 0, 0}, {1, 1, 1}), box({0, 0, 0}, {1, 1, 1})});
  scene.object_mesh_tracks = {
      {ObjectId(0), scene.add_track(Property::mesh, Interpolation::step, std::vector{0.0F, 2.0F},
                                    std::vector{0.0F, 1.0F})}};
  optimized(scene);
  CHECK(scene.object_mesh_tracks.empty());
  CHECK(scene.tracks.empty());
  CHECK(scene.objects.mesh[0] == scene.objects.mesh[1]);
}
