// scenegen schedule as a user calls it: what plays afterwards, what is said, and that errors leave nothing
// behind.
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "scene/gltf/read.h"
#include "tests/support/gltf_text.h"
#include "tests/tools/process.h"
#include "timeline/calendar.h"
#include "timeline/player.h"

using namespace scenegen;
using namespace scenegen::test;

namespace {

constexpr const char* kNodes = R"(,"materials":[{"name":"brick"}],"scenes":[{"nodes":[0,4]}],
  "nodes":[{"name":"floor","children":[1,2,3]},{"name":"wall a","mesh":0,"extras":{"guid":"A1"}},
  {"name":"wall b","mesh":0,"translation":[1,0,0]},{"name":"wall c","mesh":0,"translation":[2,0,0]},
  {"name":"crane","mesh":0,"translation":[5,0,0]}])";

class Workplace {
 public:
  Workplace() {
    scenegen::testing::GltfText g;
    const std::string mesh = g.triangle_mesh();
    write_file(folder_.file("model.gltf"), g.str(mesh + kNodes));
  }
  void plan(const std::string& text, const std::string& name = "plan.csv") {
    write_file(folder_.file(name), text);
  }
  ProcessResult call(const std::string& arguments) {
    ProcessOptions options;
    options.folder = folder_.path();
    return run(SCENEGEN_PROGRAM, words("schedule " + arguments), options);
  }
  /// The line of an error, after checking that nothing was written.
  std::string error(const std::string& arguments, int code) {
    const auto before = folder_.entries();
    const ProcessResult result = call(arguments);
    INFO(arguments << "\n" << result.err);
    CHECK(result.signal == 0);
    CHECK(result.code == code);
    CHECK(result.out.empty());
    CHECK(folder_.entries() == before);
    REQUIRE(result.err.starts_with("error: "));
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
    return result.err.substr(7, result.err.size() - 8);
  }
  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
};

/// "wall a" as it is at a date: "-" hidden, else the color of its first material.
std::string look(const Scene& scene, timeline::Player& player, const std::string& object,
                 const std::string& date) {
  (void)player.seek(*timeline::time_of_date(*scene.info.calendar, date));
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects.names[i] != object) continue;
    if (!player.visible(ObjectId(i))) return "-";
    const auto material = scene.meshes[player.mesh(ObjectId(i)).value].primitives[0].material;
    if (!material.valid()) return "own";
    const glm::vec4 c = scene.materials[material.value].base_color;
    return c.y > 1.5F * c.x && c.y > 1.5F * c.z ? "green"
           : c.x > c.y && c.y < 0.2F            ? "red"
           : c.z > c.x                          ? "blue"
                                                : "other";
  }
  return "not there";
}

constexpr const char* kPlan =
    "id,name,start,finish,type,objects\n"
    "1,build,2024-03-01,2024-03-03,construct,wall a;wall b\n"
    "2,use,2024-03-06,2024-03-07,operate,wall a\n"
    "3,tear down,2024-03-10,2024-03-11,demolish,A1\n"
    "4,dream,2024-03-10,2024-03-11,,castle\n";

}  // namespace

TEST_CASE("schedule: what the plan says is what plays, date by date") {
  Workplace w;
  w.plan(kPlan);
  const ProcessResult result =
      w.call("model.gltf plan.csv -o out.glb --seconds-per-day 2 --curve none --report r.json");
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK_THAT(result.out, Catch::Matchers::StartsWith("out.glb  ") &&
                             Catch::Matchers::Contains(
                                 "2 of 4 objects  4 tasks  2024-03-01 to 2024-03-11  timeline 23 s"));
  CHECK(result.err ==
        "note: plan.csv: line 5: 'castle' matches no object\n"
        "note: 1 task without objects: 'dream'\n"
        "note: 2 objects without a task: 'wall c', 'crane'\n");
  const auto read = gltf::read(w.folder().file("out.glb"));
  REQUIRE(read);
  const Scene& scene = read->scene;
  REQUIRE(scene.info.calendar);
  CHECK(scene.info.calendar->start == "2024-03-01");
  CHECK(scene.info.calendar->seconds_per_day == 2);
  REQUIRE(scene.info.calendar->tasks.size() == 4);
  CHECK(scene.info.calendar->tasks[1].name == "use");
  CHECK(scene.info.calendar->tasks[1].start_s == 10);
  timeline::Player player(timeline::compile(scene));
  const std::map<std::string, std::string> wall_a{{"2024-03-02", "green"}, {"2024-03-05", "own"},
                                                  {"2024-03-07", "blue"},  {"2024-03-09", "own"},
                                                  {"2024-03-11", "red"},   {"2024-03-12", "-"}};
  for (const auto& [date, wanted] : wall_a) {
    INFO(date);
    CHECK(look(scene, player, "wall a", date) == wanted);
  }
  CHECK(look(scene, player, "wall b", "2024-03-12") == "own");
  CHECK(look(scene, player, "wall c", "2024-03-01") == "own");  // no task: shown

  const auto report = nlohmann::json::parse(read_file(w.folder().file("r.json")));
  CHECK(report["schema"] == "scenegen/schedule");
  CHECK(report["tasks"][0]["rule"] == "name");
  CHECK(report["tasks"][2]["rule"] == "guid");
  CHECK(report["tasks"][0]["finish"] == "2024-03-03");
  CHECK(report["tasksWithoutObjects"] == nlohmann::json::array({"4"}));
  CHECK(report["objectsWithoutTasks"] == nlohmann::json::array({"wall c", "crane"}));
  CHECK(report["objectsClaimedTwice"][0]["object"] == "wall a");
  CHECK(report["objectsClaimedTwice"][0]["tasks"] == nlohmann::json::array({"1", "2", "3"}));
  CHECK(report["unmatchedEntries"].size() == 1);
}

TEST_CASE("schedule: what is built, moved and demolished is where and as it should be") {
  Workplace w;
  w.plan(
      "id,start,finish,type,objects,offset\n"
      "1,2024-03-01,2024-03-02,construct,crane,\n"
      "2,2024-03-05,2024-03-06,move,crane,0 3 1\n"
      "3,2024-03-09,2024-03-10,demolish,crane,\n");
  const ProcessResult result = w.call("model.gltf plan.csv -o out.glb");
  INFO(result.err);
  REQUIRE(result.code == 0);
  const auto read = gltf::read(w.folder().file("out.glb"));
  REQUIRE(read);
  const Scene& scene = read->scene;
  timeline::Player player(timeline::compile(scene));
  ObjectId crane;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects.names[i] == "crane") crane = ObjectId(i);
  }
  REQUIRE(crane.valid());
  const auto place = [&](const char* date) {
    (void)player.seek(*timeline::time_of_date(*scene.info.calendar, date));
    return glm::vec3(player.world_from_object(crane)[3]);
  };
  const std::map<const char*, std::string> looks{{"2024-03-02", "green"},
                                                 {"2024-03-04", "own"},
                                                 {"2024-03-08", "own"},
                                                 {"2024-03-10", "red"},
                                                 {"2024-03-11", "-"}};
  for (const auto& [date, wanted] : looks) {
    INFO(date);
    CHECK(look(scene, player, "crane", date) == wanted);
  }
  CHECK(place("2024-03-04") == glm::vec3(5, 0, 0));
  const glm::vec3 half = place("2024-03-06");
  CHECK(half.y > 0.2F);
  CHECK(half.y < 0.8F);
  CHECK(place("2024-03-08") == glm::vec3(5, 1, -3));  // y of the plan is away from the viewer, z is up
  CHECK(place("2024-03-10") == glm::vec3(5, 1, -3));
}

TEST_CASE("schedule: objects without a task are shown, hidden or an error") {
  Workplace w;
  w.plan("id,start,finish,objects\n1,2024-03-01,2024-03-03,subtree=floor\n");
  CHECK(w.error("model.gltf plan.csv -o out.glb --unmatched error", 1) ==
        "model.gltf: 1 object without a task (--unmatched show or hide lets them be): 'crane'");
  REQUIRE(w.call("model.gltf plan.csv -o out.glb --unmatched hide").code == 0);
  const auto read = gltf::read(w.folder().file("out.glb"));
  REQUIRE(read);
  timeline::Player player(timeline::compile(read->scene));
  for (const char* date : {"2024-03-01", "2024-03-04"})
    CHECK(look(read->scene, player, "crane", date) == "-");
  CHECK(look(read->scene, player, "wall c", "2024-03-04") == "own");
}

TEST_CASE("schedule: the same bytes for any number of threads, and from MS Project's XML") {
  Workplace w;
  w.plan(kPlan);
  for (const char* threads : {"1", "2"})
    REQUIRE(w.call(std::string("model.gltf plan.csv -o ") + threads + ".glb --threads " + threads).code == 0);
  CHECK(read_file(w.folder().file("1.glb")) == read_file(w.folder().file("2.glb")));
  w.plan(R"(<Project xmlns="http://schemas.microsoft.com/project"><Tasks>
    <Task><UID>1</UID><Name>wall a</Name><Start>2024-03-01T08:00:00</Start><Finish>2024-03-03T17:00:00</Finish></Task>
    <Task><UID>2</UID><Name>floor</Name><Duration>PT8H0M0S</Duration><PredecessorLink><PredecessorUID>1</PredecessorUID>
    </PredecessorLink></Task></Tasks></Project>)",
         "plan.xml");
  const ProcessResult result = w.call("model.gltf plan.xml --dry-run");
  CHECK(result.code == 0);
  CHECK_THAT(result.out,
             Catch::Matchers::Contains("2024-03-03T17:00:00  2024-03-04T17:00:00        2  subtree") &&
                 Catch::Matchers::Contains("(not written)  3 of 4 objects"));
  CHECK_THAT(result.err,
             Catch::Matchers::Contains("1 object claimed twice, of which the surer rule counts: 'wall a'"));
}

TEST_CASE("schedule: names of two lines stay in their row, and equal claims are said") {
  Workplace w;
  w.plan(
      "id,name,start,finish,objects\n1,\"first\nline\",2024-03-01,2024-03-03,wall a\n"
      "2,again,2024-03-05,2024-03-06,wall a\n3,moment,2024-03-08,2024-03-08T00:00,wall b\n");
  const ProcessResult table = w.call("model.gltf plan.csv --dry-run");
  CHECK(table.code == 0);
  CHECK(std::count(table.out.begin(), table.out.end(), '\n') == 5);
  CHECK_THAT(table.err, Catch::Matchers::Contains(
                            "note: 1 object claimed twice by rules as sure, all of which count: 'wall a'\n"));
  const ProcessResult csv = w.call("model.gltf plan.csv --dry-run --format csv -q");
  CHECK_THAT(csv.out, Catch::Matchers::Contains("\n1,\"first\nline\",construct,"));
}

TEST_CASE("schedule: dry run and formats; a mapping saved and used again") {
  Workplace w;
  w.plan(kPlan);
  const ProcessResult csv = w.call("model.gltf plan.csv --dry-run --format csv -q --save-mapping map.json");
  CHECK(csv.code == 0);
  CHECK(csv.err.empty());
  CHECK_THAT(csv.out,
             Catch::Matchers::StartsWith("task,name,type,start,finish,objects,rule\n1,build,construct,"
                                         "2024-03-01,2024-03-03,2,name\n"));
  const auto json = nlohmann::json::parse(w.call("model.gltf plan.csv --dry-run --format json -q").out);
  CHECK(json["written"] == false);
  CHECK(json["tasks"][0]["objects"] == nlohmann::json::array({"wall a", "wall b"}));

  w.plan("id,start,finish\n1,2024-03-01,2024-03-03\n3,2024-03-05,2024-03-06\n");
  const ProcessResult again = w.call("model.gltf plan.csv -o out.glb --mapping map.json");
  CHECK(again.code == 0);
  CHECK_THAT(again.out, Catch::Matchers::Contains("2 of 4 objects  2 tasks"));
  CHECK_THAT(again.err, Catch::Matchers::Contains("note: map.json: task '2' is not in the plan any more\n"));
}

TEST_CASE("schedule: the model and the mapping are written both or not at all") {
  Workplace w;
  w.plan(kPlan);
  CHECK(w.error("model.gltf plan.csv -o out.glb -q --save-mapping /dev/full", 3) ==
        "/dev/full: cannot be written: No space left on device");
  // A pipe without a reader takes no model: the mapping stays away, and the one that was there stays.
  write_file(w.folder().file("map.json"), "before");
  ProcessOptions closed;
  closed.folder = w.folder().path();
  closed.stdout_closed_pipe = true;
  const ProcessResult result =
      run(SCENEGEN_PROGRAM, words("schedule model.gltf plan.csv -q -o - --save-mapping map.json"), closed);
  CHECK(result.code == 3);
  CHECK(read_file(w.folder().file("map.json")) == "before");
  CHECK(w.folder().entries() == std::vector<std::string>{"map.json", "model.gltf", "plan.csv"});
}

TEST_CASE("schedule: objects of layout merged are refused before anything else, also in a dry run") {
  Workplace w;
  w.plan("id,start,finish,objects\n1,2024-03-01,2024-03-03,*\n");
  ProcessOptions here;
  here.folder = w.folder().path();
  REQUIRE(run(SCENEGEN_PROGRAM, words("--floors 1 --layout merged -q -o merged.glb"), here).code == 0);
  const std::string refusal =
      "merged.glb: is of layout merged, in which objects have no nodes that could get a timeline: scenegen "
      "optimize gives them some (--layout nodes -o merged_nodes.glb)";
  CHECK(w.error("merged.glb plan.csv -o out.glb", 1) == refusal);
  CHECK(w.error("merged.glb plan.csv --dry-run --save-mapping map.json", 1) == refusal);
  REQUIRE(
      run(SCENEGEN_PROGRAM, words("optimize merged.glb -q --layout nodes -o merged_nodes.glb"), here).code ==
      0);
  const ProcessResult result = w.call("merged_nodes.glb plan.csv -q -o out.glb");
  INFO(result.err);
  CHECK(result.code == 0);
}

TEST_CASE("schedule: the IFC house goes up from the example plan") {
  const std::string model = "/usr/share/assimp/models/IFC/AC14-FZK-Haus.ifc";
  Workplace w;
  const ProcessResult result =
      w.call(model + " " SCENEGEN_SOURCE_DIR "/examples/schedules/fzk-haus.csv -o fzk.glb");
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK_THAT(result.out, Catch::Matchers::Contains("109 of 110 objects  12 tasks  2024-03-04 to "));
  const auto read = gltf::read(w.folder().file("fzk.glb"));
  REQUIRE(read);
  timeline::Player player(timeline::compile(read->scene));
  const std::string slab = "IfcSlab_Bodenplatte_1pPHnf7cXCpPsNEnQf8_6B";
  CHECK(look(read->scene, player, slab, "2024-03-06") == "green");
  CHECK(look(read->scene, player, slab, "2024-03-20") != "green");
  CHECK(look(read->scene, player, "IfcSlab_Dach-1_07Enbsqm9C7AQC9iyBwfSD", "2024-03-20") == "-");
  CHECK(look(read->scene, player, "IfcSlab_Dach-1_07Enbsqm9C7AQC9iyBwfSD", "2024-04-30") != "-");
}

TEST_CASE("schedule: what is wrong is one line, and nothing is written") {
  Workplace w;
  const std::string header = "id,start,finish,type,objects\n";
  const auto error = [&](const std::string& plan, const std::string& options = "", int code = 1) {
    w.plan(plan);
    return w.error("model.gltf plan.csv -o out.glb --save-mapping m.json " + options, code);
  };
  CHECK(error(header + "1,2024-03-01,3/4/2024,,crane\n") ==
        "plan.csv: line 2, column 'finish': '3/4/2024': may be day or month first; write YYYY-MM-DD, or say "
        "--date-order dmy or mdy");
  CHECK(error(header + "1,2024-03-01,2024-03-02,,name~[\n") ==
        "plan.csv: line 2: '[' is no regular expression: missing ]: [");
  CHECK(error(header + "1,2024-03-01,2024-03-02,,castle\n") ==
        "plan.csv: no task is about an object of the model (say which in columns 'objects' or 'selector'); "
        "the model "
        "has 4 objects: 'wall a', 'wall b', 'wall c', 'crane'");
  CHECK(
      error(header + "1,2024-03-01,2024-03-02,construct,crane\n2,2024-03-01,2024-03-02,demolish,crane\n") ==
      "object 'crane': demolish at 0 s: construct starts at the same time; its tasks: '1' (plan.csv: line 2) "
      "'2' "
      "(plan.csv: line 3)");
  CHECK(error("<Project>", "") == "plan.csv: line 1: is not well-formed XML: Start-end tags mismatch");
  const std::string good = header + "1,2024-03-01,2024-03-02,,crane\n";
  CHECK(error(good, "--mapping missing.json", 3) == "missing.json: cannot be read");
  CHECK(error(good, "--mapping plan.csv").starts_with("plan.csv: is not JSON: "));
  CHECK(error(good, "--curve peano", 2) ==
        "--curve: unknown value 'peano' (one of: hilbert, morton, row-prime, none)");
  CHECK(error(good, "--curve none --cells 4x4x4", 2) ==
        "--cells: cannot be used with --curve none, which lets objects of a task go together");
  CHECK(error(good, "--cells 1024x1024x1024", 2) == "--cells: 1073741824 cells; at most 134217728");
  CHECK(error(good, "--date-order ymd", 2) == "--date-order: unknown value 'ymd' (one of: dmy, mdy)");
  CHECK(error(good, "--unmatched drop", 2) ==
        "--unmatched: unknown value 'drop' (one of: show, hide, error)");
  CHECK(error(good, "--up z", 2) == "--up: cannot be used with glTF, which is in metres and Y up");
  CHECK(w.error("model.gltf plan.csv", 2) ==
        "--output: is missing: say which file to write (-o model_scheduled.glb)");
  CHECK(w.error("model.gltf missing.csv -o out.glb", 3) == "missing.csv: cannot be read");
  CHECK(w.error("missing.gltf plan.csv -o out.glb", 3).starts_with("missing.gltf: "));
  CHECK(w.error("model.gltf -o out.glb", 2) ==
        "missing PLAN (usage: scenegen schedule MODEL PLAN -o OUT [options])");
  CHECK(w.error("- - -o out.glb", 2) == "PLAN: stdin is the model already");
  CHECK(w.error("model.gltf plan.csv -o out.obj", 2).starts_with("--output: 'out.obj' ends neither in"));
}
