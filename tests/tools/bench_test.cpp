// sceneplay bench: what it measures, keeps, resumes and refuses; and the arithmetic of its summaries.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "tests/render/render_support.h"
#include "tests/tools/process.h"
#include "timeline/compare.h"
#include "tools/bench_clock.h"
#include "tools/bench_results.h"
#include "tools/bench_scenes.h"
#include "tools/trace.h"

using namespace scenegen;
using namespace scenegen::test;
using namespace scenegen::tools;

namespace {

ProcessResult play(const std::string& line, const ProcessOptions& options = {}) {
  return run(SCENEPLAY_PROGRAM, words(line), options);
}

std::string wall_file(const TemporaryFolder& folder, const std::string& name = "wall.glb") {
  const std::string path = folder.file(name);
  REQUIRE(gltf::write(render::test::wall_scene(), path, {}));
  return path;
}

/// Bytes of the single runs by name.
std::map<std::string, std::string> runs_in(const std::string& folder) {
  std::map<std::string, std::string> out;
  if (!std::filesystem::exists(folder + "/runs")) return out;
  for (const auto& entry : std::filesystem::directory_iterator(folder + "/runs")) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".run.json")) out[name] = read_file(entry.path().string());
  }
  return out;
}

nlohmann::json results(const std::string& folder) {
  return nlohmann::json::parse(read_file(folder + "/bench.json"));
}

std::size_t line_count(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("summaries and intervals") {
  const Summary s = summarize({4, 1, 2, 3, 10});
  CHECK(s.mean == 4);
  CHECK(s.median == 3);
  CHECK(s.min == 1);
  CHECK(s.p95 == Approx(8.8));  // 0.8 of the way from the 4th to the 5th
  CHECK_FALSE(interval95({5}));
  // Mean 2, deviation 1, three samples: 4.303 / sqrt(3).
  CHECK(interval95({1, 2, 3})->low == Approx(2 - 4.303 / std::sqrt(3.0)));
  CHECK(interval95({1, 2, 3})->high == Approx(2 + 4.303 / std::sqrt(3.0)));
  CHECK(interval95(std::vector<double>(100, 7.0))->low == Approx(7));
}

TEST_CASE("frames walk the moments to and fro") {
  std::vector<std::size_t> walked;
  for (std::int64_t i = -4; i < 7; ++i) walked.push_back(moment_of_frame(i, 4));
  CHECK(walked == std::vector<std::size_t>{2, 3, 2, 1, 0, 1, 2, 3, 2, 1, 0});
  CHECK(moment_of_frame(-3, 1) == 0);
  CHECK(moment_of_frame(5, 1) == 0);
}

TEST_CASE("ways of drawing are read with their modifiers") {
  const auto ways = parse_ways("inline,octree:n=100,queries-all:late");
  REQUIRE(ways);
  REQUIRE(ways->size() == 3);
  CHECK_FALSE((*ways)[0].octree_n);
  CHECK((*ways)[1].strategy == "octree");
  CHECK((*ways)[1].octree_n == 100);
  CHECK((*ways)[2].late);
  CHECK(parse_ways("octre").error().str().find("did you mean 'octree'") != std::string::npos);
  CHECK(parse_ways("octree:late").error().str().find("draws the same with and without ':late'") !=
        std::string::npos);
  CHECK(parse_ways("octree:lat").error().str().find("did you mean 'late'") != std::string::npos);
  for (const char* wrong : {"", "inline,", "inline,inline", "octree:n=0", "octree:n=x", "octree:"}) {
    INFO(wrong);
    CHECK_FALSE(parse_ways(wrong));
  }
}

TEST_CASE("bench: cases, runs, counters and both files") {
  const TemporaryFolder folder;
  const std::string out = folder.file("deep/out");
  test::write_file(folder.file("path.json"), R"({"keys":[{"time_s":0,"eye_m":[0,2,9],"target_m":[0,1,0]}]})");
  test::write_file(folder.file("far.json"), R"({"keys":[{"time_s":0,"eye_m":[0,9,30],"target_m":[0,1,0]}]})");
  const auto result = play("bench " + wall_file(folder) + " -o " + out +
                           " --strategy inline,octree:n=10:secondaries --frames 6 --repeat 2 --warm-up 3 "
                           "--size 32x18 --shadows off"
                           " --frames-in-flight 1,3 --validation on --trace " +
                           folder.file("trace.csv") + " --camera-path " + folder.file("path.json") +
                           " --camera-path " + folder.file("far.json"));
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK(result.err.empty());
  CHECK_THAT(result.out,
             Catch::Matchers::Contains("vs best") && Catch::Matchers::Contains("octree:n=10:secondaries"));
  CHECK(runs_in(out).size() == 2 * 2 * 2 * 2);
  const nlohmann::json bench = results(out);
  CHECK(bench["schema"] == "sceneplay/bench");
  CHECK(bench["version"] == 2);
  REQUIRE(bench["devices"].size() == 1);
  CHECK_FALSE(bench["devices"][0]["driver"].get<std::string>().empty());
  CHECK(bench["settings"]["renderers"] == "fresh");
  REQUIRE(bench["scenes"].size() == 1);
  CHECK(bench["scenes"][0]["objects"] == 48);
  CHECK(bench["scenes"][0]["loadMs"].get<double>() > 0);
  CHECK(bench["machine"]["cores"] >= 1);
  REQUIRE(bench["cases"].size() == 8);
  for (std::size_t i = 0; i < 8; i += 2) {
    const nlohmann::json& by_inline = bench["cases"][i];
    const nlohmann::json& by_octree = bench["cases"][i + 1];
    CHECK(by_inline["framesInFlight"] == (i % 4 == 0 ? 1 : 3));
    CHECK(by_octree["strategy"] == "octree:n=10:secondaries");
    CHECK(by_inline["frames"] == 6);
    CHECK(by_inline["repetitions"] == 2);
    CHECK(by_inline["frameMs"]["runs"].size() == 2);
    CHECK(std::min(by_inline["vsBest"].get<double>(), by_octree["vsBest"].get<double>()) == 1.0);
    CHECK(by_inline["frameMs"]["min"].get<double>() > 0);
    CHECK(by_inline["frameMs"]["low"] <= by_inline["frameMs"]["mean"]);
    CHECK(by_inline["totalMs"].get<double>() == Approx(6 * by_inline["frameMs"]["mean"].get<double>()));
    // The renderer's stages run on a thread of this process; a software device adds to it.
    CHECK(by_inline["processCpuMs"]["min"].get<double>() > 0);
    CHECK(by_inline["stagesMs"]["seek"]["mean"].get<double>() >= 0);
    CHECK(by_inline["device"] == bench["devices"][0]["name"]);
    CHECK(by_inline["frameMs"]["p25"] <= by_inline["frameMs"]["median"]);
    CHECK(by_inline["frameMs"]["median"] <= by_inline["frameMs"]["p75"]);
    CHECK(by_inline["startMs"].get<double>() > 0);
    CHECK(by_inline["overTime"]["timeS"].size() == 6);
    CHECK(by_inline["overTime"]["timeS"][0] == 0);
    CHECK(by_inline["overTime"]["frameMs"].size() == 6);
    // Counters are those of the measured moments alone, and the same whatever was drawn before.
    CHECK(by_inline["sameCounters"] == true);
    CHECK(by_octree["sameCounters"] == true);
    CHECK(by_inline["counters"]["visible"] == by_octree["counters"]["visible"]);
    CHECK(by_inline["counters"]["changed"].get<double>() > 5);
    CHECK(by_inline["counters"]["secondaries"] == 0);
    CHECK(by_octree["counters"]["secondaries"].get<double>() > 1);
    CHECK(by_inline["objects"] == 48);
  }
  const std::string trace = read_file(folder.file("trace.csv"));
  CHECK(line_count(trace) == 1 + 6 * 16);
  CHECK(trace.starts_with(
      "file,device,camera,framesInFlight,repetition,timeS,eyeM.x,eyeM.y,eyeM.z,forward.x,"));
  const std::string csv = read_file(out + "/bench.csv");
  CHECK(line_count(csv) == 9);
  CHECK(csv.starts_with("file,device,camera,framesInFlight,strategy,objects,"));
  CHECK(csv.find(",frameMs.mean,") != std::string::npos);
  CHECK(csv.find(",processCpuMs.mean,") != std::string::npos);
  CHECK(csv.find(",counters.draws,") != std::string::npos);
}

TEST_CASE("a trace has a row a frame, with shares that are counted") {
  const TemporaryFolder folder;
  const std::string call = "frames " + wall_file(folder) + " -o " + folder.file("out") +
                           " --size 32x18 --shadows off --times 0:4:0.5 --ids --strategy octree --octree-n 4 "
                           "--node-form secondaries --camera auto --quiet ";
  REQUIRE(play(call + "--trace " + folder.file("out/t.json") + " --report " + folder.file("r.json")).code ==
          0);
  REQUIRE(play(call + "--trace " + folder.file("t.csv")).code == 0);
  const auto trace = nlohmann::json::parse(read_file(folder.file("out/t.json")));
  const auto frames = nlohmann::json::parse(read_file(folder.file("r.json")))["frames"];
  CHECK(trace["schema"] == "sceneplay/trace");
  REQUIRE(trace["frames"].size() == 9);
  double least = 1, most = 0;
  for (std::size_t i = 0; i < 9; ++i) {
    const nlohmann::json& row = trace["frames"][i];
    INFO(i << " " << row.dump());
    CHECK(row["timeS"] == frames[i]["timeS"]);
    CHECK(row["strategy"] == "octree");
    CHECK(row["changed"] == frames[i]["changed"]);
    CHECK(row["choiceLeftMs"].is_null());
    CHECK(row["predicted"].size() > 4);
    CHECK(row["dAnim"].get<double>() == Approx(row["changed"].get<double>() / 48));
    const double forward = std::hypot(row["forward"]["x"].get<double>(), row["forward"]["y"].get<double>(),
                                      row["forward"]["z"].get<double>());
    CHECK(forward == Approx(1).epsilon(1e-4));
    CHECK(row["eyeM"]["y"].get<double>() > 0);
    CHECK(row["chunks"].get<double>() * 2 == row["secondaries"]);  // colour; ids
    const double alpha = row["alphaN"].get<double>();
    CHECK(alpha == Approx(row["recorded"].get<double>() / row["secondaries"].get<double>()));
    least = std::min(least, alpha);
    most = std::max(most, alpha);
  }
  CHECK(most == 1);  // the first frame
  CHECK(least < 1);
  const std::string csv = read_file(folder.file("t.csv"));
  CHECK(line_count(csv) == 10);
  CHECK(csv.find(",alphaN,dAnim,") != std::string::npos);
  CHECK(csv.find(",stagesMs.seek,") != std::string::npos);
  CHECK(csv.find(",predicted.inline.totalMs,") != std::string::npos);
  const auto wrong = play(call + "--trace " + folder.file("t.txt"));
  CHECK(wrong.code == 2);
  CHECK_THAT(wrong.err, Catch::Matchers::Contains("--trace"));
}

TEST_CASE("entries of lists become columns by their name") {
  const auto rows = nlohmann::ordered_json::parse(
      R"([{"a":1,"of":[{"name":"x","ms":2},{"name":"y","ms":3}],"plain":[1,2]},{"a":4,"b":{"c":"d,e"}}])");
  CHECK(flat_csv(rows) == "a,of.x.ms,of.y.ms,b.c\n1,2,3,\n4,,,\"d,e\"\n");
}

TEST_CASE("bench --resume measures what is missing and nothing else") {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  const std::string call = "bench " + wall_file(folder) + " -o " + out +
                           " --frames 4 --warm-up 2 --size 32x18 --shadows off --quiet --repeat 2 ";
  REQUIRE(play(call + "--strategy inline,octree").code == 0);
  const auto before = runs_in(out);
  REQUIRE(before.size() == 4);
  const auto [gone, kept] = std::pair(before.begin()->first, std::next(before.begin())->first);
  std::filesystem::remove(out + "/runs/" + gone);
  test::write_file(out + "/runs/" + kept, before.at(kept).substr(0, 200));  // cut off
  const auto resumed = play(call + "--strategy inline,octree,brute --resume");
  INFO(resumed.err);
  REQUIRE(resumed.code == 0);
  CHECK(resumed.out.empty());
  const auto after = runs_in(out);
  CHECK(after.size() == 6);
  CHECK(results(out)["cases"].size() == 3);
  for (const auto& [name, bytes] : before) {
    INFO(name);
    // Times of two measurements are never all equal.
    CHECK((after.at(name) == bytes) == (name != gone && name != kept));
  }
  // What was measured otherwise is not mixed in.
  const auto other = play(call + "--strategy inline --resume --samples 1");
  CHECK(other.code == 2);
  CHECK_THAT(other.err,
             Catch::Matchers::Contains("--resume") && Catch::Matchers::Contains("samples 4, now it is 1"));
  CHECK(runs_in(out) == after);
  // Without --resume everything is anew.
  REQUIRE(play(call + "--strategy inline").code == 0);
  CHECK(runs_in(out).size() == 2);
}

TEST_CASE("bench: a run that is interrupted keeps what it had measured") {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  const std::string call =
      "bench " + wall_file(folder) + " -o " + out +
      " --frames 40 --size 64x36 --shadows off --quiet --repeat 200 --strategy inline,octree";
  ProcessOptions options;
  options.interrupt = SIGINT;
  options.interrupt_when = [&] { return runs_in(out).size() >= 3; };
  const auto killed = play(call, options);
  CHECK(killed.signal == SIGINT);
  const auto kept = runs_in(out);
  CHECK(kept.size() >= 3);
  CHECK(kept.size() < 400);
  for (const auto& [name, bytes] : kept) CHECK(nlohmann::json::accept(bytes));
}

TEST_CASE("bench: what fails is named, and the rest is measured") {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  test::write_file(folder.file("broken.glb"), "glTF and nothing");
  const auto result = play("bench " + folder.file("broken.glb") + " " + wall_file(folder) + " -o " + out +
                           " --frames 3 --repeat 1 --size 32x18 --strategy inline");
  CHECK(result.code == 1);
  CHECK_THAT(result.err, Catch::Matchers::Contains("broken.glb"));
  CHECK(line_count(result.err) == 1);
  const nlohmann::json cases = results(out)["cases"];
  REQUIRE(cases.size() == 2);
  CHECK_THAT(cases[0]["error"].get<std::string>(), Catch::Matchers::Contains("broken.glb"));
  CHECK(cases[1]["frames"] == 3);
  CHECK(cases[1]["frameMs"]["low"].is_null());  // one run has no spread
  CHECK(line_count(read_file(out + "/bench.csv")) == 3);
}

#if !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)  // their shadow memory is larger than any limit
TEST_CASE("bench: a scene that does not fit is named, the rest is measured, and --resume takes it up again") {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  // 3.5 GB of positions, of which the disk holds nothing but the beginning.
  constexpr std::uint32_t kBytes = 3'500'000'000;
  std::string json = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":3500000000}]})";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string head = "glTF";
  const auto add = [&head](std::uint32_t word) {
    head.append(reinterpret_cast<const char*>(&word), sizeof(word));
  };
  for (const std::uint32_t word : {2U, static_cast<std::uint32_t>(28 + json.size() + kBytes),
                                   static_cast<std::uint32_t>(json.size()), 0x4E4F534AU})
    add(word);
  head += json;
  add(kBytes);
  add(0x004E4942);
  const std::string large = folder.file("large.glb");
  test::write_file(large, head);
  std::filesystem::resize_file(large, head.size() + kBytes);
  const std::string call =
      "bench " + large + " " + wall_file(folder) + " -o " + out +
      " --frames 3 --repeat 2 --size 32x18 --shadows off --strategy inline,brute --quiet";
  const ProcessResult result = play(call, {.most_memory_bytes = 3'000'000'000});
  CHECK(result.code == 1);
  CHECK(result.err == "error: " + large + ": not enough memory for what the file holds\n");
  const nlohmann::json cases = results(out)["cases"];
  REQUIRE(cases.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) CHECK(cases[i].contains(i < 2 ? "error" : "frameMs"));
  const auto before = runs_in(out);
  REQUIRE(before.size() == 4);
  wall_file(folder, "large.glb");  // now it fits
  const ProcessResult resumed = play(call + " --resume");
  INFO(resumed.err);
  CHECK(resumed.code == 0);
  const auto after = runs_in(out);
  CHECK(after.size() == 8);
  for (const auto& [name, bytes] : before) CHECK(after.at(name) == bytes);
  for (const auto& c : results(out)["cases"]) CHECK(c.contains("frameMs"));
}
#endif

TEST_CASE("bench: several devices, one of them missing") {
  const TemporaryFolder folder;
  const std::string out = folder.file("out");
  const auto result = play("bench " + wall_file(folder) + " -o " + out +
                           " --frames 3 --repeat 2 --size 32x18 --shadows off --strategy inline,brute"
                           " --device 0 --device nonesuch --device llvm --warm-up 2 --quiet");
  CHECK(result.code == 2);
  CHECK(line_count(result.err) == 1);
  CHECK_THAT(result.err, Catch::Matchers::Contains("nonesuch"));
  const nlohmann::json bench = results(out);
  REQUIRE(bench["devices"].size() == 3);
  const std::string name = bench["devices"][0]["name"];
  CHECK_THAT(bench["devices"][1]["error"].get<std::string>(), Catch::Matchers::Contains("nonesuch"));
  // The same card by another name is measured apart: that shows the noise.
  CHECK(bench["devices"][2]["name"] == name + " #2");
  REQUIRE(bench["cases"].size() == 6);
  for (std::size_t i = 0; i < 6; ++i) {
    const nlohmann::json& c = bench["cases"][i];
    CHECK(c["device"] == bench["devices"][i / 2]["name"]);
    CHECK(c.contains("error") == (i / 2 == 1));
    CHECK(c.contains("frameMs") == (i / 2 != 1));
  }
  CHECK(bench["cases"][0]["counters"] == bench["cases"][4]["counters"]);
}

TEST_CASE("bench: renderers of their own make counters repeat; kept ones remember") {
  const TemporaryFolder folder;
  const std::string call = "bench " + wall_file(folder) +
                           " --frames 12 --repeat 3 --size 32x18 --shadows off --warm-up 2 --quiet "
                           "--strategy octree:n=4:secondaries,queries-all:n=4 --calibration none ";
  REQUIRE(play(call + "-o " + folder.file("fresh")).code == 0);
  REQUIRE(play(call + "--renderers kept -o " + folder.file("kept")).code == 0);
  const nlohmann::json fresh = results(folder.file("fresh"))["cases"];
  const nlohmann::json kept = results(folder.file("kept"))["cases"];
  for (const nlohmann::json& c : fresh) CHECK(c["sameCounters"] == true);
  // The chunks that one run leaves are not those that a new tree has.
  CHECK((kept[0]["sameCounters"] == false || kept[1]["sameCounters"] == false));
}

TEST_CASE("bench: a still scene is seen from along its path") {
  const TemporaryFolder folder;
  const std::string file = folder.file("still.glb");
  Scene scene;
  for (int i = 0; i < 20; ++i) {
    const MeshId mesh = render::test::add_mesh(scene, render::test::box_geometry(),
                                               render::test::plain({0.5F, 0.5F, 0.5F, 1}));
    render::test::add_object(scene, "box" + std::to_string(i), mesh, {2.0F * static_cast<float>(i), 0.5F, 0});
  }
  REQUIRE(gltf::write(scene, file, {}));
  REQUIRE(
      play("bench " + file + " -o " + folder.file("out") +
           " --camera-path walk --frames 5 --repeat 1 --size 32x18 --shadows off --strategy inline --quiet "
           "--trace " +
           folder.file("t.json"))
          .code == 0);
  const auto rows = nlohmann::json::parse(read_file(folder.file("t.json")))["frames"];
  REQUIRE(rows.size() == 5);
  CHECK(rows[0]["eyeM"] != rows[1]["eyeM"]);
  CHECK(results(folder.file("out"))["cases"][0]["overTime"]["timeS"][4] == 10);
}

TEST_CASE("time left goes by the runs that took time") {
  CHECK_FALSE(seconds_left(4, 0, 0, 0, 0));
  CHECK(seconds_left(4, 0, 0, 1, 0.5) == Approx(7));  // 2 s a run, 3.5 runs left
  CHECK(seconds_left(2, 3, 6, 1, 0.5) == Approx(3));
  CHECK(seconds_left(0, 3, 6, 0, 0) == Approx(0));
}

TEST_CASE("scenes of --quick are those that scenegen makes with their arguments") {
  const TemporaryFolder folder;
  for (const BenchScene& quick : quick_scenes()) {
    INFO(quick.name);
    const auto scene = quick.load();
    REQUIRE(scene);
    std::vector<std::string> arguments = scene->info.arguments;
    arguments.insert(arguments.end(), {"-q", "-o", folder.file("s.glb")});
    REQUIRE(run(SCENEGEN_PROGRAM, arguments).code == 0);
    const auto read = gltf::read(folder.file("s.glb"), {});
    REQUIRE(read);
    const auto found = timeline::compare(*scene, read->scene);
    CHECK(found.times_compared > 100);
    CHECK(found.equal());
  }
}

TEST_CASE("bench: a disk that is full is said, and everything is measured all the same") {
  const TemporaryFolder folder;
  ProcessOptions full;
  full.most_file_bytes = 500;
  const auto result = play("bench " + wall_file(folder) + " -o " + folder.file("out") +
                               " --frames 3 --repeat 2 --size 32x18 --shadows off --strategy inline,brute",
                           full);
  CHECK(result.code == 3);
  CHECK(line_count(result.err) == 1);
  CHECK_THAT(result.out, Catch::Matchers::Contains("inline") && Catch::Matchers::Contains("brute"));
  CHECK_FALSE(std::filesystem::exists(folder.file("out/bench.json")));
  CHECK(std::filesystem::is_empty(folder.file("out/runs")));
}

TEST_CASE("bench: wrong calls") {
  const TemporaryFolder folder;
  const std::string file = wall_file(folder);
  const std::string start = "bench " + file + " -o " + folder.file("out") + " --size 16x9 ";
  const auto check_error = [&](const std::string& line, int code, const std::string& part) {
    const auto result = play(line);
    INFO(line << ": " << result.err);
    CHECK(result.code == code);
    CHECK(result.out.empty());
    CHECK(result.err.starts_with("error: "));
    CHECK(line_count(result.err) == 1);
    CHECK_THAT(result.err, Catch::Matchers::Contains(part));
  };
  check_error("bench -o x", 2, "--quick");
  check_error("bench " + file, 2, "--output");
  check_error(start + "--strategy inline,octre", 2, "did you mean 'octree'");
  check_error(start + "--frames-in-flight 0", 2, "--frames-in-flight");
  check_error(start + "--frames-in-flight 2,4", 2, "--frames-in-flight");
  check_error(start + "--repeat 0", 2, "--repeat");
  check_error(start + "--frames 3 --times 0", 2, "--times");
  check_error(start + "--camera auto --camera-path x", 2, "--camera");
  check_error(start + "--camera-path " + folder.file("none.json"), 3, "none.json");
  check_error(start + "--device nonesuch", 2, "--device");
  check_error("bench " + file + " -o " + file, 3, "wall.glb");
  CHECK_FALSE(std::filesystem::exists(folder.file("out")));
}
