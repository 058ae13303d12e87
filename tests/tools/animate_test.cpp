// scenegen animate as a user runs it: what it makes, what it refuses, and that nothing of the model is lost.
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "scene/gltf/read.h"
#include "scene/import/import.h"
#include "tests/support/gltf_file.h"
#include "tests/tools/at_end.h"
#include "tests/tools/process.h"
#include "timeline/appearance.h"
#include "timeline/compare.h"
#include "timeline/player.h"

using namespace scenegen;
using namespace scenegen::test;
using nlohmann::json;

namespace {

const std::string kEngine =
    std::string(ASSIMP_TESTMODELS) + "/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb";
const std::string kHouse = std::string(ASSIMP_TESTMODELS) + "/IFC/AC14-FZK-Haus.ifc";
const std::string kSkin = std::string(ASSIMP_TESTMODELS) + "/glTF2/simple_skin/simple_skin.gltf";

ProcessResult animate(const TemporaryFolder& folder, const std::string& model, const std::string& options) {
  std::vector<std::string> arguments{"animate", model};
  for (const std::string& word : words(options)) arguments.push_back(word);
  return run(SCENEGEN_PROGRAM, arguments, {.folder = folder.path()});
}

void check_ok(const ProcessResult& result) {
  INFO(result.out << result.err);
  CHECK(result.signal == 0);
  REQUIRE(result.code == 0);
}

Scene read_scene(const std::string& path) {
  auto read = import::read_model(path);
  if (!read) FAIL(read.error().str());
  return std::move(read->scene);
}

void check_equal(const Scene& a, const Scene& b) {
  const timeline::Comparison comparison = timeline::compare(a, b);
  for (const auto& d : comparison.differences) UNSCOPED_INFO(d.where << ": " << d.what);
  CHECK(comparison.equal());
}

/// Times of first appearance, by name.
std::map<std::string, float> first_shown(const Scene& scene) {
  std::map<std::string, float> out;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    float& time = out[std::string(scene.objects.names[i])];
    const TrackId track = scene.objects.visibility[i];
    if (!track.valid()) continue;
    const auto values = scene.values(track);
    const auto at = std::find(values.begin(), values.end(), 1.0F);
    time = at == values.end() ? -1.0F : scene.times_s(track)[static_cast<std::size_t>(at - values.begin())];
  }
  return out;
}

}  // namespace

TEST_CASE("the engine's parts appear along the curve, and at the end it is the engine") {
  const TemporaryFolder folder;
  for (const char* visibility : {"scale", "pointer", "both"}) {
    INFO(visibility);
    const ProcessResult result =
        animate(folder, kEngine, std::string("-o e.glb --coherence 0.8 --seed 7 --visibility ") + visibility);
    check_ok(result);
    CHECK(result.err.empty());
    CHECK_THAT(result.out, Catch::Matchers::StartsWith("e.glb  ") &&
                               Catch::Matchers::Contains("  67 objects  ") &&
                               Catch::Matchers::Contains("  seed 7  "));
    const Scene made = read_scene(folder.file("e.glb"));
    check_equal(at_end(read_scene(kEngine)), at_end(made));
    timeline::Player player(timeline::compile(made));
    player.seek(0);
    CHECK(player.visible_count() == 0);
    REQUIRE(made.info.appearance);
    CHECK(made.info.appearance->timed_objects == 67);
    CHECK(made.info.appearance->coherence_measured == Approx(0.8).margin(0.01));
    CHECK(timeline::measure_coherence(made).value() == Approx(made.info.appearance->coherence_measured));
    CHECK(made.info.seed == 7);
    CHECK(made.info.arguments == words(std::string("--coherence 0.8 --seed 7 --visibility ") + visibility));
  }
}

TEST_CASE("the same times as for generated scenes: by cell, whatever the encoding or the threads") {
  const TemporaryFolder folder;
  check_ok(animate(folder, kEngine, "-o a.glb --threads 1"));
  check_ok(animate(folder, kEngine, "-o b.glb --threads 3"));
  CHECK(read_file(folder.file("a.glb")) == read_file(folder.file("b.glb")));
  Scene expected = read_scene(kEngine);
  REQUIRE(timeline::assign_appearance(expected, {}));
  CHECK(first_shown(expected) == first_shown(read_scene(folder.file("a.glb"))));
}

TEST_CASE("a model of another format is imported and animated, and the storeys can be told apart") {
  const TemporaryFolder folder;
  const ProcessResult result =
      run(SCENEGEN_PROGRAM,
          {"animate", kHouse, "-o", "house.glb", "--exclude", "extras.ifcClass=IfcSite", "--rule",
           "construct:subtree=*Erdgeschoss*", "--report", "r.json"},
          {.folder = folder.path()});
  check_ok(result);
  const json report = json::parse(read_file(folder.file("r.json")));
  CHECK(report["objects"] == 110);
  CHECK(report["excluded"].get<int>() > 0);
  CHECK(report["profiles"]["construct"].get<int>() > 20);
  CHECK(report["profiles"]["appear"].get<int>() > 20);
  const Scene made = read_scene(folder.file("house.glb"));
  check_equal(at_end(read_scene(kHouse)), at_end(made));
  CHECK_FALSE(made.object_mesh_tracks.empty());
}

TEST_CASE("split parts and excluded objects") {
  const TemporaryFolder folder;
  check_ok(animate(folder, kEngine, "-o e.glb --split components --exclude name=*part_0"));
  const Scene made = read_scene(folder.file("e.glb"));
  CHECK(made.objects.size() > 80);
  std::size_t whole = 0;
  for (const auto& [name, time] : first_shown(made)) {
    INFO(name);
    if (name.ends_with("/part_0")) CHECK(time == 0.0F);
    if (name.ends_with("/part_1")) CHECK(time > 0.0F);
    whole += name.find("/part_") == std::string::npos ? 1 : 0;
  }
  CHECK(whole > 0);
  CHECK(timeline::measure_coherence(made).value() == 1.0);
}

TEST_CASE("our own instanced files get times of their own again") {
  const TemporaryFolder folder;
  check_ok(
      run(SCENEGEN_PROGRAM, words("--curve none --layout instances -o town.glb"), {.folder = folder.path()}));
  check_ok(run(SCENEGEN_PROGRAM, words("--layout nodes -o wanted.glb"), {.folder = folder.path()}));
  check_ok(animate(folder, "town.glb", "-o made.glb --exclude ground/*"));
  check_equal(read_scene(folder.file("wanted.glb")), read_scene(folder.file("made.glb")));
}

TEST_CASE("a file that has times already gets others") {
  const TemporaryFolder folder;
  for (const char* layout : {"nodes", "instances"}) {
    const std::string kind = layout;
    INFO(kind);
    const std::string make = "--grid 1x1 --layout " + kind;
    check_ok(run(SCENEGEN_PROGRAM, words(make + " --curve none -o still.glb"), {.folder = folder.path()}));
    check_ok(run(SCENEGEN_PROGRAM, words(make + " --cells 5x5x5 -o timed.glb"), {.folder = folder.path()}));
    for (const char* profile : {"appear", "construct", "drop"}) {
      const std::string how =
          "--exclude ground/* --cells 7x6x5 --interval 0.02 --profile " + std::string(profile) + " -o ";
      check_ok(animate(folder, "still.glb", how + "once.glb"));
      check_ok(animate(folder, "timed.glb", how + "again.glb"));
      check_equal(read_scene(folder.file("once.glb")), read_scene(folder.file("again.glb")));
    }
  }
}

TEST_CASE("stdin, stdout, dry runs and configs") {
  const TemporaryFolder folder;
  check_ok(animate(folder, kEngine, "-o e.glb --rule drop:name=* --rule construct:node_1*"));
  const ProcessResult streamed =
      animate(folder, kEngine, "-o - -q --rule drop:name=* --rule construct:node_1*");
  check_ok(streamed);
  CHECK(streamed.out == read_file(folder.file("e.glb")));
  const ProcessResult dry = animate(folder, kEngine, "--dry-run --format json");
  check_ok(dry);
  CHECK(json::parse(dry.out)["objects"] == 67);
  CHECK(json::parse(dry.out)["written"] == false);
  CHECK(folder.entries() == std::vector<std::string>{"e.glb"});
  const ProcessResult dumped =
      animate(folder, kEngine, "--rule drop:name=* --rule construct:node_1* --cells 8x8x8 --dump-config");
  check_ok(dumped);
  CHECK(json::parse(dumped.out)["rule"] == json{"drop:name=*", "construct:node_1*"});
  write_file(folder.file("c.json"), dumped.out);
  check_ok(animate(folder, kEngine, "--config c.json -o a.glb"));
  check_ok(animate(folder, kEngine, "--rule drop:name=* --rule construct:node_1* --cells 8x8x8 -o b.glb"));
  const Scene by_config = read_scene(folder.file("a.glb"));
  CHECK_FALSE(by_config.object_mesh_tracks.empty());
  check_equal(by_config, read_scene(folder.file("b.glb")));
}

TEST_CASE("the model may be overwritten only by name") {
  const TemporaryFolder folder;
  write_file(folder.file("m.glb"), read_file(kEngine));
  const ProcessResult refused = animate(folder, "m.glb", "");
  CHECK(refused.code == 2);
  CHECK(refused.err == "error: --output: is missing: say which file to write (-o m_animated.glb)\n");
  CHECK(read_file(folder.file("m.glb")) == read_file(kEngine));
  check_ok(animate(folder, "m.glb", "-o m.glb"));
  check_equal(at_end(read_scene(kEngine)), at_end(read_scene(folder.file("m.glb"))));
}

TEST_CASE("wrong calls of animate are one line and leave nothing behind") {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& model, const std::string& options, int code,
                         const std::string& what) {
    const ProcessResult result = animate(folder, model, options);
    INFO(model << " " << options << "\n" << result.err);
    CHECK(result.signal == 0);
    CHECK(result.code == code);
    CHECK(result.out.empty());
    CHECK_THAT(result.err, Catch::Matchers::StartsWith("error: ") && Catch::Matchers::Contains(what));
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
    CHECK(folder.entries().empty());
  };
  check("no.glb", "-o a.glb", 3, "no.glb: ");
  check("no.fbx", "-o a.glb", 3, "no.fbx: No such file");
  check(kEngine, "-o a.obj", 2, "ends neither in .glb nor in .gltf");
  check(kEngine, "-o a.glb --rule construct", 2, "--rule: 'construct' is not of the form PROFILE:SELECTOR");
  check(kEngine, "-o a.glb --rule build:x", 2, "--rule: ");
  check(kEngine, "-o a.glb --rule drop:name~(", 2, "--rule: ");
  check(kEngine, "-o a.glb --rule drop:nothing*", 1, "--rule: 'nothing*' chooses no object of the model");
  check(kEngine, "-o a.glb --exclude *", 1, "--exclude: leaves no object");
  check(kEngine, "-o a.glb --up z", 2, "--up: cannot be used with glTF");
  check(kEngine, "-o a.glb --highlight drop=#ff0000", 2, "--highlight: ");
  check(kEngine, "-o a.glb --cells 1x1x1 --coherence 0.5", 2, "--coherence");
  check(kEngine, "-o a.glb --split pieces", 2, "--split: unknown value 'pieces'");
  check(kHouse, "-o a.glb --unit 0", 2, "--unit: 0 is out of range");
  check(std::string(ASSIMP_TESTMODELS) + "/invalid/malformed.obj", "-o a.glb", 1,
        "Assimp: OBJ: Invalid face index.");
  check(kSkin, "-o a.glb", 1, "--visibility pointer");
}

TEST_CASE("an extension that a file requires and nobody here reads is refused by name") {
  const TemporaryFolder folder;
  for (const char* extension : {"KHR_texture_basisu", "EXT_meshopt_compression", "ACME_future"}) {
    write_file(folder.file("m.gltf"), std::string(R"({"asset":{"version":"2.0"},"extensionsUsed":[")") +
                                          extension + R"("],"extensionsRequired":[")" + extension + R"("]})");
    const ProcessResult result = animate(folder, "m.gltf", "-o a.glb");
    CHECK(result.code == 1);
    CHECK_THAT(result.err, Catch::Matchers::Contains(std::string("requires the extension ") + extension));
    CHECK(folder.entries() == std::vector<std::string>{"m.gltf"});
  }
  write_file(folder.file("m.gltf"), R"({"asset":{"version":"2.0"},"nodes":[{}],"scenes":[{"nodes":[0]}]})");
  CHECK_THAT(animate(folder, "m.gltf", "-o a.glb").err, Catch::Matchers::Contains("has no objects"));
}
