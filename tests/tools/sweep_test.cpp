// scenegen sweep as a user meets it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/tools/process.h"

using namespace scenegen::test;
using nlohmann::ordered_json;

namespace {

constexpr const char* kConfig =
    R"({"building-size": "3x3", "floor-courses": 4, "floors": 1, "roof": ["none", "flat"], "cells": "4x4x4",
        "coherence": [1, 0.5, 0.25], "windows": false})";

ProcessResult sweep(const TemporaryFolder& folder, const std::string& line, ProcessOptions options = {}) {
  std::vector<std::string> arguments = words(line);
  arguments.insert(arguments.begin(), "sweep");
  options.folder = folder.path();
  return run(SCENEGEN_PROGRAM, arguments, options);
}

std::vector<std::string> entries(const std::string& folder) {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    out.push_back(entry.path().filename());
  std::sort(out.begin(), out.end());
  return out;
}

void check_equal(const std::string& a, const std::string& b) {
  REQUIRE(entries(a) == entries(b));
  for (const std::string& name : entries(a)) {
    INFO(name);
    CHECK((read_file(a + "/" + name) == read_file(b + "/" + name)));
  }
}

const std::vector<std::string> kFiles{"roof-none_coherence-1.glb",    "roof-none_coherence-0.5.glb",
                                      "roof-none_coherence-0.25.glb", "roof-flat_coherence-1.glb",
                                      "roof-flat_coherence-0.5.glb",  "roof-flat_coherence-0.25.glb"};

}  // namespace

TEST_CASE(
    "a sweep makes every combination, the last array fastest, with the same bytes for any thread count") {
  const TemporaryFolder folder;
  write_file(folder.file("s.json"), kConfig);
  const ProcessResult made = sweep(folder, "s.json -o a --threads 1");
  REQUIRE(made.code == 0);
  CHECK(made.err.starts_with("a/index.json  6 scenes  "));
  const ordered_json index = ordered_json::parse(read_file(folder.file("a/index.json")));
  CHECK(index["schema"] == "scenegen/sweep");
  CHECK(index["version"] == 1);
  CHECK(index["complete"] == true);
  CHECK(index["varied"] == ordered_json{"roof", "coherence"});
  CHECK(index["config"] == ordered_json::parse(kConfig));
  REQUIRE(index["scenes"].size() == 6);
  for (std::size_t i = 0; i < 6; ++i) {
    const ordered_json& scene = index["scenes"][i];
    INFO(kFiles[i]);
    CHECK(scene["file"] == kFiles[i]);
    CHECK(scene["parameters"]["roof"] == (i < 3 ? "none" : "flat"));
    const double coherence = std::vector{1.0, 0.5, 0.25}[i % 3];
    CHECK(scene["parameters"]["coherence"] == coherence);
    CHECK(scene["coherence"].get<double>() == Approx(coherence).margin(0.02));
    const std::string path = folder.file("a/" + kFiles[i]);
    CHECK(scene["bytes"] == std::filesystem::file_size(path));
    CHECK(run("/usr/bin/sha256sum", {path}).out.substr(0, 64) == scene["sha256"]);
    // It is what scenegen itself makes of these arguments.
    auto arguments = scene["arguments"].get<std::vector<std::string>>();
    arguments.insert(arguments.end(), {"-o", folder.file("one.glb"), "-q"});
    REQUIRE(run(SCENEGEN_PROGRAM, arguments).code == 0);
    CHECK((read_file(folder.file("one.glb")) == read_file(path)));  // bytes are not to be printed
    const auto inspected =
        ordered_json::parse(run(SCENEGEN_PROGRAM, {"inspect", path, "--format", "json"}).out);
    CHECK(inspected["objects"] == scene["objects"]);
    CHECK(inspected["triangles"] == scene["triangles"]);
    CHECK(inspected["moments"] == scene["moments"]);
  }
  REQUIRE(sweep(folder, "s.json -o b --threads 3 -q").code == 0);
  check_equal(folder.file("a"), folder.file("b"));
}

TEST_CASE("--resume keeps what is whole and makes the rest, also after a run was killed") {
  const TemporaryFolder folder;
  write_file(folder.file("s.json"), kConfig);
  REQUIRE(sweep(folder, "s.json -o a -q").code == 0);
  REQUIRE(sweep(folder, "s.json -o b -q").code == 0);
  std::filesystem::remove(folder.file("b/" + kFiles[1]));
  write_file(folder.file("b/" + kFiles[2]), read_file(folder.file("b/" + kFiles[2])) + "x");
  const auto before = std::filesystem::last_write_time(folder.file("b/" + kFiles[0]));
  CHECK(sweep(folder, "s.json -o b --resume").err.find("  4 kept  ") != std::string::npos);
  CHECK(std::filesystem::last_write_time(folder.file("b/" + kFiles[0])) == before);
  check_equal(folder.file("a"), folder.file("b"));
  // Other parameters under the same names are made anew.
  write_file(folder.file("t.json"),
             std::string(kConfig).replace(std::string(kConfig).find("4x4x4"), 5, "2x2x2"));
  CHECK(sweep(folder, "t.json -o b --resume").err.find("  0 kept  ") != std::string::npos);
  write_file(folder.file("b/index.json"), "{\"schema\": ");  // damaged
  CHECK(sweep(folder, "s.json -o b --resume").err.find("  0 kept  ") != std::string::npos);
  check_equal(folder.file("a"), folder.file("b"));

  ProcessOptions killed;
  killed.interrupt = SIGTERM;
  killed.interrupt_when = [&] { return std::filesystem::exists(folder.file("c/" + kFiles[1])); };
  (void)sweep(folder, "s.json -o c -q", killed);
  if (std::filesystem::exists(folder.file("c"))) {
    for (const std::string& name : entries(folder.file("c"))) CHECK(name.find(".tmp") == std::string::npos);
  }
  REQUIRE(sweep(folder, "s.json -o c --resume -q").code == 0);
  check_equal(folder.file("a"), folder.file("c"));
}

TEST_CASE("--dry-run lists scenes with their exact sizes and writes nothing") {
  const TemporaryFolder folder;
  write_file(folder.file("s.json"), kConfig);
  const ProcessResult listed = sweep(folder, "s.json -o a --dry-run --format csv");
  CHECK(listed.code == 0);
  CHECK_FALSE(std::filesystem::exists(folder.file("a")));
  REQUIRE(sweep(folder, "s.json -o a -q").code == 0);
  const ordered_json index = ordered_json::parse(read_file(folder.file("a/index.json")));
  for (const ordered_json& scene : index["scenes"]) {
    const std::string row = scene["file"].get<std::string>() + "," + scene["objects"].dump() + ",";
    const std::size_t at = listed.out.find(row);
    REQUIRE(at != std::string::npos);
    CHECK(listed.out.substr(at, listed.out.find('\n', at) - at).find("," + scene["bytes"].dump()) !=
          std::string::npos);
  }
}

TEST_CASE("a full disk ends a sweep in one line; what is done stays and is taken up again") {
  const TemporaryFolder folder;
  write_file(folder.file("s.json"),
             R"({"building-size": "3x3", "floors": [1, 4], "roof": "none", "layout": "nodes"})");
  REQUIRE(sweep(folder, "s.json -o a -q").code == 0);
  const auto small = std::filesystem::file_size(folder.file("a/floors-1.glb"));
  REQUIRE(std::filesystem::file_size(folder.file("a/floors-4.glb")) > small + 10'000);
  const ProcessResult full = sweep(folder, "s.json -o b", {.most_file_bytes = small + 5000});
  CHECK(full.code == 3);
  CHECK(full.err.starts_with("error: b/floors-4.glb: "));
  CHECK(full.err.ends_with("; 1 scene of 2 done, --resume goes on from there\n"));
  CHECK(entries(folder.file("b")) == std::vector<std::string>{"floors-1.glb", "index.json"});
  CHECK(ordered_json::parse(read_file(folder.file("b/index.json")))["complete"] == false);
  CHECK(sweep(folder, "s.json -o b --resume").err.find("  1 kept  ") != std::string::npos);
  check_equal(folder.file("a"), folder.file("b"));
}

TEST_CASE("a config that is no sweep is refused before anything is made") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& config, int code, const std::string& message) {
    write_file(folder.file("e.json"), config);
    const ProcessResult result = sweep(folder, "e.json -o e");
    INFO(config);
    CHECK(result.code == code);
    CHECK(result.err == "error: e.json" + message + "\n");
    CHECK_FALSE(std::filesystem::exists(folder.file("e")));
  };
  refused(R"({"coherenc": [1]})", 2, ": /coherenc/0: unknown option (did you mean 'coherence'?)");
  refused(R"({"coherence": [1, 2]})", 2, ": /coherence/1: 2 is out of range (0 to 1; nearest: 1)");
  refused(
      R"({"curve": "hilbet"})", 2,
      ": /curve: unknown value 'hilbet' (did you mean 'hilbert'? one of: hilbert, morton, row-prime, none)");
  refused(R"({"coherence": []})", 2, ": /coherence: is empty: no scene would be made");
  refused(R"({"coherence": [0.5, "0.50"]})", 2, ": /coherence/1: gives the same files as /coherence/0");
  refused(R"({"output": "x.glb"})", 2, ": /output: decides nothing of a scene's content");
  refused(R"({"seed": [[1]]})", 2, ": /seed/0: is neither text, nor a number, nor true or false");
  refused(R"({"curve": ["hilbert", "none"], "coherence": 0.5})", 2,
          ": /coherence: cannot be used with --curve none, which makes a static scene (in curve-none.glb)");
  refused("[1]", 1, ": is not a JSON object");
  ordered_json large;
  for (const char* name : {"seed", "floors", "extras"}) {
    for (int i = 1; i <= 300; ++i) large[name].push_back(i);
  }
  refused(large.dump(), 2, ": asks for 27 000 000 scenes; at most 10 000");
  CHECK(sweep(folder, "e.json").err == "error: --output: is missing (the folder that the scenes go to)\n");
  CHECK(sweep(folder, "gone.json -o e").err == "error: gone.json: cannot be read\n");
  write_file(folder.file("e.json"), "{}");
  CHECK(sweep(folder, "e.json -o e.json").err.starts_with("error: e.json: "));
}
