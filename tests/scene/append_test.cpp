// Joining scenes: ids remapped, places kept, frames flattened.
#include "scene/append.h"

#include <catch2/catch.hpp>

#include "scene/validate.h"

using namespace scenegen;

namespace {

/// A textured triangle shown twice: once free, once below two frames, the outer one scaled unevenly.
Scene small_scene(float size, const char* name) {
  Scene s;
  Geometry g;
  g.positions_m = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
  g.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  g.texcoords[0] = {{0, 0}, {1, 0}, {0, 1}};
  s.geometries.push_back(g);
  s.images.push_back({name, "image/png", {static_cast<std::uint8_t>(size)}});
  s.textures.push_back({ImageId(0), {}});
  Material m;
  m.name = name;
  m.base_color_texture.texture = TextureId(0);
  m.emissive_texture.texture = TextureId(0);
  s.materials.push_back(m);
  s.meshes.push_back({name, {{GeometryId(0), MaterialId(0)}, {GeometryId(0), {}}}});

  Frame outer, inner;
  outer.name = "outer";
  outer.local.scale = {1, 2, 1};
  inner.name = "inner";
  inner.parent = FrameId(0);
  inner.local.translation_m = {0, 1, 0};
  s.frames = {outer, inner};
  s.objects.add("free", MeshId(0), {{1, 2, 3}, {1, 0, 0, 0}, {2, 2, 2}});
  s.objects.add("below", MeshId(0), {{5, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}}, FrameId(1));
  s.objects.add("sheared", MeshId(0), {{0, 0, 0}, glm::angleAxis(0.7F, glm::vec3(0, 0, 1)), {1, 1, 1}},
                FrameId(1));
  return s;
}

void check_same_place(const Scene& a, std::size_t i, const Scene& b, std::size_t j,
                      const glm::mat4& b_moved) {
  const glm::mat4 ma = rest_world_from_object(a, rest_frame_matrices(a), ObjectId(i));
  const glm::mat4 mb = b_moved * rest_world_from_object(b, rest_frame_matrices(b), ObjectId(j));
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) CHECK(ma[c][r] == Approx(mb[c][r]).margin(1e-5));
  }
}

}  // namespace

TEST_CASE("appending keeps places and remaps every id") {
  Scene into = small_scene(1, "first");
  const Scene from = small_scene(7, "second");
  const Appended resources = append_resources(into, from);
  CHECK(resources.first_mesh == 1);
  Transform place;
  place.translation_m = {10, 20, 30};
  append_objects(into, from, resources, place, "a/");
  place.translation_m = {-5, 0, 0};
  append_objects(into, from, resources, place, "b/");

  REQUIRE(into.objects.size() == 9);
  CHECK(into.geometries.size() == 2);
  CHECK(into.materials[1].base_color_texture.texture == TextureId(1));
  CHECK(into.materials[1].emissive_texture.texture == TextureId(1));
  CHECK_FALSE(into.materials[1].normal_texture.texture.valid());
  CHECK(into.textures[1].image == ImageId(1));
  CHECK(into.images[1].name == "second");
  CHECK(into.meshes[1].primitives[0].geometry == GeometryId(1));
  CHECK(into.meshes[1].primitives[0].material == MaterialId(1));
  CHECK_FALSE(into.meshes[1].primitives[1].material.valid());
  CHECK(into.objects.names[3] == "a/free");
  CHECK(into.objects.names[8] == "b/sheared");
  const glm::mat4 a = Transform{{10, 20, 30}, {1, 0, 0, 0}, {1, 1, 1}}.matrix();
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(into.objects.mesh[3 + i] == MeshId(1));
    check_same_place(into, 3 + i, from, i, a);
    check_same_place(into, 6 + i, from, i, place.matrix());
  }
  // Only shear needs a frame.
  CHECK_FALSE(into.objects.frame[4].valid());
  CHECK(into.objects.frame[5].valid());
  CHECK(into.frames.size() == 4);
  CHECK(validate(into).empty());
}
