// scenegen optimize from end to end: the same scene in less, what it says, what it refuses.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/gltf_text.h"
#include "tests/tools/process.h"

using namespace scenegen::test;
using nlohmann::json;

namespace {

ProcessResult run_in(const TemporaryFolder& folder, const std::string& arguments) {
  return run(SCENEGEN_PROGRAM, words(arguments), {.folder = folder.path()});
}

ProcessResult made_by(const TemporaryFolder& folder, const std::string& arguments) {
  ProcessResult result = run_in(folder, arguments);
  INFO("scenegen " << arguments << "\n" << result.err);
  REQUIRE(result.code == 0);
  return result;
}

json json_of(const TemporaryFolder& folder, const std::string& arguments) {
  return json::parse(made_by(folder, arguments + " --format json").out);
}

/// One line of error, the given code, and nothing left behind.
void refused(const TemporaryFolder& folder, const std::string& arguments, int code, const std::string& line) {
  INFO("scenegen " << arguments);
  const std::vector<std::string> before = folder.entries();
  const ProcessResult result = run_in(folder, arguments);
  CHECK(result.code == code);
  CHECK(result.out.empty());
  CHECK(result.err == "error: " + line + "\n");
  CHECK(folder.entries() == before);
}

}  // namespace

TEST_CASE("every layout and encoding becomes every other and stays the same scene") {
  const TemporaryFolder folder;
  const std::string town = "--grid 2x1 --extras 2 --coherence 0.9 --cells 8x8x8 --seed 7 ";
  for (const std::string from : {"nodes", "groups", "instances"}) {
    for (const std::string visibility : {"scale", "pointer"}) {
      made_by(folder, town + "--layout " + from + " --visibility " + visibility + " -o in.glb");
      const std::string to = from == "nodes" ? "instances" : from == "groups" ? "nodes" : "groups";
      made_by(folder, "optimize in.glb -o out.glb --visibility both --layout " + to);
      INFO(from << " " << visibility << " -> " << to);
      CHECK_THAT(made_by(folder, "diff in.glb out.glb").out, Catch::Matchers::StartsWith("equal  "));
    }
  }
  const json about = json_of(folder, "inspect out.glb");  // what made the scene is still known
  CHECK(about["arguments"].dump().find("--seed") != std::string::npos);
  CHECK(about["coherence"] == json_of(folder, "inspect in.glb")["coherence"]);
}

TEST_CASE("nodes with scale become a fraction, and the report says how") {
  const TemporaryFolder folder;
  made_by(folder, "--grid 2x2 --cells 8x8x8 --layout nodes -o in.glb");
  const json report = json_of(folder, "optimize in.glb -o out.glb --report report.json");
  CHECK(report["schema"] == "scenegen/optimize");
  CHECK(report["bytes"]["before"] == json_of(folder, "inspect in.glb")["bytes"]);
  CHECK(report["bytes"]["after"] == json_of(folder, "inspect out.glb")["bytes"]);
  CHECK(report["bytes"]["after"].get<double>() < 0.55 * report["bytes"]["before"].get<double>());
  CHECK(report["draws"]["before"].get<double>() > 3 * report["draws"]["after"].get<double>());
  CHECK(report["channels"]["before"].get<double>() > 3 * report["channels"]["after"].get<double>());
  CHECK(report["layout"] == "instances");
  json from_file = json::parse(read_file(folder.file("report.json")));
  from_file["seconds"] = report["seconds"];
  CHECK(from_file == report);
  CHECK_THAT(made_by(folder, "diff in.glb out.glb").out, Catch::Matchers::StartsWith("equal  "));

  // The same again, to stdout and over itself: the same bytes.
  const ProcessResult piped = made_by(folder, "optimize in.glb -o -");
  CHECK(piped.out == read_file(folder.file("out.glb")));
  made_by(folder, "optimize in.glb -o in.glb");
  CHECK(read_file(folder.file("in.glb")) == piped.out);
  const json dry = json_of(folder, "optimize in.glb --dry-run");
  CHECK(dry["bytes"]["after"] == piped.out.size());
}

TEST_CASE("a result that is larger is said to be") {
  const TemporaryFolder folder;
  const auto note = Catch::Matchers::Contains("note: larger than before: ");
  made_by(folder, "--cells 8x8x8 --layout instances -o in.glb");
  CHECK_THAT(made_by(folder, "optimize in.glb -o out.glb --layout nodes").err, note);
  CHECK_THAT(made_by(folder, "optimize out.glb -o back.glb --layout instances").err, !note);
}

TEST_CASE("with draco, diff agrees within its rounding") {
  const TemporaryFolder folder;
  made_by(folder, "--grid 1x1 --extras 3 --extra-model sphere:32 --layout nodes -o in.glb");
  const json report = json_of(folder, "optimize in.glb -o out.glb --draco");
  CHECK(report["dracoGeometries"].get<int>() >= 1);
  CHECK(run_in(folder, "diff in.glb out.glb").code == 1);
  CHECK_THAT(made_by(folder, "diff in.glb out.glb --geometry-tolerance 1e-3 --normal-tolerance 0.03").out,
             Catch::Matchers::StartsWith("equal  "));
}

TEST_CASE("what would be lost is named and kept, unless that is allowed") {
  const TemporaryFolder folder;
  scenegen::testing::GltfText g;
  const std::string mesh = g.triangle_mesh();
  write_file(folder.file("in.gltf"), g.str(R"("nodes":[{"mesh":0,"extras":{"guid":"2O2Fr$"}}],)" + mesh));
  refused(folder, "optimize in.gltf -o out.glb", 1,
          "in.gltf: rewriting it would lose extras of nodes (/nodes/0/extras): give --allow-loss to write it "
          "without");
  const ProcessResult allowed = made_by(folder, "optimize in.gltf -o out.glb --allow-loss");
  CHECK_THAT(allowed.err, Catch::Matchers::StartsWith("note: lost extras of nodes (/nodes/0/extras)\n"));
  CHECK_THAT(made_by(folder, "diff in.gltf out.glb").out, Catch::Matchers::StartsWith("equal  "));
}

TEST_CASE("wrong calls and damaged files") {
  const TemporaryFolder folder;
  made_by(folder, "--cells 8x8x8 -o in.glb");
  refused(folder, "optimize", 2, "missing FILE (usage: scenegen optimize FILE -o OUT [options])");
  refused(folder, "optimize in.glb", 2, "--output: is missing: say which file to write (-o small.glb)");
  refused(folder, "optimize in.glb -o out.png", 2,
          "--output: 'out.png' ends neither in .glb nor in .gltf (nearest: 'out.glb')");
  refused(folder, "optimize in.glb -o out.glb --draco-level 3", 2, "--draco-level: needs --draco");
  const ProcessResult missing = run_in(folder, "optimize nowhere.glb -o out.glb");
  CHECK(missing.code == 3);
  write_file(folder.file("bad.glb"), read_file(folder.file("in.glb")).substr(0, 1000));
  const ProcessResult bad = run_in(folder, "optimize bad.glb -o out.glb");
  CHECK(bad.code == 1);
  CHECK_THAT(bad.err, Catch::Matchers::StartsWith("error: bad.glb: "));
  CHECK(folder.entries() == std::vector<std::string>{"bad.glb", "in.glb"});
  // A model that other verbs read.
  write_file(folder.file("house.IFC"), "ISO-10303-21;\nHEADER;\nENDSEC;\nEND-ISO-10303-21;\n");
  const std::string other =
      "house.IFC: is no glTF, and only that is read here; scenegen animate and scenegen schedule make a .glb "
      "of "
      "'.ifc'";
  refused(folder, "optimize house.IFC -o out.glb", 1, other);
  refused(folder, "diff in.glb house.IFC", 1, other);
}
