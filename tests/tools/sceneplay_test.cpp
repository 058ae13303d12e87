// sceneplay as a person runs it: pictures, their names and forms, the report, and every kind of wrong call.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "scene/gltf/write.h"
#include "tests/render/render_support.h"
#include "tests/tools/process.h"
#include "tools/frame_times.h"

using namespace scenegen;
using namespace scenegen::test;
using tools::film_times;
using tools::parse_times;

namespace {

ProcessResult play(const std::string& line, const ProcessOptions& options = {}) {
  return run(SCENEPLAY_PROGRAM, words(line), options);
}

std::string wall_file(const TemporaryFolder& folder) {
  std::string path = folder.file("wall.glb");
  REQUIRE(gltf::write(render::test::wall_scene(), path, {}));
  return path;
}

}  // namespace

TEST_CASE("times: seconds, percentages, ranges") {
  CHECK(parse_times("1.5,50%,0", 8).value() == std::vector<double>{1.5, 4, 0});
  CHECK(parse_times("2:4:0.5", 8).value() == std::vector<double>{2, 2.5, 3, 3.5, 4});
  CHECK(parse_times("0:100%:25%", 8).value() == std::vector<double>{0, 2, 4, 6, 8});
  CHECK(parse_times("0:1:0.1", 8).value().size() == 11);
  CHECK(parse_times("4:2.2:0.5", 8).value() == std::vector<double>{4, 3.5, 3, 2.5});  // backwards
  // Keys are float32, and what is asked for must meet the key of that name.
  CHECK(parse_times("0.1", 8).value() == std::vector<double>{static_cast<double>(0.1F)});
  CHECK(parse_times("7.93", static_cast<double>(7.93F)).value() ==
        std::vector<double>{static_cast<double>(7.93F)});
  CHECK(parse_times("0:1:0.1", 8).value()[3] == static_cast<double>(0.3F));
  for (const char* wrong : {"", ",", "1,,2", "a", "-1", "101%", "9", "nan", "inf", "1:2", "1:2:0", "2:1:0",
                            "1:2:3:4", "0:8:1e-9"}) {
    INFO(wrong);
    const auto times = parse_times(wrong, 8);
    REQUIRE_FALSE(times);
    CHECK(times.error().kind == ErrorKind::usage);
  }
  CHECK(film_times(10, 0.4, 8).value() == std::vector<double>{0, 2, 4, 6, 8});
  CHECK(film_times(1, 0.1, 8).value() == std::vector<double>{8});
  CHECK_FALSE(film_times(10000, 1e6, 8));
}

TEST_CASE("moments are dates too where the file has a calendar") {
  scenegen::Calendar calendar;
  calendar.start = "2024-03-01";
  calendar.seconds_per_day = 0.5;
  const double end_s = 10;  // 2024-03-21
  const auto times = [&](const char* text) {
    const auto parsed = parse_times(text, end_s, &calendar);
    if (!parsed) FAIL(parsed.error().str());
    return *parsed;
  };
  using Times = std::vector<double>;
  CHECK(times("2024-03-01") == Times{0});
  CHECK(times("2024-03-03T12:00,2024-03-21,50%,1.5") == Times{1.25, 10, 5, 1.5});
  CHECK(times("2024-03-02T12:00:00") == Times{0.75});
  CHECK(times("2024-03-01:2024-03-21:7d") == Times{0, 3.5, 7});
  CHECK(times("2024-03-01T12:00:2024-03-02T12:00:6h") == Times{0.25, 0.375, 0.5, 0.625, 0.75});
  CHECK(times("2024-03-11:100%:2.5") == Times{5, 7.5, 10});
  const std::map<const char*, const char*> wrong{
      {"2024-03-22", "'2024-03-22' is after the end of the timeline, 2024-03-21 (10 s)"},
      {"2024-02-29", "'2024-02-29' is before the timeline begins, 2024-03-01"},
      {"2024-02-30", "'2024-02-30': February 2024 has 29 days"},
      {"2024-03-0x", "'2024-03-0x': wanted a date YYYY-MM-DD, with a time YYYY-MM-DDTHH:MM"},
      {"2024-03-01:2024-03-21", "'2024-03-01:2024-03-21' is no FROM:TO:STEP"},
      {"2024-03-01:2024-03-21:0d", "the step of '2024-03-01:2024-03-21:0d' must be above 0"},
      {"0:5:1y",
       "'1y': wanted a duration: a number of days, or with a unit w, d, h or min (5, 2w, 8h, PT8H)"}};
  for (const auto& [text, line] : wrong) {
    const auto parsed = parse_times(text, end_s, &calendar);
    REQUIRE_FALSE(parsed);
    CHECK(parsed.error().kind == scenegen::ErrorKind::usage);
    CHECK(parsed.error().str() == line);
  }
  CHECK(parse_times("2024-03-01", 8).error().str() ==
        "'2024-03-01': the file has no calendar (scenegen schedule makes files that have)");
  CHECK(parse_times("0:5:1d", 8).error().str() ==
        "'1d': the file has no calendar (scenegen schedule makes files that have)");
}

TEST_CASE("frames: dates of a file with a calendar, and without one") {
  const TemporaryFolder folder;
  scenegen::Scene scene = render::test::wall_scene();
  scenegen::Calendar calendar;
  calendar.start = "2024-03-01";
  calendar.seconds_per_day = static_cast<double>(scene.duration_s) / 8;
  scene.info.calendar = calendar;
  const std::string file = folder.file("calendar.glb");
  REQUIRE(gltf::write(scene, file, {}));
  const std::string to = " -o " + folder.file("out") + " --size 32x32 --report " + folder.file("r.json");
  REQUIRE(play("frames " + file + to + " --times 2024-03-01:2024-03-09:4d,2024-03-02T12:00").code == 0);
  const auto report = nlohmann::json::parse(read_file(folder.file("r.json")));
  REQUIRE(report["frames"].size() == 4);
  CHECK(report["frames"][1]["date"] == "2024-03-05");
  CHECK(report["frames"][3]["date"] == "2024-03-02T12:00:00");
  check_error(play("frames " + wall_file(folder) + to + " --times 0 --show-nodes --strategy hi-z"), 2,
              "--show-nodes: 'hi-z' keeps no nodes; allowed: octree, queries-all, queries, adaptive");
  check_error(play("frames " + wall_file(folder) + to + " --times 0 --late-visibility"), 2,
              "--late-visibility: 'inline' draws the same with and without it; allowed: queries-all");
  check_error(play("frames " + wall_file(folder) + to + " --times 2024-03-01"), 2,
              "--times: '2024-03-01': the file has no calendar (scenegen schedule makes files that have)");
}

TEST_CASE("frames: files, names, report and the line at the end") {
  const TemporaryFolder folder;
  const std::string file = wall_file(folder);
  const std::string out = folder.file("deep/out");
  const auto result =
      play("frames " + file + " -o " + out + " --size 64x36 --times 0,50%,100% --ids --depth --report " +
           folder.file("r.json"));
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK(result.err.empty());
  CHECK_THAT(result.out,
             Catch::Matchers::Contains("3 frames  64x36") && Catch::Matchers::Contains("48 objects"));
  for (const char* name : {"frame_00000.png", "frame_00002.png", "ids_00001.png"})
    CHECK(read_file(out + "/" + name).starts_with("\x89PNG"));
  CHECK(read_file(out + "/depth_00002.pfm").starts_with("Pf\n64 36\n-1.0\n"));
  const auto report = nlohmann::json::parse(read_file(folder.file("r.json")));
  CHECK(report["schema"] == "sceneplay/frames");
  CHECK(report["version"] == 1);
  REQUIRE(report["frames"].size() == 3);
  std::uint64_t own = 0;
  std::uint64_t on_device = 0;  // lavapipe has no other memory
  for (const auto& [kind, bytes] : report["memory"].items()) {
    const bool other = kind == "geometry" || kind == "textures" || kind == "targets" || kind == "readback";
    own += other ? 0 : bytes["hostBytes"].get<std::uint64_t>() + bytes["deviceBytes"].get<std::uint64_t>();
    on_device += bytes["deviceBytes"].get<std::uint64_t>();
    CHECK(bytes["spilledBytes"] == 0);
  }
  CHECK(report["ownBytes"] == own);
  CHECK(report["bytesPerObject"].get<double>() == Approx(static_cast<double>(own) / 48));
  if (report["device"]["type"] == "CPU") CHECK(report["deviceBytes"] == on_device);
  CHECK(report["memory"]["targets"]["deviceBytes"].get<std::uint64_t>() >= 64 * 36 * 4);
  CHECK(report["frames"][0]["visible"] == 4);
  CHECK(report["frames"][2]["visible"] == 48);
  CHECK(report["frames"][1]["timeS"].get<double>() == Approx(report["frames"][2]["timeS"].get<double>() / 2));
  for (const char* stage :
       {"seek", "update", "cull", "record", "submit", "wait", "gpu", "readback", "encode"})
    CHECK(report["frames"][1]["stagesMs"].contains(stage));
  // The same call gives the same bytes.
  const auto again =
      play("frames " + file + " -o " + folder.file("again") + " --size 64x36 --times 0,50%,100% --quiet");
  CHECK(again.code == 0);
  CHECK(again.out.empty());
  for (const char* name : {"frame_00000.png", "frame_00001.png", "frame_00002.png"})
    CHECK(read_file(out + "/" + name) == read_file(folder.file("again") + "/" + name));
  // A report on stdout is all there is on it.
  const auto piped =
      play("frames " + file + " -o " + folder.file("piped") + " --size 64x36 --times 0 --memory --report -");
  CHECK(piped.code == 0);
  CHECK(nlohmann::json::parse(piped.out)["frames"].size() == 1);
  CHECK_THAT(piped.err,
             Catch::Matchers::Contains("1 frame  64x36") && Catch::Matchers::Contains("B an object"));
}

TEST_CASE("frames: what adaptive took, why, and what every way should take") {
  const TemporaryFolder folder;
  const std::string call = "frames " + wall_file(folder) + " -o " + folder.file("out") +
                           " --size 64x36 --times 0,50%,100% --quiet --calibration none --report " +
                           folder.file("r.json");
  const auto result = play(call + " --strategy adaptive --no-correction");
  INFO(result.err);
  REQUIRE(result.code == 0);
  for (const auto& frame : nlohmann::json::parse(read_file(folder.file("r.json")))["frames"]) {
    CHECK(frame["strategyUsed"] == "inline");  // three frames are too few to change anything
    CHECK_THAT(frame["reason"].get<std::string>(),
               Catch::Matchers::StartsWith("inline: ") && Catch::Matchers::Contains(" ms against "));
    CHECK(frame["sidesMs"].size() == 2);
    REQUIRE(frame["predicted"].size() == 8);
    CHECK(frame["predicted"][1]["name"] == "inline");
    for (const auto& way : frame["predicted"]) CHECK(way["totalMs"].get<double>() > 0);
    CHECK(frame["stagesMs"]["choose"].get<double>() >= 0);
  }
  // Others choose nothing, and are predicted all the same.
  REQUIRE(play(call + " --strategy octree").code == 0);
  const auto frame = nlohmann::json::parse(read_file(folder.file("r.json")))["frames"][2];
  CHECK(frame["strategyUsed"] == "octree");
  CHECK(!frame.contains("reason"));
  CHECK(frame["predicted"].size() == 8);
}

TEST_CASE("frames: film, forms, camera path, clean under validation") {
  const TemporaryFolder folder;
  const std::string file = wall_file(folder);
  write_file(folder.file("path.json"), R"({"keys":[{"time_s":0,"eye_m":[0,2,9],"target_m":[0,1,0]}]})");
  const auto jpg = play("frames " + file + " -o " + folder.file("jpg") +
                        " --size 32x18 --fps 4 --duration 1 --format jpg " + "--camera-path " +
                        folder.file("path.json") + " --validation on --samples 1");
  INFO(jpg.err);
  CHECK(jpg.code == 0);
  CHECK(read_file(folder.file("jpg/frame_00004.jpg")).starts_with("\xFF\xD8"));
  const auto bmp = play("frames " + file + " -o " + folder.file("bmp") +
                        " --size 32x18 --times 0 --format bmp --shadows off "
                        "--strategy brute --barriers full --camera auto");
  CHECK(bmp.code == 0);
  CHECK(read_file(folder.file("bmp/frame_00000.bmp")).starts_with("BM"));
}

TEST_CASE("a built-in camera path, and the file that is written of it, give the same pictures") {
  const TemporaryFolder folder;
  const std::string file = wall_file(folder);
  const auto saved = play("camera-path " + file + " fly -o " + folder.file("fly.json"));
  INFO(saved.err);
  REQUIRE(saved.code == 0);
  CHECK_THAT(saved.out, Catch::Matchers::Contains("7 keys  0 to "));
  const std::string draw = "frames " + file + " --size 32x18 --shadows off -q --times 20%,70% --camera-path ";
  REQUIRE(play(draw + "fly -o " + folder.file("a")).code == 0);
  REQUIRE(play(draw + folder.file("fly.json") + " -o " + folder.file("b")).code == 0);
  for (const char* name : {"/frame_00000.png", "/frame_00001.png"})
    CHECK(read_file(folder.file("a") + name) == read_file(folder.file("b") + name));
  CHECK(read_file(folder.file("a/frame_00000.png")) != read_file(folder.file("a/frame_00001.png")));
  // A path of a file is written in the same form again.
  const auto again = play("camera-path " + file + " " + folder.file("fly.json") + " -o -");
  CHECK(again.out == read_file(folder.file("fly.json")));
  check_error(play("camera-path " + file + " orbti -o x"), 2, "did you mean 'orbit'");
  check_error(play("camera-path " + file + " orbit"), 2, "--output");
  check_error(play("camera-path " + file + " orbit -o " + file), 2, "would overwrite");
  check_error(play("camera-path " + folder.file("none.glb") + " orbit -o " + folder.file("x")), 3,
              "none.glb");
  CHECK_FALSE(std::filesystem::exists(folder.file("x")));
}

TEST_CASE("wrong calls: one line and the right exit code") {
  const TemporaryFolder folder;
  const std::string file = wall_file(folder);
  const std::string start = "frames " + file + " -o " + folder.file("out") + " --size 16x9 ";
  check_error(play("frames " + file), 2, "--output: missing");
  check_error(play("frames -o x"), 2, "FILE");
  check_error(play(start + "--size 0x9"), 2, "--size");
  check_error(play(start + "--size 99999x9"), 2, "--size");
  check_error(play(start + "--times 101%"), 2, "--times: ");
  check_error(play(start + "--times 99"), 2, "--times: '99' is after the end");
  check_error(play(start + "--times 0 --fps 25"), 2, "--times");
  check_error(play(start + "--fps 0"), 2, "--fps");
  check_error(play(start + "--fps 10000 --duration 1000000"), 2, "--fps");
  check_error(play(start + "--camera front"), 2, "--camera");
  check_error(play(start + "--camera auto --camera-path x"), 2, "--camera");
  check_error(play(start + "--camera-path " + folder.file("none.json")), 3, "none.json");
  check_error(play(start + "--camera-path " + file), 1, "wall.glb");
  check_error(play(start + "--camera-path wlak"), 2, "did you mean 'walk'");
  check_error(play(start + "--strategy inlin"), 2, "inline");
  check_error(play(start + "--samples 2"), 2, "--samples");
  check_error(play(start + "--format gif"), 2, "--format");
  check_error(play(start + "--device nonesuch"), 2, "--device");
  check_error(play(start + "--nonesuch"), 2, "--nonesuch");
  check_error(play("frames " + folder.file("none.glb") + " -o " + folder.file("out")), 3, "none.glb");
  check_error(play("frams x"), 2, "frames");
  check_error(play(file), 2, "sceneplay frames");
  write_file(folder.file("broken.glb"), "glTF and nothing");
  check_error(play("frames " + folder.file("broken.glb") + " -o " + folder.file("out")), 1, "broken.glb");
  CHECK(folder.entries() == std::vector<std::string>{"broken.glb", "wall.glb"});
  write_file(folder.file("taken"), "");
  check_error(play("frames " + file + " -o " + folder.file("taken")), 3, "taken");
}

TEST_CASE("no Vulkan device is exit code 4, devices are listed") {
  const TemporaryFolder folder;
  const std::string file = wall_file(folder);
  const auto listed = play("--list-devices");
  CHECK(listed.code == 0);
  CHECK(listed.out.starts_with("0  "));
  ::setenv("VK_ICD_FILENAMES", "/nonexistent.json", 1);
  ::setenv("VK_DRIVER_FILES", "/nonexistent.json", 1);
  check_error(play("frames " + file + " -o " + folder.file("out")), 4, "Vulkan");
  ::unsetenv("VK_ICD_FILENAMES");
  ::unsetenv("VK_DRIVER_FILES");
}

TEST_CASE("a full disk leaves no half a picture") {
  const TemporaryFolder folder;
  const std::string file = wall_file(folder);
  ProcessOptions full;
  full.most_file_bytes = 1000;
  const auto result =
      play("frames " + file + " -o " + folder.file("out") + " --size 64x36 --times 100%", full);
  CHECK(result.code == 3);
  CHECK_FALSE(std::filesystem::exists(folder.file("out/frame_00000.png")));
}

TEST_CASE("frames: pictures of an earlier, longer run do not stay among the new ones") {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  const std::string call = "frames " + wall_file(folder) + " -o " + out + " --size 16x9 --fps 10 --duration ";
  REQUIRE(play(call + "0.5 --ids --depth").code == 0);
  for (const char* other :
       {"frame_0.png", "frame_00009.txt", "frame_00009.png.bak", "frame_000009.png", "notes.md"})
    write_file(out + "/" + other, "mine");
  const std::string before = read_file(out + "/frame_00005.png");
  const auto shorter = play(call + "0.2 --ids");
  CHECK(shorter.code == 0);
  CHECK(shorter.err == "note: removed 12 pictures of an earlier run from " + out + "\n");
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(out))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  CHECK(names == std::vector<std::string>{"frame_0.png", "frame_00000.png", "frame_000009.png",
                                          "frame_00001.png", "frame_00002.png", "frame_00009.png.bak",
                                          "frame_00009.txt", "ids_00000.png", "ids_00001.png",
                                          "ids_00002.png", "notes.md"});
  // Another form leaves none of the old one; a run that fails takes nothing away.
  REQUIRE(play(call + "0.1 --format bmp --quiet").err.empty());
  CHECK_FALSE(std::filesystem::exists(out + "/frame_00001.png"));
  CHECK(std::filesystem::exists(out + "/frame_00001.bmp"));
  check_error(play(call + "0 --camera nobody"), 2, "");
  CHECK(std::filesystem::exists(out + "/frame_00001.bmp"));
}

TEST_CASE(
    "frames: reports that cannot be written are refused before the work, or said to be all that is missing") {
  const TemporaryFolder folder;
  const std::string file = wall_file(folder);
  const std::string call = "frames " + file + " -o " + folder.file("out") + " --size 16x9 --times 0 ";
  check_error(play(call + "--report " + folder.file("no/r.json")), 3,
              "no/r.json: cannot be written: No such file");
  check_error(play(call + "--trace " + folder.file("no/t.csv")), 3, "no/t.csv: cannot be written");
  check_error(play(call + "--report " + file), 2, "--report: would overwrite");
  check_error(play(call + "--report " + folder.file("x.json") + " --trace " + folder.file("x.json")), 2,
              "--trace: would overwrite");
  check_error(play(call + "--report " + folder.file("out/deeper/r.json")), 3, "deeper/r.json");
  CHECK(folder.entries() == std::vector<std::string>{"wall.glb"});
  REQUIRE(
      play(call + "--quiet --report " + folder.file("out/r.json") + " --trace " + folder.file("out/t.csv"))
          .code == 0);
  CHECK(read_file(folder.file("out/r.json")).starts_with("{"));
  std::filesystem::remove_all(folder.file("out"));
  check_error(play(call + "--report /dev/full"), 3,
              "/dev/full: cannot be written: No space left on device; the pictures in");
  CHECK(std::filesystem::exists(folder.file("out/frame_00000.png")));
}
