// sceneplay report of what sceneplay bench wrote, beside other renderers' results.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "scene/gltf/write.h"
#include "tests/render/render_support.h"
#include "tests/tools/process.h"
#include "tools/report/document.h"

using namespace scenegen;
using namespace scenegen::test;
using namespace scenegen::tools;
using nlohmann::ordered_json;

namespace {

ProcessResult play(const std::string& line) {
  return run(SCENEPLAY_PROGRAM, words(line));
}

/// Two scenes of one name: a wall, and half of it.
void write_scenes(const TemporaryFolder& folder) {
  for (const char* name : {"a", "b"}) std::filesystem::create_directories(folder.file(name));
  REQUIRE(gltf::write(render::test::wall_scene(), folder.file("a/wall.glb"), {}));
  Scene boxes;
  for (int i = 0; i < 20; ++i) {
    const MeshId mesh = render::test::add_mesh(boxes, render::test::box_geometry(),
                                               render::test::plain({0.5F, 0.5F, 0.5F, 1}));
    render::test::add_object(boxes, "box" + std::to_string(i), mesh, {2.0F * static_cast<float>(i), 0.5F, 0});
  }
  REQUIRE(gltf::write(boxes, folder.file("b/wall.glb"), {}));
}

/// As examples/web writes it, of the first scene on another machine; one viewer crashed.
ordered_json of_viewers(const TemporaryFolder& folder) {
  ordered_json out = ordered_json::parse(R"({
    "schema": "sceneplay/bench", "version": 2,
    "program": {"name": "examples/web", "version": "0.1.0", "compiler": "node 18.19.0"},
    "arguments": ["wall.glb"], "machine": {"processor": "P", "cores": 2},
    "devices": [{"name": "SwiftShader", "type": "CPU", "driver": "WebGL"}],
    "settings": {"size": [32, 18], "samples": 4, "shadows": false, "frames": 3, "warmUp": 1, "repeat": 2, "readback": true},
    "scenes": [{"file": "/home/x/wall.glb"}],
    "cases": [
      {"file": "/home/x/wall.glb", "device": "SwiftShader", "camera": "/home/x/orbit", "framesInFlight": 1,
       "strategy": "three.js", "version": "0.160", "samples": 4, "frames": 3, "repetitions": 2,
       "frameMs": {"mean": 41.5, "median": 40, "p25": 39, "p75": 42, "p95": 44, "min": 38, "low": 40, "high": 43, "runs": [41, 42]},
       "overTime": {"timeS": [0, 1, 2], "frameMs": [40, 41, 42]}, "loadMs": 900, "startMs": 100,
       "processCpuMs": {"mean": 55.5, "median": 55.5, "p25": 55, "p75": 56, "p95": 56, "min": 55},
       "memoryBytes": 200000000, "jsHeapBytes": 5000000, "correctness": 99.5, "warnings": []},
      {"file": "/home/x/wall.glb", "device": "SwiftShader", "camera": "/home/x/orbit", "framesInFlight": 1,
       "strategy": "Babylon.js", "error": "the browser crashed; out of memory?"}]})");
  out["scenes"][0]["bytes"] = std::filesystem::file_size(folder.file("a/wall.glb"));
  return out;
}

/// Tables of frame times by title.
std::vector<DocumentTable> frame_tables(const DocumentSection& section) {
  std::vector<DocumentTable> out;
  for (const Block& block : section.blocks) {
    const auto* table = std::get_if<DocumentTable>(&block);
    if (table != nullptr && table->id.find("-frame-") != std::string::npos) out.push_back(*table);
  }
  return out;
}

const Cell& cell(const DocumentTable& table, std::size_t row, const std::string& column) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].name == column) return table.rows.at(row).at(i);
  }
  FAIL("no column " << column);
  throw 0;
}

}  // namespace

TEST_CASE("report: scenes of one name stay apart, and viewers stand beside the scene that they drew") {
  const TemporaryFolder folder;
  write_scenes(folder);
  const auto measured =
      play("bench " + folder.file("a/wall.glb") + " " + folder.file("b/wall.glb") +
           " --strategy inline,instanced --camera-path orbit --frames 3 --repeat 2 --warm-up 2 "
           "--size 32x18 --shadows off --readback --frames-in-flight 1 -q -o " +
           folder.file("all/ours"));
  INFO(measured.err);
  REQUIRE(measured.code == 0);
  std::filesystem::create_directories(folder.file("all/web"));
  test::write_file(folder.file("all/web/bench.json"), of_viewers(folder).dump());

  const auto json = play("report " + folder.file("all") + " -o - --format json");
  INFO(json.err);
  REQUIRE(json.code == 0);
  const auto document = document_from_json(ordered_json::parse(json.out)["runs"][0], "");
  REQUIRE(document);
  const DocumentSection& section = document->sections.at(0);
  const std::vector<DocumentTable> tables = frame_tables(section);
  REQUIRE(tables.size() == 2);
  CHECK(tables[0].title == "Frame time: " + folder.file("a/wall.glb") + ", orbit");
  CHECK(tables[1].title == "Frame time: " + folder.file("b/wall.glb") + ", orbit");
  REQUIRE(tables[0].rows.size() == 4);
  REQUIRE(tables[1].rows.size() == 2);
  const ordered_json bench = ordered_json::parse(read_file(folder.file("all/ours/bench.json")));
  for (std::size_t i = 0; i < 4; ++i) {
    const DocumentTable& table = tables[i / 2];
    const ordered_json& c = bench["cases"][i];
    CHECK(
        std::get<std::string>(cell(table, i % 2, "strategy")).starts_with(c["strategy"].get<std::string>()));
    CHECK(std::get<double>(cell(table, i % 2, "frameMs")) == c["frameMs"]["mean"]);
    CHECK(std::get<double>(cell(table, i % 2, "processCpuMs")) == c["processCpuMs"]["mean"]);
    CHECK(std::get<double>(cell(table, i % 2, "loadMs")) > 0);
  }
  CHECK(std::get<std::string>(cell(tables[0], 2, "strategy")).starts_with("three.js"));
  CHECK(std::get<double>(cell(tables[0], 2, "processCpuMs")) == 55.5);
  CHECK(std::get<double>(cell(tables[0], 2, "loadMs")) == 1000);
  CHECK(std::holds_alternative<std::monostate>(cell(tables[0], 3, "frameMs")));
  REQUIRE(section.failures.size() == 1);
  CHECK_THAT(section.paragraphs.at(0), Catch::Matchers::Contains("; 1 case failed. Frames of "));
  CHECK(section.failures[0].why == "the browser crashed; out of memory?");
  CHECK(section.failures[0].what.find("Babylon.js") != std::string::npos);

  for (const char* name : {"r.html", "r.md"}) {
    REQUIRE(play("report " + folder.file("all") + " -q -o " + folder.file(name)).code == 0);
    const std::string text = read_file(folder.file(name));
    for (const char* word : {"three.js", "instanced", "1 case failed", "the browser crashed"})
      CHECK_THAT(text, Catch::Matchers::Contains(word));
  }
  REQUIRE(play("report " + folder.file("all") + " -q --format csv -o " + folder.file("csv")).code == 0);
  CHECK_THAT(read_file(folder.file("csv/bench-frame-1.csv")), Catch::Matchers::Contains("three.js"));
  CHECK_THAT(read_file(folder.file("csv/_failures.csv")), Catch::Matchers::Contains("Babylon.js"));
}

TEST_CASE("report: a run of an earlier version of bench.json is refused by its name") {
  const TemporaryFolder folder;
  write_scenes(folder);
  ordered_json old = of_viewers(folder);
  old["version"] = 1;
  test::write_file(folder.file("old.json"), old.dump());
  const auto result = play("report " + folder.file("old.json") + " -o " + folder.file("r.html"));
  CHECK(result.code == 1);
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  CHECK_THAT(result.err, Catch::Matchers::Contains("old.json") && Catch::Matchers::Contains("version 1") &&
                             Catch::Matchers::Contains("measure anew"));
  CHECK_FALSE(std::filesystem::exists(folder.file("r.html")));
}
