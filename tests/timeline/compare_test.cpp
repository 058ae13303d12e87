#include "timeline/compare.h"

#include <catch2/catch.hpp>
#include <functional>
#include <string>

#include "random_scene.h"

namespace scenegen::timeline {
namespace {

Geometry triangle(float size) {
  Geometry g;
  g.positions_m = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
  g.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  g.texcoords[0] = {{0, 0}, {1, 0}, {0, 1}};
  g.indices = {0, 1, 2};
  return g;
}

/// Four by four squares that lie in waves.
Geometry sheet() {
  Geometry g;
  for (std::uint32_t y = 0; y <= 4; ++y) {
    for (std::uint32_t x = 0; x <= 4; ++x) {
      g.positions_m.emplace_back(x, y, 0.25F * static_cast<float>(x * y % 3));
      g.normals.emplace_back(0, 0, 1);
      g.texcoords[0].emplace_back(x, y);
      g.colors.emplace_back(0.1F * static_cast<float>(x), 0.5F, 0.5F, 1.0F);
      if (x == 4 || y == 4) continue;
      const std::uint32_t a = y * 5 + x;
      for (const std::uint32_t i : {a, a + 1, a + 5, a + 5, a + 1, a + 6}) g.indices.push_back(i);
    }
  }
  return g;
}

/// The same triangles in another order, of other vertices, unindexed, turned.
Geometry shuffled(const Geometry& g) {
  Geometry out;
  const std::size_t triangles = g.indices.size() / 3;
  for (std::size_t k = 0; k < triangles; ++k) {
    const std::size_t t = (k * 7 + 3) % triangles;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t i = g.indices[3 * t + (corner + k) % 3];
      out.positions_m.push_back(g.positions_m[i]);
      out.normals.push_back(g.normals[i]);
      out.texcoords[0].push_back(g.texcoords[0][i]);
      out.colors.push_back(g.colors[i]);
    }
  }
  return out;
}

/// Six objects; one of each kind of thing that can be compared.
Scene sample() {
  Scene s;
  s.duration_s = 10.0F;
  s.geometries = {triangle(1.0F), triangle(2.0F)};
  s.images = {{"texel", "image/png", {1, 2, 3, 4}}};
  s.textures = {{ImageId(0), {}}};
  s.materials.resize(3);
  s.materials[0].name = "brick";
  s.materials[0].base_color_texture.texture = TextureId(0);
  s.materials[1].name = "glass";
  s.materials[1].alpha_mode = AlphaMode::blend;
  s.materials[2].name = "lamp";
  s.meshes = {{"brick", {{GeometryId(0), MaterialId(0)}}},
              {"pane", {{GeometryId(1), MaterialId(1)}}},
              {"lamp", {{GeometryId(1), MaterialId(2)}}}};
  s.frames.resize(2);
  s.frames[0].name = "crane";
  s.frames[1].name = "hook";
  s.frames[1].parent = FrameId(0);
  const TrackId appears = s.add_track(Property::visibility, Interpolation::step,
                                      std::vector{0.0F, 1.0F, 10.0F}, std::vector{0.0F, 1.0F, 1.0F});
  const TrackId goes = s.add_track(Property::visibility, Interpolation::step, std::vector{0.0F, 2.0F, 5.0F},
                                   std::vector{0.0F, 1.0F, 0.0F});
  for (std::uint32_t i = 0; i < 6; ++i) {
    Transform at;
    at.translation_m = {static_cast<float>(i) * 3.0F, 0.0F, 0.0F};
    s.objects.add("object_" + std::to_string(i), MeshId(i % 3), at, i < 4 ? FrameId() : FrameId(1));
  }
  s.objects.visibility[0] = appears;
  s.objects.visibility[1] = appears;
  s.objects.visibility[2] = goes;
  s.frame_tracks = {
      {FrameId(0), s.add_track(Property::translation, Interpolation::linear, std::vector{3.0F, 4.0F},
                               std::vector<float>{0, 0, 0, 5, 0, 0})},
      {FrameId(1), s.add_track(Property::rotation, Interpolation::linear, std::vector{6.0F, 7.0F},
                               std::vector<float>{0, 0, 0, 1, 0, 1, 0, 0})}};
  s.object_mesh_tracks = {{ObjectId(3), s.add_track(Property::mesh, Interpolation::step,
                                                    std::vector{0.0F, 8.0F}, std::vector{0.0F, 1.0F})}};
  s.material_tracks = {
      {MaterialId(2), s.add_track(Property::emissive, Interpolation::linear, std::vector{0.0F, 9.0F},
                                  std::vector<float>{0, 0, 0, 9, 9, 9})}};
  s.cameras.resize(2);
  s.cameras[0].name = "overview";
  s.cameras[1].name = "on the hook";
  s.cameras[1].frame = FrameId(1);
  return s;
}

float& value(Scene& s, TrackId id, std::size_t i) {
  return s.track_values[s.tracks[id.value].first_value + i];
}
float& time(Scene& s, TrackId id, std::size_t i) {
  return s.track_times_s[s.tracks[id.value].first_time + i];
}

void rename(Scene& s, std::size_t i, const std::string& name) {
  NameTable names;
  for (std::size_t o = 0; o < s.objects.size(); ++o) names.push_back(o == i ? name : s.objects.names[o]);
  s.objects.names = names;
}

void swap_objects(Scene& s, std::size_t i, std::size_t j) {
  const std::string name_i(s.objects.names[i]);
  const std::string name_j(s.objects.names[j]);
  rename(s, i, name_j);
  rename(s, j, name_i);
  std::swap(s.objects.mesh[i], s.objects.mesh[j]);
  std::swap(s.objects.frame[i], s.objects.frame[j]);
  std::swap(s.objects.frame_from_object[i], s.objects.frame_from_object[j]);
  std::swap(s.objects.visibility[i], s.objects.visibility[j]);
}

struct Mutation {
  const char* name;
  std::function<void(Scene&)> apply;
  std::vector<std::pair<std::string, std::string>> expected;  ///< where, what: exactly these
};

// One change each, and exactly the differences it makes.
const std::vector<Mutation> kMutations{
    {"a name", [](Scene& s) { rename(s, 2, "thing"); }, {{"object_2", "only in A"}, {"thing", "only in B"}}},
    {"two indices",
     [](Scene& s) { swap_objects(s, 1, 2); },
     {{"objects", "1 in another order: object_2 is number 2 in A, 1 in B"}}},
    {"a transform",
     [](Scene& s) { s.objects.frame_from_object[3].translation_m.y += 0.01F; },
     {{"object_3 at 0 s", "at (9, 0, 0) in A, (9, 0.01, 0) in B"}}},
    {"a scale",
     [](Scene& s) { s.objects.frame_from_object[0].scale.z = 1.5F; },
     {{"object_0 at 0 s", "z axis (0, 0, 1) in A, (0, 0, 1.5) in B"}}},
    {"a frame at rest",
     [](Scene& s) {
       s.frames[1].local.scale = glm::vec3(2.0F);
       s.objects.frame[5] = FrameId();
       s.objects.frame_from_object[5].scale = glm::vec3(2.0F);
     },
     {{"object_4 at 0 s", "at (12, 0, 0) in A, (24, 0, 0) in B"},
      {"object_5 at 0 s", "x axis (1, 0, 0) in A, (2, 0, 0) in B"}}},
    {"one visibility track's key time",
     [](Scene& s) { time(s, s.objects.visibility[2], 1) = 2.25F; },
     {{"object_2 at 2 s", "visible in A, hidden in B"}}},
    {"a key time of a shared track",
     [](Scene& s) { time(s, s.objects.visibility[0], 1) = 0.75F; },
     {{"object_0 at 0.75 s", "hidden in A, visible in B"},
      {"object_1 at 0.75 s", "hidden in A, visible in B"}}},
    {"a key time by one unit in the last place",
     [](Scene& s) { time(s, s.objects.visibility[2], 2) = std::nextafter(5.0F, 6.0F); },
     {{"object_2 at 5 s", "hidden in A, visible in B"}}},
    {"no visibility track",
     [](Scene& s) { s.objects.visibility[0] = TrackId(); },
     {{"object_0 at 0 s", "hidden in A, visible in B"}}},
    {"a mesh track's key time",
     [](Scene& s) { time(s, s.object_mesh_tracks[0].track, 1) = 8.5F; },
     {{"object_3 at 8 s",
       "shows mesh 'pane' in A, 'brick' in B: geometry 1: positions[1] (2, 0, 0) in A, (1, 0, 0) in B"}}},
    {"a vertex",
     [](Scene& s) { s.geometries[0].positions_m[1].x = std::nextafter(1.0F, 2.0F); },
     {{"geometry 0 of object_0 and 1 more", "positions[1] (1, 0, 0) in A, (1.0000001, 0, 0) in B"}}},
    {"an index",
     [](Scene& s) { s.geometries[1].indices[0] = 1; },
     {{"geometry 1 of object_1 and 3 more", "indices[0] 0 in A, 1 in B"}}},
    {"no normals",
     [](Scene& s) { s.geometries[0].normals.clear(); },
     {{"geometry 0 of object_0 and 1 more", "3 normals in A, 0 in B"}}},
    {"the topology",
     [](Scene& s) { s.geometries[0].topology = Topology::points; },
     {{"geometry 0 of object_0 and 1 more", "another topology"}}},
    {"a primitive",
     [](Scene& s) {
       s.meshes[2].primitives.push_back({GeometryId(0), MaterialId(0)});
     },
     {{"mesh 'lamp' of object_2 and 1 more", "1 primitives in A, 2 in B"}}},
    {"a mesh",
     [](Scene& s) { s.objects.mesh[4] = MeshId(0); },
     {{"geometry 1 of object_4", "positions[1] (2, 0, 0) in A, (1, 0, 0) in B"},
      {"material 'glass' of object_4", "alpha mode BLEND in A, OPAQUE in B"}}},
    {"a texel",
     [](Scene& s) { s.images[0].bytes[2] ^= 1U; },
     {{"material 'brick' of object_0 and 1 more", "base colour texture: image bytes differ"}}},
    {"a sampler",
     [](Scene& s) { s.textures[0].sampler.wrap_s = 33071; },
     {{"material 'brick' of object_0 and 1 more", "base colour texture: another sampler"}}},
    {"a texture's place",
     [](Scene& s) { s.materials[0].base_color_texture.uv_offset.y = 0.5F; },
     {{"material 'brick' of object_0 and 1 more", "base colour texture: offset (0, 0) in A, (0, 0.5) in B"}}},
    {"no texture",
     [](Scene& s) { s.materials[0].base_color_texture.texture = TextureId(); },
     {{"material 'brick' of object_0 and 1 more", "base colour texture: in A only"}}},
    {"a factor",
     [](Scene& s) { s.materials[1].roughness = 0.25F; },
     {{"material 'glass' of object_1 and 1 more", "roughness 1 in A, 0.25 in B"}}},
    {"a side",
     [](Scene& s) { s.materials[1].double_sided = true; },
     {{"material 'glass' of object_1 and 1 more", "double-sided in B only"}}},
    {"a colour",
     [](Scene& s) { s.materials[1].base_color.y = 0.5F; },
     {{"material 'glass' of object_1 at 0 s", "base colour (1, 1, 1, 1) in A, (1, 0.5, 1, 1) in B"}}},
    {"an animated colour",
     [](Scene& s) { value(s, s.material_tracks[0].track, 3) = 4.5F; },
     {{"material 'lamp' of object_2 at 0.381966 s",
       "emissive (0.381966, 0.381966, 0.381966) in A, (0.190983, 0.381966, 0.381966) in B"}}},
    {"a lens",
     [](Scene& s) { s.cameras[0].yfov_rad = 1.0F; },
     {{"camera 'overview'", "yfov 0.8 in A, 1 in B"}}},
    {"a camera's place",
     [](Scene& s) { s.cameras[0].frame_from_camera.translation_m.z = 4.0F; },
     {{"camera 'overview' at 0 s", "at (0, 0, 0) in A, (0, 0, 4) in B"}}},
    {"a camera", [](Scene& s) { s.cameras.pop_back(); }, {{"camera 'on the hook'", "only in A"}}},
    {"the duration", [](Scene& s) { s.duration_s = 11.0F; }, {{"duration", "10 s in A, 11 s in B"}}},
};

std::string listing(const Comparison& c) {
  std::string out;
  for (const Difference& d : c.differences) out += d.where + ": " + d.what + "\n";
  return out;
}

TEST_CASE("a scene equals itself") {
  const Comparison c = compare(sample(), sample());
  INFO(listing(c));
  REQUIRE(c.equal());
  // 0; nine more event times, each with the time just before and one in between; after the last one in
  // between and the end.
  REQUIRE(c.times_compared == 1 + 9 * 3 + 2);
}

TEST_CASE("random scenes equal themselves") {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Scene s = test::RandomScene(seed).make();
    const Comparison c = compare(s, s);
    INFO(listing(c));
    REQUIRE(c.equal());
  }
}

TEST_CASE("each change is reported, and nothing else") {
  for (const Mutation& m : kMutations) {
    const Scene a = sample();
    Scene b = sample();
    m.apply(b);
    const Comparison c = compare(a, b);
    INFO(m.name << "\n" << listing(c));
    REQUIRE(c.difference_count == m.expected.size());
    for (std::size_t i = 0; i < m.expected.size(); ++i) {
      REQUIRE(c.differences[i].where == m.expected[i].first);
      REQUIRE(c.differences[i].what == m.expected[i].second);
    }
    REQUIRE(compare(b, a).difference_count == c.difference_count);
  }
}

TEST_CASE("motion that differs only between keys is found") {
  const Scene a = sample();
  Scene b = sample();
  SECTION("a spline that meets the line at both keys and half-way") {
    b.frame_tracks[0].track =
        b.add_track(Property::translation, Interpolation::cubic_spline, std::vector{3.0F, 4.0F},
                    std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0});
  }
  SECTION("steps") {
    b.tracks[b.frame_tracks[0].track.value].interpolation = Interpolation::step;
  }
  const Comparison c = compare(a, b);
  INFO(listing(c));
  REQUIRE(c.difference_count == 3);  // two objects and a camera
  REQUIRE(c.differences[0].where == "object_4 at 3.381966 s");
  REQUIRE(c.differences[2].where == "camera 'on the hook' at 3.381966 s");
}

TEST_CASE("sharing, order of arrays and the way to say it do not matter") {
  const Scene a = sample();
  Scene b = sample();
  // Geometry and material copied instead of shared; material and mesh order turned round; names of neither.
  b.geometries.push_back(b.geometries[1]);
  b.meshes[2].primitives[0].geometry = GeometryId(2);
  std::swap(b.materials[0], b.materials[1]);
  for (Mesh& mesh : b.meshes) {
    MaterialId& m = mesh.primitives[0].material;
    if (m.value < 2) m = MaterialId(1 - m.value);
  }
  b.materials[2].name = "another name";
  // A track of one's own; a key that repeats the value before.
  b.objects.visibility[1] = b.add_track(Property::visibility, Interpolation::step,
                                        std::vector{0.0F, 0.5F, 1.0F}, std::vector{0.0F, 0.0F, 1.0F});
  // The same place through a frame.
  b.frames.push_back({"place", {}, {}, false, glm::mat4(1.0F)});
  b.frames[2].local.translation_m = b.objects.frame_from_object[3].translation_m;
  b.objects.frame_from_object[3].translation_m = glm::vec3(0.0F);
  b.objects.frame[3] = FrameId(2);
  std::swap(b.cameras[0], b.cameras[1]);
  const Comparison c = compare(a, b);
  INFO(listing(c));
  REQUIRE(c.equal());
}

TEST_CASE("no material is glTF's default material") {
  Scene a = sample();
  Scene b = sample();
  a.meshes[2].primitives[0].material = MaterialId();
  b.materials.emplace_back();
  b.meshes[2].primitives[0].material = MaterialId(3);
  REQUIRE(compare(a, b).equal());
  b.materials[3].base_color.x = 0.5F;
  REQUIRE(compare(a, b).difference_count == 1);
}

TEST_CASE("tolerances") {
  const Scene a = sample();
  Scene b = sample();
  b.objects.frame_from_object[3].translation_m.y += 1e-5F;  // the scene is 17 m wide
  b.materials[1].base_color.x -= 5e-6F;
  REQUIRE(compare(a, b).equal());
  CompareOptions strict;
  strict.transform_tolerance = 1e-8F;
  strict.color_tolerance = 0.0F;
  REQUIRE(compare(a, b, strict).difference_count == 2);
}

TEST_CASE("all differences are counted, some are listed") {
  const Scene a = test::RandomScene(1).make(300, 0);
  Scene b = a;
  for (Transform& t : b.objects.frame_from_object) t.translation_m.x += 1.0F;
  CompareOptions options;
  options.most = 7;
  const Comparison c = compare(a, b, options);
  REQUIRE(c.difference_count == 300);
  REQUIRE(c.differences.size() == 7);
}

TEST_CASE("empty scenes") {
  REQUIRE(compare(Scene{}, Scene{}).equal());
  REQUIRE(compare(sample(), Scene{}).difference_count == 6 + 2 + 1);
}

TEST_CASE("with a tolerance, geometry is its triangles") {
  Scene a = sample();
  a.geometries[0] = sheet();
  Scene b = a;
  b.geometries[0] = shuffled(sheet());
  CHECK_FALSE(compare(a, b).equal());
  CompareOptions options;
  options.geometry_tolerance = 1e-3F;  // of 4 m
  CHECK(compare(a, b, options).equal());
  CHECK(compare(b, a, options).equal());

  const auto differs = [&](const std::function<void(Geometry&)>& change) {
    Scene changed = a;
    changed.geometries[0] = shuffled(sheet());
    change(changed.geometries[0]);
    const bool one_way = compare(a, changed, options).equal(),
               other_way = compare(changed, a, options).equal();
    CHECK(one_way == other_way);
    return !one_way;
  };
  CHECK_FALSE(differs([](Geometry& g) { g.positions_m[7].z += 0.0039F; }));
  CHECK(differs([](Geometry& g) { g.positions_m[7].z += 0.0041F; }));
  CHECK(differs([](Geometry& g) { std::swap(g.positions_m[3], g.positions_m[4]); }));  // seen from behind
  CHECK(differs([](Geometry& g) { g.texcoords[0][9].x += 0.01F; }));
  CHECK(differs([](Geometry& g) { g.normals[9] = {0, 1, 0}; }));
  CHECK(differs([](Geometry& g) { g.colors[9].w = 0.9F; }));
  CHECK(differs([](Geometry& g) { g.normals.clear(); }));
  CHECK(differs([](Geometry& g) { g.topology = Topology::lines; }));
  CHECK(differs([](Geometry& g) {  // a triangle is missing
    g.positions_m.resize(93);
    g.normals.resize(93);
    g.texcoords[0].resize(93);
    g.colors.resize(93);
  }));
  CHECK_FALSE(differs([](Geometry& g) {  // one without area more
    for (int corner = 0; corner < 3; ++corner) {
      g.positions_m.emplace_back(9, 9, 9);
      g.normals.emplace_back(0, 0, 1);
      g.texcoords[0].emplace_back(0, 0);
      g.colors.emplace_back(1.0F);
    }
  }));
  options.normal_tolerance = 0.2F;
  CHECK_FALSE(differs([](Geometry& g) { g.colors[9].w = 0.9F; }));
}

}  // namespace
}  // namespace scenegen::timeline
