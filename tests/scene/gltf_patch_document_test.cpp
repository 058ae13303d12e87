// A document of another program with everything in it: what it held is still there after patch(), and what
// must not be possible is refused.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "scene/gltf/patch.h"
#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "tests/support/gltf_file.h"
#include "tests/support/patch_sources.h"
#include "tests/support/synthetic_scene.h"
#include "timeline/compare.h"

namespace {

using namespace scenegen;
using gltf::VisibilityEncoding;
using nlohmann::json;
using scenegen::testing::GltfFile;
using scenegen::testing::TemporaryFolder;

gltf::ReadResult read_source(const std::string& path) {
  auto read = gltf::read(path, {true, 1});
  if (!read) FAIL(read.error().str());
  return std::move(*read);
}

GltfFile file_of(const std::string& path) {
  if (path.ends_with(".glb")) return GltfFile::from_glb(testing::file_bytes(path));
  return GltfFile::from_gltf(path);
}

TrackId shown_from(Scene& scene, float time_s) {
  const float times[] = {0.0F, time_s}, values[] = {0, 1};
  scene.duration_s = std::max(scene.duration_s, time_s + 1.0F);
  return scene.add_track(Property::visibility, Interpolation::step, times, values);
}

ObjectId object(const Scene& scene, std::string_view name) {
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects.names[i] == name) return ObjectId(i);
  }
  FAIL("no object " << name);
  return {};
}

void check_again(const Scene& authored, const std::string& path) {
  const auto read = gltf::read(path);
  if (!read) FAIL(read.error().str());
  const auto comparison = timeline::compare(authored, read->scene);
  for (const auto& d : comparison.differences) UNSCOPED_INFO(d.where << ": " << d.what);
  CHECK(comparison.equal());
}

/// Everything in `before` is in `after` at the same place, where longer arrays are allowed; what is not, and
/// does not match `allowed`, is listed. Animation i of `before` is i + 1 of `after`.
void differences(const json& before, const json& after, const std::string& at, const std::regex& allowed,
                 std::vector<std::string>& out) {
  if (std::regex_match(at, allowed)) return;
  if (before.is_object() && after.is_object()) {
    for (const auto& [key, value] : before.items()) {
      const std::string here = at + "/" + key;
      if (std::regex_match(here, allowed)) continue;
      if (!after.contains(key)) {
        out.push_back(here + " is gone");
      } else {
        differences(value, after[key], here, allowed, out);
      }
    }
  } else if (before.is_array() && after.is_array() && after.size() >= before.size()) {
    const std::size_t shift = at == "/animations" ? 1 : 0;
    for (std::size_t i = 0; i < before.size(); ++i)
      differences(before[i], after.at(i + shift), at + "/" + std::to_string(i), allowed, out);
  } else if (before != after) {
    out.push_back(at + ": " + before.dump() + " became " + after.dump());
  }
}

void check_survives(const json& before, const json& after, const std::string& allowed) {
  std::vector<std::string> found;
  differences(before, after, "", std::regex(allowed), found);
  for (const std::string& line : found) FAIL_CHECK(line);
}

/// Visibility for all but the skinned object, a fall, a look.
Scene author(const gltf::ReadResult& source, bool skinned) {
  Scene scene = source.scene;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (skinned || scene.objects.names[i] != "Skinned")
      scene.objects.visibility[i] = shown_from(scene, 1.0F + 0.5F * static_cast<float>(i));
  }
  return scene;
}

void add_drop(Scene& scene, ObjectId id) {
  Frame frame;
  frame.name = "fall";
  frame.parent = scene.objects.frame[id.value];
  const FrameId added(scene.frames.size());
  scene.frames.push_back(frame);
  const float times[] = {1.0F, 2.0F}, values[] = {0, 5, 0, 0, 0, 0};
  scene.frame_tracks.push_back(
      {added, scene.add_track(Property::translation, Interpolation::linear, times, values)});
  scene.objects.frame[id.value] = added;
}

/// A look of `id` with `material` everywhere from 1 s to 2 s.
void add_look(Scene& scene, ObjectId id, MaterialId material) {
  Mesh mesh = scene.meshes[scene.objects.mesh[id.value].value];
  for (Primitive& p : mesh.primitives) p.material = material;
  mesh.name = "highlighted";
  const auto own = static_cast<float>(scene.objects.mesh[id.value].value);
  const auto other = static_cast<float>(scene.meshes.size());
  scene.meshes.push_back(mesh);
  const float times[] = {0.0F, 1.0F, 2.0F}, values[] = {own, other, own};
  scene.object_mesh_tracks.push_back(
      {id, scene.add_track(Property::mesh, Interpolation::step, times, values)});
}

// What patch() changes on purpose (docs/FORMAT.md 9).
const std::string kAlways =
    "/asset/generator|/nodes/[0-9]+/children|/nodes/[0-9]+/(mesh|skin|weights|matrix)";
/// The channel of the morphed mesh follows it; two nodes are called Cube.
const std::string kHere = "|/animations/(0/channels/2|1/channels/1)/target/node|/nodes/1[23]/name";
const std::string kBuffers = "|/buffers/[0-9]+/(uri|byteLength)|/images/[0-9]+/uri";

std::string error_of(const gltf::ReadResult& source, const Scene& scene, const std::string& path,
                     VisibilityEncoding visibility = VisibilityEncoding::scale) {
  const auto report = gltf::patch(*source.source, scene, path, {visibility, {}});
  REQUIRE(!report);
  CHECK(!std::filesystem::exists(path));
  return report.error().str();
}

}  // namespace

TEST_CASE("patch: everything in a document survives, in every form") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path("sub"));
  testing::write_everything_document(folder.path("in.gltf"));
  const json before = json::parse(testing::file_bytes(folder.path("in.gltf")));
  const gltf::ReadResult source = read_source(folder.path("in.gltf"));
  for (const auto visibility :
       {VisibilityEncoding::scale, VisibilityEncoding::pointer, VisibilityEncoding::both}) {
    Scene authored = author(source, visibility == VisibilityEncoding::pointer);
    add_drop(authored, object(authored, "Crate"));
    add_drop(authored, object(authored, "Arm"));
    Material highlight;
    highlight.name = "green";
    highlight.base_color = {0, 1, 0, 1};
    authored.materials.push_back(highlight);
    add_look(authored, object(authored, "Morphed"), MaterialId(authored.materials.size() - 1));
    add_look(authored, object(authored, "Crate"), MaterialId(authored.materials.size() - 1));
    for (const char* const name : {"out.gltf", "out.glb", "sub/out.gltf", "sub/out.glb"}) {
      INFO(name << " encoding " << static_cast<int>(visibility));
      const std::string out = folder.path(name);
      const auto report = gltf::patch(*source.source, authored, out, {visibility, {}});
      if (!report) FAIL(report.error().str());
      check_again(authored, out);
      const GltfFile after = file_of(out);
      check_survives(before, after.json, kAlways + kHere + kBuffers);
      // A mesh that is no longer where it was is below that node, with its skin and weights.
      for (std::size_t n = 0; n < before["nodes"].size(); ++n) {
        const json& was = before["nodes"][n];
        if (!was.contains("mesh") || after.json["nodes"][n].contains("mesh")) continue;
        INFO("node " << n);
        bool found = false;
        std::vector<std::size_t> below = after.json["nodes"][n]["children"];
        for (std::size_t k = 0; k < below.size(); ++k) {
          const json& node = after.json["nodes"][below[k]];
          for (const std::size_t child : node.value("children", std::vector<std::size_t>{}))
            below.push_back(child);
          if (below[k] < before["nodes"].size() || node.value("mesh", json()) != was["mesh"]) continue;
          found = true;
          CHECK(node.value("skin", json()) == was.value("skin", json()));
          CHECK(node.value("weights", json()) == was.value("weights", json()));
        }
        CHECK(found);
      }
      // Names are each there once among what our animation drives.
      for (const json& channel : after.json["animations"][0]["channels"])
        if (channel["target"].contains("node"))
          CHECK(after.json["nodes"][channel["target"]["node"].get<std::size_t>()].value("name", "") != "");
    }
  }
}

TEST_CASE("patch: text that does not change is the same to the byte") {
  const TemporaryFolder folder;
  testing::write_everything_document(folder.path("in.gltf"));
  const std::string before = testing::file_bytes(folder.path("in.gltf"));
  const gltf::ReadResult source = read_source(folder.path("in.gltf"));
  Scene authored = source.scene;
  authored.objects.visibility[object(authored, "Crate").value] = shown_from(authored, 2.0F);
  REQUIRE(gltf::patch(*source.source, authored, folder.path("out.gltf"), {}));
  const std::string after = testing::file_bytes(folder.path("out.gltf"));
  std::multiset<std::string> left;
  std::istringstream after_lines(after);
  for (std::string line; std::getline(after_lines, line);) left.insert(line);
  std::size_t changed = 0;
  std::istringstream lines(before);
  for (std::string line; std::getline(lines, line);) {
    if (const auto found = left.find(line); found != left.end()) {
      left.erase(found);
    } else {
      ++changed;
    }
  }
  CHECK(changed < 12);  // ends of arrays, asset: of some hundred lines
  CHECK(after.find("1.50e0") != std::string::npos);
  CHECK(after.find("\\u0041") != std::string::npos);
}

TEST_CASE("patch: over its own input") {
  const TemporaryFolder folder;
  testing::write_everything_document(folder.path("model.gltf"));
  const std::string data = testing::file_bytes(folder.path("model.bin"));
  for (int round = 0; round < 3; ++round) {
    const gltf::ReadResult source = read_source(folder.path("model.gltf"));
    Scene authored = source.scene;
    authored.objects.visibility[object(authored, "Crate").value] =
        shown_from(authored, 2.0F + static_cast<float>(round));
    const auto report = gltf::patch(*source.source, authored, folder.path("model.gltf"), {});
    if (!report) FAIL(report.error().str());
    check_again(authored, folder.path("model.gltf"));
  }
  CHECK(testing::file_bytes(folder.path("model.bin")) == data);
  CHECK(folder.files() == std::vector<std::string>{"model.bin", "model.gltf", "model_timeline.bin",
                                                   "model_timeline_2.bin", "model_timeline_3.bin",
                                                   "picture.png"});

  const gltf::ReadResult source = read_source(folder.path("model.gltf"));
  REQUIRE(gltf::patch(*source.source, source.scene, folder.path("model.glb"), {}));
  const gltf::ReadResult glb = read_source(folder.path("model.glb"));
  Scene authored = glb.scene;
  authored.objects.visibility[object(authored, "Arm").value] = shown_from(authored, 4.0F);
  REQUIRE(gltf::patch(*glb.source, authored, folder.path("model.glb"), {}));
  check_again(authored, folder.path("model.glb"));
}

TEST_CASE("patch: our animation repeats the file's first one, which stays") {
  const TemporaryFolder folder;
  testing::write_everything_document(folder.path("in.gltf"));
  const gltf::ReadResult source = read_source(folder.path("in.gltf"));
  Scene authored = source.scene;
  authored.objects.visibility[object(authored, "Crate").value] = shown_from(authored, 2.0F);
  REQUIRE(gltf::patch(*source.source, authored, folder.path("out.glb"), {}));
  const json before = json::parse(testing::file_bytes(folder.path("in.gltf")));
  const json after = file_of(folder.path("out.glb")).json;
  REQUIRE(after["animations"].size() == before["animations"].size() + 1);
  CHECK(after["animations"][0]["name"] == "timeline");
  std::size_t repeated = 0;
  for (const json& channel : before["animations"][0]["channels"]) {
    const json& sampler = before["animations"][0]["samplers"][channel["sampler"].get<std::size_t>()];
    for (const json& ours : after["animations"][0]["channels"]) {
      if (ours["target"] != channel["target"]) continue;
      CHECK(after["animations"][0]["samplers"][ours["sampler"].get<std::size_t>()] == sampler);
      ++repeated;
    }
  }
  CHECK(repeated == before["animations"][0]["channels"].size());
}

TEST_CASE("patch: an extension that counts animations is mentioned") {
  const TemporaryFolder folder;
  testing::write_everything_document(folder.path("in.gltf"));
  json document = json::parse(testing::file_bytes(folder.path("in.gltf")));
  document["extensionsUsed"].push_back("KHR_interactivity");
  std::ofstream(folder.path("in.gltf")) << document.dump();
  const gltf::ReadResult source = read_source(folder.path("in.gltf"));
  Scene authored = source.scene;
  authored.objects.visibility[object(authored, "Crate").value] = shown_from(authored, 2.0F);
  const auto report = gltf::patch(*source.source, authored, folder.path("out.glb"), {});
  REQUIRE(report);
  REQUIRE(report->notes.size() == 1);
  CHECK_THAT(report->notes[0], Catch::Contains("KHR_interactivity"));
}

TEST_CASE("patch: asset.extras keep what others put there") {
  const TemporaryFolder folder;
  testing::write_everything_document(folder.path("in.gltf"));
  const gltf::ReadResult first = read_source(folder.path("in.gltf"));
  REQUIRE(gltf::patch(*first.source, first.scene, folder.path("once.gltf"), {}));
  const gltf::ReadResult second = read_source(folder.path("once.gltf"));
  REQUIRE(gltf::patch(*second.source, second.scene, folder.path("twice.gltf"), {}));
  const json once = file_of(folder.path("once.gltf")).json;
  const json twice = file_of(folder.path("twice.gltf")).json;
  CHECK(once["asset"]["extras"]["author"] == "somebody");
  CHECK(once["asset"]["extras"]["scenegen"]["source"]["generator"] == "another program");
  CHECK(twice["asset"] == once["asset"]);
}

TEST_CASE("patch: a material that is copied keeps everything but its color") {
  const TemporaryFolder folder;
  testing::write_everything_document(folder.path("in.gltf"));
  const gltf::ReadResult source = read_source(folder.path("in.gltf"));
  for (std::uint32_t copied = 0; copied < 2; ++copied) {
    Scene authored = source.scene;
    Material copy = authored.materials[copied];
    copy.name = "copy";
    copy.base_color = {0.25F, 0.5F, 0.75F, 1};
    const MaterialId added(authored.materials.size());
    authored.materials.push_back(copy);
    const ObjectId id = object(authored, "Crate");
    Mesh mesh = authored.meshes[authored.objects.mesh[id.value].value];
    for (Primitive& p : mesh.primitives) p.material = added;
    const float start[] = {0.0F}, value[] = {static_cast<float>(authored.meshes.size())};
    authored.meshes.push_back(mesh);
    authored.object_mesh_tracks.push_back(
        {id, authored.add_track(Property::mesh, Interpolation::step, start, value)});
    const float times[] = {0, 3}, colors[] = {1, 0, 0, 1, 0, 1, 0, 1};
    authored.material_tracks.push_back(
        {added, authored.add_track(Property::base_color, Interpolation::linear, times, colors)});
    authored.duration_s = std::max(authored.duration_s, 3.0F);
    const MaterialId copy_of[] = {MaterialId(copied)};
    const auto report = gltf::patch(*source.source, authored, folder.path("out.gltf"), {{}, copy_of});
    if (!report) FAIL(report.error().str());
    check_again(authored, folder.path("out.gltf"));
    const json before = json::parse(testing::file_bytes(folder.path("in.gltf")));
    const json after = file_of(folder.path("out.gltf")).json;
    json wanted = before["materials"][copied];
    wanted["name"] = "copy";
    wanted["pbrMetallicRoughness"]["baseColorFactor"] = {0.25, 0.5, 0.75, 1};
    CHECK(after["materials"].back() == wanted);
    CHECK(after["nodes"].size() == before["nodes"].size());  // one look only: no nodes for it
    const json used = after["extensionsUsed"];
    CHECK(std::find(used.begin(), used.end(), "KHR_animation_pointer") != used.end());
  }
}

TEST_CASE("patch: a mesh that is copied keeps morph targets, other attributes, extras") {
  const TemporaryFolder folder;
  testing::write_everything_document(folder.path("in.gltf"));
  const gltf::ReadResult source = read_source(folder.path("in.gltf"));
  Scene authored = source.scene;
  add_look(authored, object(authored, "Morphed"), MaterialId(0));
  REQUIRE(gltf::patch(*source.source, authored, folder.path("out.gltf"), {}));
  const json before = json::parse(testing::file_bytes(folder.path("in.gltf")));
  const json after = file_of(folder.path("out.gltf")).json;
  json wanted = before["meshes"][source.scene.objects.mesh[object(authored, "Morphed").value].value];
  wanted["name"] = "highlighted";
  for (json& primitive : wanted["primitives"]) primitive["material"] = 0;
  CHECK(after["meshes"].back() == wanted);
  std::size_t weighted = 0;
  for (const json& node : after["nodes"]) weighted += node.contains("weights") ? 1 : 0;
  CHECK(weighted == 2);  // both looks
}

TEST_CASE("patch: what cannot be expressed is refused, with the place and the remedy") {
  const TemporaryFolder folder;
  testing::write_everything_document(folder.path("in.gltf"));
  const gltf::ReadResult source = read_source(folder.path("in.gltf"));
  const std::string out = folder.path("out.glb");
  using Catch::Contains;
  Scene scene = source.scene;
  const ObjectId skinned = object(scene, "Skinned");
  scene.objects.visibility[skinned.value] = shown_from(scene, 1.0F);
  for (const auto visibility : {VisibilityEncoding::scale, VisibilityEncoding::both}) {
    const std::string error = error_of(source, scene, out, visibility);
    CHECK_THAT(error, Contains("/skin") && Contains("Skinned") && Contains("--visibility pointer"));
  }
  scene = source.scene;
  add_drop(scene, skinned);
  CHECK_THAT(error_of(source, scene, out, VisibilityEncoding::pointer), Contains("skin"));
  scene = source.scene;
  scene.objects.names = {};
  Scene other;
  CHECK_THAT(error_of(source, other, out), Contains("not the one that was read"));
  scene = source.scene;
  scene.frame_tracks.clear();
  const float times[] = {1.0F}, values[] = {0, 5, 0};
  scene.frame_tracks.push_back(
      {FrameId(0), scene.add_track(Property::translation, Interpolation::linear, times, values)});
  CHECK_THAT(error_of(source, scene, out), Contains("a new track for a node of the file"));
  scene = source.scene;
  scene.meshes.push_back({"mixed", {scene.meshes[0].primitives[0], scene.meshes[1].primitives[0]}});
  CHECK_THAT(error_of(source, scene, out), Contains("another geometry"));
  const auto bad_name = gltf::patch(*source.source, source.scene, folder.path("out.obj"), {});
  REQUIRE(!bad_name);
  CHECK(bad_name.error().kind == ErrorKind::usage);
}

TEST_CASE("patch: an instance of a node cannot have times of its own") {
  const TemporaryFolder folder;
  testing::write_instanced_document(folder.path("in.gltf"));
  const gltf::ReadResult source = read_source(folder.path("in.gltf"));
  Scene scene = source.scene;
  REQUIRE(scene.objects.size() == 3);
  scene.objects.visibility[1] = shown_from(scene, 1.0F);
  CHECK_THAT(error_of(source, scene, folder.path("out.glb")),
             Catch::Contains("/nodes/0") && Catch::Contains("shares its node with others"));
}

TEST_CASE("patch: layouts of ours in which objects share nodes stay as they are") {
  const TemporaryFolder folder;
  const Scene scene = testing::everything_scene();
  for (const auto layout : {gltf::Layout::groups, gltf::Layout::instances}) {
    INFO("layout " << static_cast<int>(layout));
    REQUIRE(gltf::write(scene, folder.path("in.glb"), {layout, {}, 1}));
    const gltf::ReadResult source = read_source(folder.path("in.glb"));
    const auto report = gltf::patch(*source.source, source.scene, folder.path("out.glb"), {});
    if (!report) FAIL(report.error().str());
    check_again(source.scene, folder.path("out.glb"));
  }
  REQUIRE(gltf::write(scene, folder.path("in.glb"), {gltf::Layout::merged, {}, 1}));
  const gltf::ReadResult merged = read_source(folder.path("in.glb"));
  CHECK_THAT(error_of(merged, merged.scene, folder.path("merged.glb")),
             Catch::Contains("layout nodes gives them some"));
}

TEST_CASE("patch: a picture that is missing is named as before, and said to be") {
  const TemporaryFolder folder;
  testing::write_everything_document(folder.path("in.gltf"));
  std::filesystem::remove(folder.path("picture.png"));
  const gltf::ReadResult source = read_source(folder.path("in.gltf"));
  const auto report = gltf::patch(*source.source, source.scene, folder.path("out.glb"), {});
  REQUIRE(report);
  REQUIRE(report->notes.size() == 1);
  CHECK_THAT(report->notes[0], Catch::Contains("/images/0"));
}
