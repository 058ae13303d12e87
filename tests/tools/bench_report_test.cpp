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
               "strategy": "three.js", "version": "187", "frameMs": {"mean": 40, "median": 38}, "startMs": 100,
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
  // What a way of drawing was measured on is not said where there is one device a way; versions are.
  CHECK(section.paragraphs[0] ==
        "octree, 2 in flight is fastest in 1 of 1 view; 1 case failed. Frames of three.js 187, 1 in flight "
        "take 10 "
        "times as long as those of the fastest, of inline, 2 in flight 2.0.");
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
  REQUIRE(section.failures.size() == 1);
  CHECK(section.failures[0].what == "town.glb, walk: inline");
  CHECK(section.failures[0].why == "lost");
  const auto charts = std::count_if(section.blocks.begin(), section.blocks.end(),
                                    [](const Block& b) { return std::holds_alternative<Chart>(b); });
  CHECK(charts == 2);  // all views; over time
}

TEST_CASE("scenes of one name are the same when nothing says otherwise") {
  const auto titles = [](const std::vector<ordered_json>& all) {
    std::vector<std::string> out;
    const DocumentSection section = bench_section_of_all(all);
    check_whole(section);
    for (const Block& block : section.blocks) {
      const auto* found = std::get_if<DocumentTable>(&block);
      if (found != nullptr && found->id.find("-frame-") != std::string::npos)
        out.push_back(found->title.substr(std::string("Frame time: ").size()) + " " +
                      std::to_string(found->rows.size()));
    }
    return out;
  };
  const auto result = [](std::vector<std::pair<const char*, int>> scenes) {
    ordered_json out{{"scenes", ordered_json::array()}, {"cases", ordered_json::array()}};
    for (const auto& [file, bytes] : scenes) {
      out["scenes"].push_back({{"file", file}, {"objects", 10}});
      if (bytes > 0) out["scenes"].back()["bytes"] = bytes;
      out["cases"].push_back(
          {{"file", file}, {"camera", "p/orbit"}, {"strategy", "s"}, {"frameMs", {{"mean", 1}}}});
    }
    return out;
  };
  using Titles = std::vector<std::string>;
  // From other folders, with nothing known or all equal.
  CHECK(titles({result({{"a/t.glb", 0}}), result({{"b/t.glb", 7}})}) == Titles{"t.glb, orbit 2"});
  CHECK(titles({result({{"a/t.glb", 7}}), result({{"b/t.glb", 7}})}) == Titles{"t.glb, orbit 2"});
  // Another file at another place, or at the same.
  CHECK(titles({result({{"a/t.glb", 7}}), result({{"b/t.glb", 8}})}) ==
        Titles{"a/t.glb, orbit 1", "b/t.glb, orbit 1"});
  CHECK(titles({result({{"t.glb", 7}}), result({{"t.glb", 8}})}) ==
        Titles{"t.glb, 10 objects, 7 B, orbit 1", "t.glb, 10 objects, 8 B, orbit 1"});
  // Two of a name in one result: then a name alone says nothing.
  CHECK(titles(
            {result({{"a/t.glb", 0}, {"b/t.glb", 0}}), result({{"b/t.glb", 0}}), result({{"c/t.glb", 0}})}) ==
        Titles{"a/t.glb, orbit 1", "b/t.glb, orbit 2", "c/t.glb, orbit 1"});
  CHECK(titles({result({{"a/t.glb", 7}, {"b/t.glb", 8}}), result({{"c/t.glb", 8}})}) ==
        Titles{"a/t.glb, orbit 1", "b/t.glb, orbit 2"});
  // Rows that nothing else tells apart say which results they are from.
  const std::vector<ordered_json> twice{result({{"t.glb", 7}}), result({{"t.glb", 7}})};
  const DocumentSection section = bench_section_of_all(twice);
  CHECK(std::get<std::string>(value(table(section, "bench-frame-1"), 1, "strategy")) == "s, results 2");
  CHECK(section.paragraphs.at(1).starts_with("Results 1, 2: "));
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
