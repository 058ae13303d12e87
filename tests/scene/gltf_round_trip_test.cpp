// What the writer writes in any layout, with any encoding of visibility, in either container, the reader
// gives back.
#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>

#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "scene/validate.h"
#include "tests/support/gltf_file.h"
#include "tests/support/synthetic_scene.h"
#include "tests/timeline/random_scene.h"
#include "timeline/compare.h"

namespace {

using namespace scenegen;

struct TemporaryFolder {
  std::filesystem::path path;
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "scenegen_round_trip_XXXXXX").string();
    REQUIRE(mkdtemp(name.data()) != nullptr);
    path = name;
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path); }
};

struct Combination {
  gltf::Layout layout;
  gltf::VisibilityEncoding visibility;
  const char* extension;
};

std::vector<Combination> combinations() {
  std::vector<Combination> out;
  for (const auto layout :
       {gltf::Layout::nodes, gltf::Layout::groups, gltf::Layout::instances, gltf::Layout::merged}) {
    for (const auto visibility : {gltf::VisibilityEncoding::scale, gltf::VisibilityEncoding::pointer,
                                  gltf::VisibilityEncoding::both}) {
      for (const char* const extension : {".glb", ".gltf"}) out.push_back({layout, visibility, extension});
    }
  }
  return out;
}

gltf::ReadResult round_trip(const Scene& scene, const Combination& c, const std::string& folder) {
  const std::string path = folder + "/scene" + c.extension;
  const auto written = gltf::write(scene, path, {c.layout, c.visibility, 1});
  if (!written) FAIL(written.error().str());
  auto read = gltf::read(path);
  if (!read) FAIL(read.error().str());
  return std::move(*read);
}

bool equal_keys(const Scene& a, TrackId ta, const Scene& b, TrackId tb) {
  return std::ranges::equal(a.times_s(ta), b.times_s(tb)) && std::ranges::equal(a.values(ta), b.values(tb)) &&
         a.tracks[ta.value].interpolation == b.tracks[tb.value].interpolation;
}

void check_objects(const Scene& a, const Scene& b) {
  REQUIRE(b.objects.size() == a.objects.size());
  CHECK(b.objects.names == a.objects.names);
  CHECK(b.objects.mesh == a.objects.mesh);
  const auto frames_a = rest_frame_matrices(a);
  const auto frames_b = rest_frame_matrices(b);
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    INFO(a.objects.names[i]);
    if (!a.objects.frame[i].valid()) {
      CHECK(!b.objects.frame[i].valid());
      CHECK(b.objects.frame_from_object[i] == a.objects.frame_from_object[i]);  // bit for bit
    } else {
      const glm::mat4 ma = rest_world_from_object(a, frames_a, ObjectId(i));
      const glm::mat4 mb = rest_world_from_object(b, frames_b, ObjectId(i));
      for (int c = 0; c < 4; ++c) CHECK(glm::length(ma[c] - mb[c]) < 1e-5F);
    }
    const TrackId ta = a.objects.visibility[i];
    const TrackId tb = b.objects.visibility[i];
    REQUIRE(ta.valid() == tb.valid());
    if (ta.valid()) CHECK(equal_keys(a, ta, b, tb));
  }
}

void check_assets(const Scene& a, const Scene& b) {
  REQUIRE(b.meshes.size() == a.meshes.size());
  for (std::size_t m = 0; m < a.meshes.size(); ++m) {
    CHECK(b.meshes[m].name == a.meshes[m].name);
    REQUIRE(b.meshes[m].primitives.size() == a.meshes[m].primitives.size());
    for (std::size_t p = 0; p < a.meshes[m].primitives.size(); ++p) {
      const Primitive& pa = a.meshes[m].primitives[p];
      const Primitive& pb = b.meshes[m].primitives[p];
      CHECK(b.geometries[pb.geometry.value] == a.geometries[pa.geometry.value]);
      CHECK(pb.material == pa.material);
    }
  }
  CHECK(b.geometries.size() == a.geometries.size());  // shared accessors are shared geometry
  REQUIRE(b.materials.size() == a.materials.size());
  for (std::size_t m = 0; m < a.materials.size(); ++m) {
    const Material& x = a.materials[m];
    const Material& y = b.materials[m];
    INFO("material " << m << " " << x.name);
    CHECK(y.name == x.name);
    CHECK(y.base_color == x.base_color);
    CHECK(y.metallic == x.metallic);
    CHECK(y.roughness == x.roughness);
    CHECK(y.emissive == x.emissive);
    CHECK(y.alpha_mode == x.alpha_mode);
    if (x.alpha_mode == AlphaMode::mask) CHECK(y.alpha_cutoff == x.alpha_cutoff);
    CHECK(y.double_sided == x.double_sided);
    CHECK(y.unlit == x.unlit);
    CHECK(y.base_color_texture == x.base_color_texture);
    CHECK(y.metallic_roughness_texture == x.metallic_roughness_texture);
    CHECK(y.normal_texture == x.normal_texture);
    CHECK(y.occlusion_texture == x.occlusion_texture);
    CHECK(y.emissive_texture == x.emissive_texture);
  }
  REQUIRE(b.images.size() == a.images.size());
  for (std::size_t i = 0; i < a.images.size(); ++i) CHECK(b.images[i].bytes == a.images[i].bytes);
  REQUIRE(b.textures.size() == a.textures.size());
  for (std::size_t i = 0; i < a.textures.size(); ++i) {
    CHECK(b.textures[i].image == a.textures[i].image);
    CHECK(b.textures[i].sampler == a.textures[i].sampler);
  }
  CHECK(b.cameras.size() == a.cameras.size());
}

void check_tracks(const Scene& a, const Scene& b) {
  CHECK(b.duration_s == a.duration_s);
  CHECK(b.frame_tracks.size() == a.frame_tracks.size());
  REQUIRE(b.object_mesh_tracks.size() == a.object_mesh_tracks.size());
  std::map<std::uint32_t, TrackId> looks;
  for (const ObjectMeshTrack& t : b.object_mesh_tracks) looks[t.object.value] = t.track;
  for (const ObjectMeshTrack& t : a.object_mesh_tracks) {
    INFO(a.objects.names[t.object.value]);
    REQUIRE(looks.count(t.object.value) == 1);
    const TrackId other = looks[t.object.value];
    CHECK(b.values(other).back() == a.values(t.track).back());
    CHECK(b.values(other).front() == a.values(t.track).front());
  }
  CHECK(b.material_tracks.size() == a.material_tracks.size());
}

void check_same_to_see(const Scene& a, const Scene& b) {
  const timeline::Comparison comparison = timeline::compare(a, b);
  for (const timeline::Difference& d : comparison.differences) UNSCOPED_INFO(d.where << ": " << d.what);
  CHECK(comparison.equal());
}

}  // namespace

TEST_CASE("a scene with everything comes back from all combinations") {
  const Scene scene = testing::everything_scene();
  REQUIRE(validate(scene).empty());
  const TemporaryFolder folder;
  for (const Combination& c : combinations()) {
    INFO("layout " << int(c.layout) << " visibility " << int(c.visibility) << " " << c.extension);
    const gltf::ReadResult result = round_trip(scene, c, folder.path.string());
    for (const Finding& f : validate(result.scene))
      FAIL_CHECK("rule " << f.rule << ": " << f.where << ": " << f.what);
    for (const gltf::Ignored& i : result.ignored) FAIL_CHECK("ignored " << i.where << ": " << i.what);
    check_objects(scene, result.scene);
    check_assets(scene, result.scene);
    check_tracks(scene, result.scene);
    check_same_to_see(scene, result.scene);
  }
}

TEST_CASE("a town comes back from all combinations, its tracks still shared") {
  constexpr std::uint32_t kMoments = 40;
  const Scene scene = testing::town_scene(3000, kMoments);
  const TemporaryFolder folder;
  for (const Combination& c : combinations()) {
    INFO("layout " << int(c.layout) << " visibility " << int(c.visibility) << " " << c.extension);
    const gltf::ReadResult result = round_trip(scene, c, folder.path.string());
    CHECK(validate(result.scene).empty());
    check_objects(scene, result.scene);
    check_assets(scene, result.scene);
    CHECK(result.scene.tracks.size() == kMoments);
    CHECK(result.scene.frames.empty());
    CHECK(result.scene.duration_s == scene.duration_s);
  }
}

TEST_CASE("random scenes come back the same to see") {
  const TemporaryFolder folder;
  const std::vector<Combination> all = combinations();
  for (std::uint64_t seed = 0; seed < 72; ++seed) {
    const Scene scene = timeline::test::RandomScene(seed).make(60, 8);
    const Combination& c = all[seed % all.size()];
    INFO("seed " << seed << " layout " << int(c.layout) << " visibility " << int(c.visibility) << " "
                 << c.extension);
    const gltf::ReadResult result = round_trip(scene, c, folder.path.string());
    CHECK(validate(result.scene).empty());
    CHECK(result.scene.objects.names == scene.objects.names);
    check_same_to_see(scene, result.scene);
  }
}

/// Bit for bit: placement, and the keys of objects whose tracks the file names (docs/FORMAT.md 5).
void check_kinds(const Scene& a, const Scene& b) {
  REQUIRE(b.objects.names == a.objects.names);
  CHECK(b.objects.mesh == a.objects.mesh);
  CHECK(b.objects.frame_from_object == a.objects.frame_from_object);
  const auto frame_name = [](const Scene& s, FrameId f) { return f.valid() ? s.frames[f.value].name : ""; };
  for (std::size_t i = 0; i < a.objects.size(); ++i)
    CHECK(frame_name(b, b.objects.frame[i]) == frame_name(a, a.objects.frame[i]));
  REQUIRE(b.object_mesh_tracks.size() == a.object_mesh_tracks.size());
  for (std::size_t i = 0; i < a.object_mesh_tracks.size(); ++i) {
    const ObjectMeshTrack &x = a.object_mesh_tracks[i], &y = b.object_mesh_tracks[i];
    REQUIRE(y.object == x.object);
    CHECK(equal_keys(a, x.track, b, y.track));
    const TrackId shown = a.objects.visibility[x.object.value], read = b.objects.visibility[x.object.value];
    const bool always = !shown.valid() || std::ranges::count(a.values(shown), 0.0F) == 0;
    REQUIRE(read.valid() == !always);
    if (!always) CHECK(equal_keys(a, shown, b, read));
  }
}

TEST_CASE("objects that share frame, visibility and looks share nodes, and come back exactly") {
  const TemporaryFolder folder;
  for (const Combination& c : combinations()) {
    if (c.layout == gltf::Layout::nodes) continue;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      const Scene scene = timeline::test::RandomScene(seed).make_kinds(90, 12);
      INFO("seed " << seed << " layout " << int(c.layout) << " visibility " << int(c.visibility));
      REQUIRE(validate(scene).empty());
      const auto report = gltf::predict(scene, "a.glb", {c.layout, c.visibility, 1});
      REQUIRE(report);
      CHECK(report->layout == c.layout);
      if (c.layout != gltf::Layout::groups) {
        CHECK(report->instanced_objects == scene.objects.size());
        CHECK(report->single_object_groups == 0);
        CHECK(report->nodes < scene.objects.size());
      }
      CHECK(report->channels < scene.objects.size());
      const gltf::ReadResult result = round_trip(scene, c, folder.path.string());
      CHECK(validate(result.scene).empty());
      for (const gltf::Ignored& i : result.ignored) FAIL_CHECK("ignored " << i.where << ": " << i.what);
      check_kinds(scene, result.scene);
      check_same_to_see(scene, result.scene);
    }
  }
}

TEST_CASE("the animation rules where it and the timelines of looks disagree") {
  const TemporaryFolder folder;
  const Scene scene = timeline::test::RandomScene(1).make_kinds(90, 5);
  for (const auto layout : {gltf::Layout::groups, gltf::Layout::instances, gltf::Layout::merged}) {
    const std::string path = (folder.path / "kinds.gltf").string();
    REQUIRE(gltf::write(scene, path, {layout, gltf::VisibilityEncoding::scale, 1}));
    std::string text = testing::file_bytes(path);
    const std::size_t at = text.find("\"timelines\":");
    REQUIRE(at != std::string::npos);
    text.replace(at, 12, "\"forgotten\": ");
    const auto read = gltf::read_memory({text.begin(), text.end()}, "a.gltf", folder.path.string());
    if (!read) FAIL(read.error().str());
    CHECK(validate(read->scene).empty());
    REQUIRE(read->ignored.size() == 1);
    CHECK(read->ignored[0].what.find("timelines of looks") != std::string::npos);
    check_same_to_see(scene, read->scene);
  }
}

TEST_CASE("what the file says about itself comes back") {
  const Scene scene = testing::everything_scene();
  const TemporaryFolder folder;
  const Scene read = round_trip(scene, combinations()[0], folder.path.string()).scene;
  CHECK(read.info.seed == scene.info.seed);
  CHECK(read.info.arguments == scene.info.arguments);
  REQUIRE(read.info.appearance);
  const AppearanceInfo& a = *scene.info.appearance;
  const AppearanceInfo& b = *read.info.appearance;
  CHECK(b.curve == a.curve);
  CHECK(b.curve_variant == a.curve_variant);
  CHECK(b.order == a.order);
  CHECK(b.cells == a.cells);
  CHECK(b.grid_z_up_m == a.grid_z_up_m);
  CHECK(b.interval_s == a.interval_s);
  CHECK(b.hold_s == a.hold_s);
  CHECK(b.coherence_given == a.coherence_given);
  CHECK(b.coherence_measured == a.coherence_measured);
  CHECK(b.displaced_objects == a.displaced_objects);
  CHECK(b.timed_objects == a.timed_objects);
  CHECK(b.moments == a.moments);
  CHECK(b.locality_cells == a.locality_cells);
}

TEST_CASE("the source document is kept, byte for byte, when asked for") {
  const Scene scene = testing::town_scene(3000, 40);
  const TemporaryFolder folder;
  const std::string path = folder.path.string() + "/town.glb";
  REQUIRE(gltf::write(scene, path, {gltf::Layout::instances, gltf::VisibilityEncoding::scale, 1}));
  const auto read = gltf::read(path, {true, 1});
  REQUIRE(read);
  REQUIRE(read->source);
  CHECK(read->source->json.size() == read->json_bytes);
  CHECK(read->source->json.front() == '{');
  REQUIRE(read->source->buffers.size() == 1);
  CHECK(read->source->node_of_object.size() == 3000);
  CHECK(read->source->instance_of_object.size() == 3000);
  CHECK(read->file_bytes == std::filesystem::file_size(path));
  CHECK(gltf::read(path)->source == nullptr);
}

TEST_CASE("a name table that another tool has left pointing elsewhere costs the names, not the scene") {
  const TemporaryFolder folder;
  const Scene scene = testing::town_scene(400, 5);
  const std::string path = (folder.path / "town.gltf").string();
  REQUIRE(gltf::write(scene, path, {gltf::Layout::instances, gltf::VisibilityEncoding::scale, 1}));
  std::string text = testing::file_bytes(path);
  const std::string member = "\"names\":{\"bufferView\":";
  const std::size_t at = text.find(member);
  REQUIRE(at != std::string::npos);
  text.replace(at, text.find(',', at) - at, member + "0");  // as gltf-transform 4.5 does on copying
  const auto read = gltf::read_memory({text.begin(), text.end()}, "town.gltf", folder.path.string());
  REQUIRE(read);
  CHECK(read->scene.objects.size() == scene.objects.size());
  CHECK(read->scene.objects.visibility == scene.objects.visibility);
  CHECK(validate(read->scene).empty());
  REQUIRE(read->ignored.size() == 1);
  CHECK(read->ignored[0].where == "/scenes/0/extras/scenegen/names");
}
