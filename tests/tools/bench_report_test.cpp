// Results of benchmarks as sections of a report.
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "tools/bench_report.h"

using namespace scenegen::tools;
using nlohmann::ordered_json;

namespace {

ordered_json ours() {
  return ordered_json::parse(R"({
    "schema": "sceneplay/bench", "version": 2,
    "program": {"name": "sceneplay", "version": "0.1.0"}, "machine": {"processor": "P", "cores": 2},
    "devices": [{"name": "llvmpipe", "driver": "Mesa"}],
    "settings": {"size": [320, 180], "samples": 1, "readback": true},
    "scenes": [{"file": "a/town.glb", "loadMs": 20}],
    "cases": [
      {"file": "a/town.glb", "device": "llvmpipe", "camera": "orbit", "framesInFlight": 2, "strategy": "inline",
       "frameMs": {"mean": 8, "median": 7, "p25": 6, "p75": 9, "p95": 12, "min": 5, "low": 7.5, "high": 8.5},
       "overTime": {"timeS": [0, 1], "frameMs": [8, 9]}, "startMs": 5, "cpuMs": {"mean": 2},
       "stagesMs": {"cull": {"mean": 1.5}, "gpu": {"mean": 6}, "ask": {"mean": 0}, "gpuSolid": null},
       "counters": {"draws": 100, "queries": 0}, "deviceBytes": 1000},
      {"file": "a/town.glb", "device": "llvmpipe", "camera": "orbit", "framesInFlight": 2, "strategy": "octree",
       "frameMs": {"mean": 4, "median": 4}, "stagesMs": {"cull": {"mean": 0.5}}, "counters": {"draws": 50, "queries": 2}},
      {"file": "a/town.glb", "device": "llvmpipe", "camera": "walk", "framesInFlight": 2, "strategy": "inline",
       "error": "lost"}]})");
}
ordered_json theirs() {
  return ordered_json::parse(R"({
    "schema": "sceneplay/bench", "version": 2, "program": {"name": "examples/web"},
    "devices": [{"name": "SwiftShader"}],
    "scenes": [{"file": "town.glb", "loadMs": 300}],
    "cases": [{"file": "town.glb", "device": "SwiftShader", "camera": "b/orbit", "framesInFlight": 1,
               "strategy": "three.js", "frameMs": {"mean": 40, "median": 38}, "startMs": 100,
               "memoryBytes": 5000, "correctness": 99.5}]})");
}

const DocumentTable& table(const DocumentSection& section, const std::string& id) {
  for (const Block& block : section.blocks) {
    const auto* found = std::get_if<DocumentTable>(&block);
    if (found != nullptr && found->id == id) return *found;
  }
  FAIL("no table " << id);
  throw 0;
}

Cell value(const DocumentTable& t, std::size_t row, const std::string& column) {
  for (std::size_t i = 0; i < t.columns.size(); ++i) {
    if (t.columns[i].name == column) return t.rows.at(row).at(i);
  }
  FAIL("no column " << column);
  return {};
}

void check_whole(const DocumentSection& section) {
  std::set<std::string> ids;
  for (const Block& block : section.blocks) {
    std::visit([&](const auto& b) { CHECK(ids.insert(b.id).second); }, block);
    if (const auto* t = std::get_if<DocumentTable>(&block)) {
      for (const auto& row : t->rows) CHECK(row.size() == t->columns.size());
    }
  }
  REQUIRE_FALSE(section.paragraphs.empty());
}

}  // namespace

TEST_CASE("results of ours and of other renderers stand in one table") {
  const std::vector<ordered_json> all{ours(), theirs()};
  const DocumentSection section = bench_section_of_all(all);
  check_whole(section);
  CHECK(section.paragraphs[0] == "octree, 2 in flight, llvmpipe is fastest in 1 of 1 view; 1 case failed.");
  const DocumentTable& frames = table(section, "bench-frame-1");
  REQUIRE(frames.rows.size() == 3);
  CHECK(std::get<double>(value(frames, 0, "vsBest")) == 2);
  CHECK(std::get<double>(value(frames, 2, "vsBest")) == 10);
  CHECK(std::get<double>(value(frames, 0, "loadMs")) == 25);
  CHECK(std::get<double>(value(frames, 2, "loadMs")) == 400);
  CHECK(std::get<double>(value(frames, 2, "correctness")) == 99.5);
  CHECK(std::get<double>(value(frames, 2, "memoryBytes")) == 5000);
  CHECK(std::holds_alternative<std::monostate>(value(frames, 2, "cpuMs")));
  CHECK_THAT(std::get<std::string>(value(frames, 2, "strategy")), Catch::Matchers::Contains("three.js"));
  const DocumentTable& stages = table(section, "bench-stages-1");
  CHECK(stages.columns.size() == 3);  // what takes no time anywhere has no column
  CHECK(std::get<double>(value(stages, 1, "cull")) == 0.5);
  CHECK(std::holds_alternative<std::monostate>(value(stages, 2, "cull")));
  CHECK(std::get<double>(value(table(section, "bench-counters-1"), 1, "queries")) == 2);
  CHECK_THAT(table(section, "bench-frame-2").note, Catch::Matchers::Contains("inline failed: lost"));
  const auto charts = std::count_if(section.blocks.begin(), section.blocks.end(),
                                    [](const Block& b) { return std::holds_alternative<Chart>(b); });
  CHECK(charts == 2);  // all views; over time
}

TEST_CASE("results that are damaged give empty cells and no crash") {
  const std::string whole = ours().dump();
  for (const char* wrong :
       {R"({})", R"([])", R"(null)", R"({"cases": 3})", R"({"cases": [1, null, "x", {}]})",
        R"({"cases": [{"frameMs": 1, "stagesMs": [], "counters": {"a": "b"}, "overTime": 2}]})",
        R"({"devices": 1, "settings": "x", "scenes": {"a": 1}, "cases": []})"}) {
    INFO(wrong);
    const ordered_json json = ordered_json::parse(wrong);
    check_whole(bench_section(json));
  }
}
