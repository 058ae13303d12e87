// Every rule of docs/FORMAT.md 6 notices what it is there for.
#include "scene/validate.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "tests/support/synthetic_scene.h"

namespace {

using namespace scenegen;

void check_rule(int rule, const std::string& where, const std::function<void(Scene&)>& damage) {
  Scene scene = testing::everything_scene();
  damage(scene);
  const std::vector<Finding> findings = validate(scene);
  INFO("rule " << rule << " at " << where);
  bool found = false;
  for (const Finding& f : findings) {
    UNSCOPED_INFO(f.rule << " " << f.where << ": " << f.what);
    found = found || (f.rule == rule && f.where.substr(0, where.size()) == where && !f.what.empty());
  }
  CHECK(found);
}

TrackId track_of(const Scene& scene, Property property) {
  for (std::size_t i = 0; i < scene.tracks.size(); ++i) {
    if (scene.tracks[i].property == property) return TrackId(i);
  }
  return {};
}

}  // namespace

TEST_CASE("good scenes have no findings") {
  CHECK(validate(Scene{}).empty());
  CHECK(validate(testing::everything_scene()).empty());
  CHECK(validate(testing::town_scene(5000, 100)).empty());
}

TEST_CASE("each rule") {
  const float nan = std::nanf("");
  check_rule(1, "objects", [](Scene& s) { s.objects.frame.pop_back(); });
  check_rule(1, "objects", [](Scene& s) { s.objects.names.push_back("one more"); });
  check_rule(2, "objects[5]", [](Scene& s) { s.objects.mesh[5] = MeshId(99); });
  check_rule(2, "objects[5]", [](Scene& s) { s.objects.mesh[5] = MeshId(); });
  check_rule(2, "objects[5]", [](Scene& s) { s.objects.frame[5] = FrameId(99); });
  check_rule(2, "objects[5]", [](Scene& s) { s.objects.visibility[5] = TrackId(999); });
  check_rule(2, "meshes[1]", [](Scene& s) { s.meshes[1].primitives[0].geometry = GeometryId(); });
  check_rule(2, "meshes[1]", [](Scene& s) { s.meshes[1].primitives[0].material = MaterialId(99); });
  check_rule(2, "textures[0]", [](Scene& s) { s.textures[0].image = ImageId(5); });
  check_rule(2, "materials[0]", [](Scene& s) { s.materials[0].normal_texture.texture = TextureId(9); });
  check_rule(2, "cameras[0]", [](Scene& s) { s.cameras[0].frame = FrameId(77); });
  check_rule(2, "tracks",
             [](Scene& s) { s.track_values[s.tracks[track_of(s, Property::mesh).value].first_value] = 99; });
  check_rule(3, "objects", [](Scene& s) { s.objects.add("brick_1", MeshId(0), {}); });
  check_rule(3, "objects", [](Scene& s) { s.objects.add("", MeshId(0), {}); });
  check_rule(3, "objects", [](Scene& s) { s.objects.add("\xFF", MeshId(0), {}); });
  check_rule(4, "objects[0]", [&](Scene& s) { s.objects.frame_from_object[0].translation_m.y = nan; });
  check_rule(4, "geometries[0]", [&](Scene& s) { s.geometries[0].positions_m[0].x = INFINITY; });
  check_rule(4, "tracks", [&](Scene& s) { s.track_values[0] = nan; });
  check_rule(4, "materials[1]", [&](Scene& s) { s.materials[1].base_color_texture.uv_rotation_rad = nan; });
  check_rule(5, "objects[0]", [](Scene& s) { s.objects.frame_from_object[0].rotation *= 1.01F; });
  check_rule(5, "tracks", [](Scene& s) {
    s.track_values[s.tracks[track_of(s, Property::rotation).value].first_value] = 1;
  });
  check_rule(6, "geometries[1]", [](Scene& s) { s.geometries[1].normals.pop_back(); });
  check_rule(6, "geometries[1]", [](Scene& s) { s.geometries[1].indices[0] = 4; });
  check_rule(7, "tracks[0]", [](Scene& s) { s.tracks[0].key_count = 0; });
  check_rule(7, "tracks[0]", [](Scene& s) { s.tracks[0].first_time = ~0ULL; });
  check_rule(7, "tracks[0]", [](Scene& s) { s.tracks[0].key_count = ~0U; });
  check_rule(7, "tracks", [](Scene& s) { s.track_times_s[1] = s.track_times_s[0]; });
  check_rule(7, "tracks", [](Scene& s) { s.track_times_s[0] = -1; });
  check_rule(7, "tracks", [](Scene& s) {
    s.track_values[s.tracks[track_of(s, Property::visibility).value].first_value] = 0.5F;
  });
  check_rule(7, "tracks", [](Scene& s) {
    s.tracks[track_of(s, Property::visibility).value].interpolation = Interpolation::linear;
  });
  check_rule(8, "objects[1]", [](Scene& s) { s.objects.visibility[1] = track_of(s, Property::mesh); });
  check_rule(8, "frame_tracks", [](Scene& s) { s.frame_tracks.push_back(s.frame_tracks[0]); });
  check_rule(8, "material_tracks",
             [](Scene& s) { s.material_tracks[0].track = track_of(s, Property::rotation); });
  check_rule(8, "frame_tracks[0]",
             [](Scene& s) { s.frames[s.frame_tracks[0].frame.value].has_matrix = true; });
  check_rule(9, "frames[0]", [](Scene& s) { s.frames[0].parent = FrameId(1); });
  check_rule(9, "frames[0]", [](Scene& s) { s.frames[0].parent = FrameId(0); });
  check_rule(9, "frames", [](Scene& s) {
    for (int i = 0; i < 600; ++i) {
      Frame f;
      f.parent = FrameId(s.frames.size() - 1);
      s.frames.push_back(f);
    }
  });
  check_rule(10, "tracks", [](Scene& s) { s.duration_s = 1; });
  check_rule(10, "duration_s", [&](Scene& s) { s.duration_s = nan; });
  check_rule(11, "materials[0]", [](Scene& s) { s.materials[0].roughness = 1.5F; });
  check_rule(11, "materials[0]", [&](Scene& s) { s.materials[0].base_color.x = nan; });
  check_rule(11, "materials[0]", [](Scene& s) { s.materials[0].emissive.x = -1; });
  check_rule(11, "materials[1]", [](Scene& s) { s.materials[1].base_color_texture.texcoord = 2; });
  check_rule(12, "cameras[0]", [](Scene& s) { s.cameras[0].yfov_rad = 0; });
  check_rule(12, "cameras[0]", [](Scene& s) { s.cameras[0].znear_m = -1; });
  check_rule(13, "info.appearance.cells", [](Scene& s) { s.info.appearance->cells.x = 0; });
  check_rule(13, "info.seed", [](Scene& s) { s.info.seed = ~0ULL; });
}

TEST_CASE("the number of findings is bounded") {
  Scene scene = testing::town_scene(5000, 10);
  for (MeshId& mesh : scene.objects.mesh) mesh = MeshId();
  CHECK(validate(scene, 7).size() == 7);
  CHECK(validate(scene, 0).empty());
}
