// Which objects a task gets, what wins, what is reported, and when each object is worked at.
#include "timeline/schedule/mapping.h"

#include <catch2/catch.hpp>
#include <map>

#include "tests/support/gltf_text.h"

using namespace scenegen;
using namespace scenegen::timeline;

namespace {

/// Two storeys of walls in a row along x, a slab, a crane.
constexpr const char* kModel = R"(,"materials":[{"name":"brick"}],
  "scenes":[{"nodes":[0,4,7]}],
  "nodes":[
    {"name":"Ground floor","children":[1,2,3],"extras":{"guid":"G0"}},
    {"name":"wall a","mesh":0,"translation":[0,0,0],"extras":{"guid":"A1"}},
    {"name":"wall b","mesh":0,"translation":[1,0,0],"extras":{"guid":"B1","task":"T9"}},
    {"name":"wall c","mesh":0,"translation":[2,0,0]},
    {"name":"Upper floor","children":[5,6],"extras":{"guid":"G1"}},
    {"name":"wall d","mesh":0,"translation":[0,1,0]},
    {"name":"slab","mesh":0,"translation":[1,1,0],"extras":{"guid":"S1"}},
    {"name":"crane","mesh":0,"translation":[5,0,0]}])";

class Site {
 public:
  explicit Site(std::string model = kModel) {
    testing::GltfText g;
    const std::string mesh = g.triangle_mesh();
    const std::string text = g.str(mesh + model);
    auto read = gltf::read_memory({text.begin(), text.end()}, "site.gltf", "", {true, 1});
    if (!read) FAIL(read.error().str());
    read_ = std::move(*read);
    auto facts = ObjectFacts::make(read_.scene, *read_.source);
    if (!facts) FAIL(facts.error().str());
    facts_ = std::make_unique<ObjectFacts>(std::move(*facts));
  }
  Plan plan(const std::string& rows,
            const std::string& header = "id,name,start,finish,type,objects,selector,parent") {
    auto plan = parse_plan(header + "\n" + rows, "p.csv");
    if (!plan) FAIL(plan.error().str());
    return std::move(*plan);
  }
  Mapping map(const Plan& plan, const MappingOptions& options = {}) {
    auto mapping = map_tasks(plan, read_.scene, *facts_, options);
    if (!mapping) FAIL(mapping.error().str());
    return std::move(*mapping);
  }
  std::string names(const std::vector<ObjectId>& objects) const {
    std::string out;
    for (const ObjectId id : objects)
      out += (out.empty() ? "" : "+") + std::string(read_.scene.objects.names[id.value]);
    return out;
  }
  /// "walls: wall a+wall b (pattern)" of the only task.
  std::string pick(const std::string& task_name, const std::string& objects,
                   const std::string& selector = "") {
    const Plan p =
        plan("T1,\"" + task_name + "\",2024-03-01,2024-03-05,,\"" + objects + "\",\"" + selector + "\",\n");
    const Mapping m = map(p);
    return names(m.objects_of_task[0]) +
           (m.rule_of_task[0] ? " (" + std::string(name(*m.rule_of_task[0])) + ")" : "none");
  }
  Scene& scene() { return read_.scene; }
  ObjectFacts& facts() { return *facts_; }

 private:
  gltf::ReadResult read_;
  std::unique_ptr<ObjectFacts> facts_;
};

constexpr const char* kDay1 = "2024-03-01,2024-03-04";

}  // namespace

TEST_CASE("an entry is an identifier, else a name, else a selector") {
  Site site;
  CHECK(site.pick("x", "A1") == "wall a (guid)");
  CHECK(site.pick("x", "G0") == "wall c (guid)");  // walls a and b have their own
  CHECK(site.pick("x", "wall c;crane") == "wall c+crane (name)");
  CHECK(site.pick("x", "wall ?") == "wall a+wall b+wall c+wall d (pattern)");
  CHECK(site.pick("x", "name~^wall [ab]") == "wall a+wall b (pattern)");
  CHECK(site.pick("x", "name=slab") == "slab (name)");
  CHECK(site.pick("x", "extras.task=T9") == "wall b (extras)");
  CHECK(site.pick("x", "subtree=Upper*") == "wall d+slab (subtree)");
  CHECK(site.pick("x", "", "subtree=Upper*") == "wall d+slab (subtree)");
  CHECK(site.pick("x", "slab", "name~[ab]$") == "wall a+wall b+slab (name)");
  CHECK(site.pick("x", "nothing") == "none");
}

TEST_CASE("a task without entries is about what bears its id or name") {
  Site site;
  const auto pick = [&](const std::string& id, const std::string& name) {
    const Plan p = site.plan(id + "," + name + ",2024-03-01,2024-03-05,,,,\n");
    const Mapping m = site.map(p);
    return site.names(m.objects_of_task[0]) +
           (m.rule_of_task[0] ? " (" + std::string(timeline::name(*m.rule_of_task[0])) + ")" : "none");
  };
  CHECK(pick("A1", "crane") == "wall a (guid)");
  CHECK(pick("1", "B1") == "wall b (guid)");
  CHECK(pick("1", "crane") == "crane (name)");
  CHECK(pick("1", "wall*") == "wall a+wall b+wall c+wall d (pattern)");
  CHECK(pick("T9", "beams") == "wall b (extras)");
  CHECK(pick("1", "T9") == "wall b (extras)");
  CHECK(pick("1", "Upper floor") == "wall d+slab (subtree)");
  CHECK(pick("1", "roof") == "none");
}

TEST_CASE("the report lists what is without, what is claimed twice, and what matches nothing") {
  Site site;
  const Plan plan = site.plan(
      "1,one,2024-03-01,2024-03-04,,wall a;wall z,,\n"
      "2,two,2024-03-05,2024-03-06,,subtree=Ground floor,,\n"
      "3,three,2024-03-07,2024-03-08,,,name~^roof,\n"
      "4,four,2024-03-09,2024-03-10,demolish,wall b,,\n");
  const Mapping m = site.map(plan);
  CHECK(m.notes == std::vector<std::string>{"p.csv: line 2: 'wall z' matches no object",
                                            "p.csv: line 4: 'name~^roof' matches no object"});
  CHECK(m.tasks_without_objects == std::vector<std::uint32_t>{2});
  CHECK(site.names(m.objects_without_tasks) == "wall d+slab+crane");
  // Wall a is task 1's: a name is stronger than a subtree. Wall b is built and demolished.
  CHECK(site.names(m.objects_of_task[0]) == "wall a");
  CHECK(site.names(m.objects_of_task[1]) == "wall b+wall c");
  CHECK(site.names(m.objects_of_task[3]) == "wall b");
  REQUIRE(m.claimed_twice.size() == 2);
  CHECK(m.claimed_twice[0].tasks == std::vector<std::uint32_t>{0});
  CHECK(m.claimed_twice[0].losers == std::vector<std::uint32_t>{1});
  CHECK(m.claimed_twice[1].tasks == std::vector<std::uint32_t>{1, 3});
  CHECK(m.claimed_twice[1].losers.empty());
  CHECK_FALSE((m.claimed_twice[0].equals || m.claimed_twice[1].equals));

  const auto wrong =
      map_tasks(site.plan("1,x,2024-03-01,2024-03-04,,name~(,,\n"), site.scene(), site.facts(), {});
  REQUIRE_FALSE(wrong);
  CHECK(wrong.error().str() == "p.csv: line 2: '(' is no regular expression: missing ): (");
}

TEST_CASE("who wins is decided again after a demolition, and equals share") {
  Site site;
  const Plan plan = site.plan(
      "1,,2024-03-01,2024-03-02,construct,wall a,,\n"
      "2,,2024-03-03,2024-03-04,construct,wall a,,\n"      // as strong: worked at twice
      "3,,2024-03-05,2024-03-06,operate,wall*,,\n"         // leaves it where it is
      "4,,2024-03-07,2024-03-08,construct,wall [a],,\n"    // weaker
      "5,,2024-03-09,2024-03-10,demolish,wall [a],,\n"     // the only one that demolishes
      "6,,2024-03-11,2024-03-12,construct,wall [a],,\n");  // built again
  const Mapping m = site.map(plan);
  const auto& shared = m.claimed_twice.front();
  CHECK(shared.tasks == std::vector<std::uint32_t>{0, 1, 2, 4, 5});
  CHECK(shared.losers == std::vector<std::uint32_t>{3});
  CHECK(shared.equals);
}

TEST_CASE("summary tasks carry objects only when asked") {
  Site site;
  const std::string rows = std::string("S,Ground floor,,,,subtree=Ground floor,,\n") + "1,a," + kDay1 +
                           ",,wall a,,S\n2,slab," + kDay1 + ",,,,S\n";
  const Plan plan = site.plan(rows);
  Mapping m = site.map(plan);
  CHECK(m.objects_of_task[0].empty());
  CHECK(site.names(m.objects_without_tasks) == "wall b+wall c+wall d+crane");
  CHECK(m.notes ==
        std::vector<std::string>{
            "p.csv: line 2: is a summary task: its objects are left out (--summary-tasks takes them)"});
  CHECK(m.tasks_without_objects.empty());
  MappingOptions options;
  options.summary_tasks = true;
  m = site.map(plan, options);
  CHECK(site.names(m.objects_of_task[0]) == "wall b+wall c");
  CHECK(site.names(m.objects_of_task[1]) == "wall a");
}

TEST_CASE("a mapping is saved and found again in a newer model") {
  Site site;
  const Plan plan =
      site.plan(std::string("1,x,") + kDay1 + ",,wall a;wall c;slab,,\n2,y," + kDay1 + ",,crane,,\n");
  const Mapping m = site.map(plan);
  const std::string json = write_mapping(plan, m, site.scene(), site.facts());
  auto saved = parse_mapping(json, "m.json");
  REQUIRE(saved);
  REQUIRE(saved->tasks.size() == 2);
  CHECK(saved->tasks[0].objects[0].guid == "A1");

  // Renamed (found by identifier), in two parts now, gone, and a plan that has no entries any more.
  Site newer(R"(,"scenes":[{"nodes":[0,1,2,3,4]}],"nodes":[
    {"name":"Wall A","mesh":0,"extras":{"guid":"A1"}},
    {"name":"slab 1","mesh":0,"extras":{"guid":"S1"}},{"name":"slab 2","mesh":0,"extras":{"guid":"S1"}},
    {"name":"crane","mesh":0},{"name":"wall","mesh":0}])");
  MappingOptions options;
  options.saved = &*saved;
  const Mapping again =
      newer.map(newer.plan(std::string("1,x,") + kDay1 + ",,,,\n3,z," + kDay1 + ",,wall,,\n"), options);
  CHECK(newer.names(again.objects_of_task[0]) == "Wall A+slab 1+slab 2");
  CHECK(*again.rule_of_task[0] == MatchRule::saved);
  CHECK(newer.names(again.objects_of_task[1]) == "wall");
  CHECK(again.notes ==
        std::vector<std::string>{"m.json: task '1': 'wall c' is no object of this model any more",
                                 "m.json: task '2' is not in the plan any more"});
  // By hand.
  saved = parse_mapping(
      R"({"schema":"scenegen/mapping","version":1,"tasks":{"3":["S1","wall","name~^Wall"]}})", "m.json");
  REQUIRE(saved);
  options.saved = &*saved;
  const Mapping hand = newer.map(newer.plan(std::string("3,z,") + kDay1 + ",,,,\n"), options);
  CHECK(newer.names(hand.objects_of_task[0]) == "Wall A+slab 1+slab 2+wall");

  const std::map<std::string, std::string> wrong{
      {"{", "m.json: is not JSON: "},
      {"[]", "m.json: is no mapping: \"schema\" must be \"scenegen/mapping\""},
      {R"({"schema":"scenegen/mapping","version":2})", "m.json: /version: this program reads version 1"},
      {R"({"schema":"scenegen/mapping","version":1,"tasks":[]})",
       "m.json: /tasks: wanted an object of task ids"},
      {R"({"schema":"scenegen/mapping","version":1,"tasks":{"a":1}})",
       "m.json: /tasks/'a': wanted a list of objects"},
      {R"({"schema":"scenegen/mapping","version":1,"tasks":{"a":["x",{"guid":1}]}})",
       "m.json: /tasks/'a'/1/guid: wanted a string"},
      {R"({"schema":"scenegen/mapping","version":1,"tasks":{"a":[{}]}})",
       "m.json: /tasks/'a'/0: wanted a name, an identifier or a selector, or an object with \"name\" or "
       "\"guid\""}};
  for (const auto& [text, line] : wrong) {
    INFO(text);
    const auto parsed = parse_mapping(text, "m.json");
    REQUIRE_FALSE(parsed);
    CHECK_THAT(parsed.error().str(), Catch::Matchers::StartsWith(line));
    CHECK(parsed.error().str().find('\n') == std::string::npos);
  }
}

TEST_CASE("a saved mapping keeps the order of the plan, and identifiers that are a task's alone") {
  Site site(R"(,"scenes":[{"nodes":[0,5]}],"nodes":[{"name":"s","extras":{"guid":"S"},"children":[1,2,3,4]},
    {"name":"a","mesh":0},{"name":"b","mesh":0},{"name":"c","mesh":0},{"name":"d","mesh":0},
    {"name":"e","mesh":0,"extras":{"guid":"E"}}])");
  const auto saved_guids = [&](const std::string& rows) {
    const Plan plan = site.plan(rows);
    const std::string json = write_mapping(plan, site.map(plan), site.scene(), site.facts());
    const std::size_t two = json.find("\"2\": {");
    CHECK(two < json.find("\"1\": {"));
    const auto saved = parse_mapping(json, "m.json");
    REQUIRE(saved);
    std::string out;
    for (const SavedMapping::Entry& task : saved->tasks) {
      out += task.task_id + ":";
      for (const SavedMapping::Object& object : task.objects) out += " " + object.name + "=" + object.guid;
      out += ";";
    }
    return out;
  };
  const std::string day = std::string(",x,") + kDay1 + ",,";
  CHECK(saved_guids("2" + day + "a;b;c;d,,\n1" + day + "e;a,,\n") == "1: a= e=E;2: a=S b=S c=S d=S;");
  CHECK(saved_guids("2" + day + "a;c;d,,\n1" + day + "e;b,,\n") == "1: b= e=E;2: a= c= d=;");
}

TEST_CASE("objects of a task follow each other along the curve, within its span") {
  Site site;
  const Plan plan = site.plan(
      "1,,2024-03-01T12:00,2024-03-05T12:00,construct,wall [abc];crane,,\n"
      "2,,2024-03-06,2024-03-09,demolish,wall [abc];crane,,\n"
      "3,,2024-03-10,2024-03-10,temporary,wall d;slab,,\n");
  const Mapping m = site.map(plan);
  ActivityOptions options;
  options.seconds_per_day = 2;
  options.curve = CurveKind::row_prime;  // along x first
  const Schedule s = make_activities(plan, m, site.scene(), options);
  CHECK(s.calendar.start == "2024-03-01");
  CHECK(s.calendar.seconds_per_day == 2);
  CHECK(s.end_s == 20);
  REQUIRE(s.calendar.tasks.size() == 3);
  CHECK(s.calendar.tasks[0].type == "construct");
  CHECK(s.calendar.tasks[0].start_s == 1);
  CHECK(s.calendar.tasks[0].finish_s == 9);
  REQUIRE(s.activities.size() == 10);
  const auto check = [&](std::size_t i, const char* object, double start_s, double finish_s) {
    INFO(i);
    CHECK(site.scene().objects.names[s.activities[i].object.value] == object);
    CHECK(s.activities[i].start_s == Approx(start_s));
    CHECK(s.activities[i].finish_s == Approx(finish_s));
  };
  check(0, "wall a", 1, 3);  // a quarter of 8 s each
  check(1, "wall b", 3, 5);
  check(2, "wall c", 5, 7);
  check(3, "crane", 7, 9);
  check(4, "crane", 10, 12);  // demolished from the end
  check(7, "wall a", 16, 18);
  check(8, "wall d", 18, 20);  // temporary: all for the whole span
  check(9, "slab", 18, 20);

  options.share = 0.5;  // they overlap
  const Schedule overlapping = make_activities(plan, m, site.scene(), options);
  CHECK(overlapping.activities[1].start_s == Approx(1 + 4.0 / 3));
  CHECK(overlapping.activities[1].finish_s == Approx(5 + 4.0 / 3));
  CHECK(overlapping.activities[3].finish_s == 9);
  options.share = 0.1;
  options.steps = 2;  // two share a time
  const Schedule coarse = make_activities(plan, m, site.scene(), options);
  CHECK(coarse.activities[0].start_s == coarse.activities[1].start_s);
  CHECK(coarse.activities[2].start_s == Approx(5));
  options.stagger = false;
  const Schedule together = make_activities(plan, m, site.scene(), options);
  for (int i = 0; i < 4; ++i) CHECK(together.activities[i].start_s == 1);
}

TEST_CASE("a move goes by its own offset, else by the option") {
  Site site;
  const Plan plan =
      site.plan("1,,2024-03-01,2024-03-02,move,crane,1 2 3\n2,,2024-03-03,2024-03-04,move,crane,\n",
                "id,name,start,finish,type,objects,offset");
  ActivityOptions options;
  options.move_offset_m = {7, 0, 0};
  const Schedule s = make_activities(plan, site.map(plan), site.scene(), options);
  CHECK(s.activities[0].offset_m == glm::vec3(1, 3, -2));  // Y up
  CHECK(s.activities[1].offset_m == glm::vec3(7, 0, 0));
}
