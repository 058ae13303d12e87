// sceneplay calibrate and --calibration as a person uses them: one measurement, kept, read back, refused,
// damaged.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "scene/gltf/write.h"
#include "tests/render/render_support.h"
#include "tests/tools/process.h"

using namespace scenegen;
using namespace scenegen::test;
using nlohmann::json;

namespace {

/// With the user's cache in a folder of the test's own.
ProcessResult play(const std::string& line, const std::string& cache) {
  const char* before = std::getenv("XDG_CACHE_HOME");
  const std::string kept = before != nullptr ? before : "";
  ::setenv("XDG_CACHE_HOME", cache.c_str(), 1);
  const ProcessResult result = run(SCENEPLAY_PROGRAM, words(line));
  before != nullptr ? ::setenv("XDG_CACHE_HOME", kept.c_str(), 1) : ::unsetenv("XDG_CACHE_HOME");
  return result;
}

std::string wall_file(const TemporaryFolder& folder) {
  const std::string path = folder.file("wall.glb");
  REQUIRE(gltf::write(render::test::wall_scene(), path, {}));
  return path;
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    out.push_back(entry.path().filename().string());
  std::sort(out.begin(), out.end());
  return out;
}

constexpr const char* kPictures = " --size 48x27 --samples 1 --shadows off";

}  // namespace

TEST_CASE("calibrate: kept in the cache, found there, taken as a file, refused for anything else") {
  const TemporaryFolder folder;
  const std::string cache = folder.file("cache");
  const std::string wall = wall_file(folder);
  const ProcessResult measured = play(std::string("calibrate --quick --show") + kPictures, cache);
  INFO(measured.err);
  REQUIRE(measured.code == 0);
  CHECK_THAT(measured.out, Catch::Matchers::Contains("recordS") && Catch::Matchers::Contains("T_0"));
  const std::vector<std::string> kept = names_in(cache + "/scenegen");
  REQUIRE(kept.size() == 1);  // and nothing half written beside it
  CHECK(kept[0].starts_with("calibration-"));
  CHECK(kept[0].ends_with("-48x27-1.json"));
  const std::string file = cache + "/scenegen/" + kept[0];
  CHECK_THAT(measured.err, Catch::Matchers::Contains(file));
  const std::string text = read_file(file);
  const json document = json::parse(text);
  CHECK(document["schema"] == "sceneplay/calibration");
  CHECK(document["size"] == json::array({48, 27}));
  CHECK(document["quick"] == true);

  const std::string frames =
      "frames " + wall + " -o " + folder.file("out") + " --times 50% --strategy queries --quiet";
  const std::string matching = frames + kPictures;
  const auto good = [&](const std::string& line) {
    const ProcessResult result = play(line, cache);
    INFO(line << ": " << result.err);
    CHECK(result.code == 0);
    CHECK(result.err.empty());
  };
  // Found: no note of another measurement, though notes are not silenced.
  const ProcessResult found = play(
      "frames " + wall + " -o " + folder.file("out") + " --times 50% --strategy queries" + kPictures, cache);
  CHECK(found.code == 0);
  CHECK(found.err.empty());
  good(matching + " --calibration " + file);
  good(matching + " --calibration none");
  good(frames + " --size 32x18 --calibration none");
  // For other pictures it is refused, with what differs.
  const std::string taken = " --calibration " + file;
  check_error(
      play(frames + " --size 49x27 --samples 1 --shadows off" + taken, cache), 1,
      file +
          ": was measured for pictures of 48x27, this is 49x27; measure with sceneplay calibrate --size "
          "49x27 --samples 1 --shadows off");
  check_error(play(frames + " --size 48x27 --samples 4 --shadows off" + taken, cache), 1,
              "--samples 1, this is --samples 4");
  check_error(play(frames + " --size 48x27 --samples 1 --shadows on" + taken, cache), 1,
              "--shadows off, this is --shadows on");
  // Damaged files are named with the place.
  const std::string bad = folder.file("bad.json");
  const auto damaged = [&](const std::function<void(json&)>& change, const std::string& part) {
    json changed = document;
    change(changed);
    write_file(bad, changed.dump());
    check_error(play(matching + " --calibration " + bad, cache), 1, bad + ": " + part);
  };
  damaged([](json& d) { d["deviceUuid"] = std::string(32, '7'); }, "was measured for device");
  damaged([](json& d) { d["driver"] = "another"; }, "was measured for driver 'another'");
  damaged([](json& d) { d["units"].erase("recordS"); }, "/units/recordS: is missing");
  damaged([](json& d) { d["units"]["recordS"] = -1; }, "/units/recordS");
  damaged([](json& d) { d["size"] = "48x27"; }, "/size");
  damaged([](json& d) { d["version"] = 99; }, "/version");
  damaged([](json& d) { d["schema"] = "something"; }, "/schema: must be 'sceneplay/calibration'");
  write_file(bad, text.substr(0, text.size() / 3));
  check_error(play(matching + " --calibration " + bad, cache), 1, bad + ": is damaged");
  check_error(play(matching + " --calibration " + folder.file("none.json"), cache), 3, "none.json");
  check_error(play(matching + " --calibration qick", cache), 2,
              "--calibration: no such file; unknown word 'qick' (did you mean 'quick'?");
  CHECK(names_in(cache + "/scenegen") == kept);  // all the while it stayed as it was
  CHECK(read_file(file) == text);
}

TEST_CASE("calibrate: what cannot be written is said before anything is measured, and leaves nothing") {
  const TemporaryFolder folder;
  const std::string cache = folder.file("cache");
  std::filesystem::create_directory(cache);
  write_file(cache + "/scenegen", "no folder");
  check_error(play("calibrate --quick --size 32x18", cache), 3, cache + "/scenegen: cannot be made");
  check_error(play("calibrate --quick --size 32x18 -o " + folder.file("no/c.json"), cache), 3, "no/c.json");
  check_error(play("calibrate --size 0x18", cache), 2, "--size");
  check_error(play("calibrate --samples 3", cache), 2, "--samples");
  check_error(play("calibrate --device nonesuch", cache), 2, "--device");
  CHECK(read_file(cache + "/scenegen") == "no folder");
}

TEST_CASE("frames: without a good calibration a quick one runs, says so, and is kept", "[.long]") {
  const TemporaryFolder folder;
  const std::string cache = folder.file("cache");
  const std::string call = "frames " + wall_file(folder) + " -o " + folder.file("out") +
                           " --times 50% --strategy queries" + kPictures;
  const ProcessResult first = play(call, cache);
  CHECK(first.code == 0);
  CHECK_THAT(first.err, Catch::Matchers::Contains("note: no calibration of this device for such pictures"));
  const std::vector<std::string> kept = names_in(cache + "/scenegen");
  REQUIRE(kept.size() == 1);
  const std::string file = cache + "/scenegen/" + kept[0];
  CHECK(play(call, cache).err.empty());
  // A damaged one is said to be, measured again and replaced; `quick` measures and keeps nothing.
  write_file(file, read_file(file).substr(0, 100));
  const ProcessResult again = play(call, cache);
  CHECK(again.code == 0);
  CHECK_THAT(again.err, Catch::Matchers::Contains("note: " + file + ": is damaged"));
  CHECK_THAT(again.err, Catch::Matchers::Contains("a quick calibration runs and replaces that"));
  CHECK(json::parse(read_file(file))["schema"] == "sceneplay/calibration");
  std::filesystem::remove_all(cache);
  CHECK(play(call + " --calibration quick", cache).code == 0);
  CHECK_FALSE(std::filesystem::exists(cache + "/scenegen"));
  // A cache that cannot be written is no reason to stop.
  write_file(cache + "/scenegen", "no folder");
  const ProcessResult nowhere = play(call, cache);
  CHECK(nowhere.code == 0);
  CHECK_THAT(nowhere.err, Catch::Matchers::Contains("note: not kept: "));
}
