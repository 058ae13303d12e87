// sceneplay bench compare: what it finds, how sure it is, and what it refuses.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/tools/process.h"
#include "tools/bench_compare.h"

using namespace scenegen;
using namespace scenegen::test;
using namespace scenegen::tools;
using nlohmann::ordered_json;

namespace {

ProcessResult compare(const std::string& line) {
  return run(SCENEPLAY_PROGRAM, words("bench compare " + line));
}

ordered_json a_case(const std::string& strategy, const std::vector<double>& runs, double draws) {
  double mean = 0;
  for (const double r : runs) mean += r / static_cast<double>(runs.size());
  return {{"file", "some/where/town.glb"},
          {"device", "card"},
          {"camera", "orbit"},
          {"framesInFlight", 2},
          {"strategy", strategy},
          {"frameMs", {{"mean", mean}, {"median", mean}, {"runs", runs}}},
          {"counters", {{"draws", draws}, {"queries", 3}}},
          {"sameCounters", true}};
}

ordered_json results(const ordered_json& cases) {
  return {{"schema", "sceneplay/bench"},
          {"version", 2},
          {"machine", {{"processor", "P"}, {"cores", 2}}},
          {"devices", {{{"name", "card"}, {"driver", "1.0"}}}},
          {"settings", {{"size", {320, 180}}, {"samples", 1}}},
          {"cases", cases}};
}

/// One of each kind.
ordered_json before() {
  return results({a_case("same", {10, 11, 12}, 5), a_case("slower", {10, 10.1, 9.9}, 5),
                  a_case("faster", {10, 10.1, 9.9}, 5), a_case("unknown", {10}, 5), a_case("gone", {1, 1}, 1),
                  a_case("a little", {10, 10.001, 9.999}, 5)});
}
ordered_json after() {
  ordered_json out = results({a_case("slower", {12, 12.1, 11.9}, 5), a_case("same", {10.5, 11.5, 12.5}, 6),
                              a_case("faster", {8, 8.1, 7.9}, 5), a_case("unknown", {20}, 5),
                              a_case("new", {1, 1}, 1), a_case("a little", {10.02, 10.021, 10.019}, 5)});
  for (ordered_json& c : out["cases"]) c["file"] = "else/where/town.glb";
  return out;
}

const CaseChange& of(const BenchComparison& found, const std::string& strategy) {
  const auto at = std::find_if(found.cases.begin(), found.cases.end(),
                               [&](const CaseChange& c) { return c.what.way.label == strategy; });
  REQUIRE(at != found.cases.end());
  return *at;
}

}  // namespace

TEST_CASE("the difference of two means has Welch's interval") {
  // Means 2 and 6, variances 1 and 7; 2.56 degrees of freedom, rounded down: t = 4.303.
  const auto found = welch95({1, 2, 3}, {4, 5, 9});
  REQUIRE(found);
  CHECK(found->low == Approx(4 - 4.303 * std::sqrt(8.0 / 3)));
  CHECK(found->high == Approx(4 + 4.303 * std::sqrt(8.0 / 3)));
  CHECK_FALSE(welch95({1}, {2, 3}));
  CHECK(welch95({1, 1}, {3, 3})->low == 2);
}

TEST_CASE("cases are found again, and what exceeds noise is told from what does not") {
  const auto found = compare_bench(before(), after(), 0.01);
  REQUIRE(found);
  CHECK(found->cases.size() == 5);
  CHECK(of(*found, "same").change == Change::same);
  CHECK(of(*found, "slower").change == Change::slower);
  CHECK(of(*found, "slower").difference_ms->low > 1.5);
  CHECK(of(*found, "faster").change == Change::faster);
  CHECK(of(*found, "unknown").change == Change::unknown);
  CHECK(of(*found, "a little").change == Change::same);  // certain, and 0.2 %
  CHECK(of(*compare_bench(before(), after(), 0), "a little").change == Change::slower);
  REQUIRE(of(*found, "same").counters.size() == 1);
  CHECK(of(*found, "same").counters[0].name == "draws");
  CHECK(of(*found, "same").counters[0].b == 6);
  CHECK(of(*found, "slower").counters.empty());
  REQUIRE(found->only_a.size() == 1);
  CHECK_THAT(found->only_a[0], Catch::Matchers::Contains("gone"));
  REQUIRE(found->only_b.size() == 1);
  CHECK(found->warnings.empty());
}

TEST_CASE("scenes of one name in several folders are told apart") {
  ordered_json both = results({a_case("way", {10, 10.1, 9.9}, 5), a_case("way", {20, 20.1, 19.9}, 7)});
  both["cases"][1]["file"] = "town.glb";
  ordered_json turned = both;
  std::swap(turned["cases"][0], turned["cases"][1]);
  const auto found = compare_bench(both, turned, 0.01);
  REQUIRE(found);
  CHECK(found->only_a.empty());
  CHECK(found->only_b.empty());
  REQUIRE(found->cases.size() == 2);
  for (const CaseChange& c : found->cases) {
    CHECK(c.mean_a_ms == c.mean_b_ms);
    CHECK(c.counters.empty());
  }
}

TEST_CASE("other machines, drivers and settings are said; another card is compared all the same") {
  ordered_json b = after();
  b["machine"]["cores"] = 16;
  b["devices"][0] = {{"name", "other"}, {"driver", "2.0"}};
  b["settings"]["samples"] = 4;
  b["settings"]["readback"] = true;
  for (ordered_json& c : b["cases"]) c["device"] = "other";
  b["cases"][0]["error"] = "lost";
  const auto found = compare_bench(before(), b, 0.01);
  REQUIRE(found);
  CHECK(found->cases.size() == 4);
  CHECK(found->failed_b.size() == 1);
  CHECK(found->only_a.size() == 2);
  const auto said = [&](const char* text) {
    return std::any_of(found->warnings.begin(), found->warnings.end(),
                       [&](const std::string& w) { return w.find(text) != std::string::npos; });
  };
  CHECK(found->warnings.size() == 5);
  CHECK(said("cores: 2 in A, 16 in B"));
  CHECK(said("device: card in A, other in B"));
  CHECK(said("driver: 1.0 in A, 2.0 in B"));
  CHECK(said("samples: 1 in A, 4 in B"));
  CHECK(said("readback: not given in A, true in B"));
  ordered_json wrong = before();
  wrong["cases"][0].erase("frameMs");
  CHECK(compare_bench(wrong, after(), 0).error().kind == ErrorKind::bad_input);
}

TEST_CASE("bench compare: forms, exit codes, and files that are refused") {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& name, const ordered_json& json) {
    test::write_file(folder.file(name), json.dump());
    return folder.file(name);
  };
  const std::string a = file("a.json", before());
  const std::string b = file("bench.json", after());
  const std::string both = a + " " + b;
  const auto table = compare(both);
  INFO(table.out << table.err);
  CHECK(table.code == 0);
  CHECK(table.err.empty());
  CHECK_THAT(table.out,
             Catch::Matchers::Contains("5 cases in both: 1 faster, 1 slower, 2 the same within noise, "
                                       "1 with too few runs to tell\ncounters differ in 1 case\n"));
  CHECK_THAT(table.out, Catch::Matchers::Contains("draws 5 -> 6") && Catch::Matchers::Contains("+20.0 %"));
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = table.out.find('\n', begin)) != std::string::npos; begin = end + 1)
    CHECK(end - begin <= 110);  // bytes
  CHECK(compare(a + " " + folder.path() + " --format csv").out.starts_with("file,device,camera,"));
  const auto json = ordered_json::parse(compare(both + " --format json").out);
  CHECK(json["schema"] == "sceneplay/bench-comparison");
  CHECK(json["cases"].size() == 5);
  CHECK(compare(both + " --fail-on slower").code == 1);
  CHECK(compare(both + " --fail-on counters").code == 1);
  CHECK(compare(a + " " + a + " --fail-on any").code == 0);
  ordered_json quick = before();
  for (ordered_json& c : quick["cases"]) c["frameMs"] = {{"mean", 1}, {"median", 1}, {"runs", {1, 1, 1}}};
  CHECK(compare(a + " " + file("quick.json", quick) + " --fail-on any").code == 0);
  quick["cases"].erase(0);
  CHECK(compare(a + " " + file("less.json", quick) + " --fail-on slower").code == 1);

  const auto refused = [&](const std::string& other, int code, const std::string& part) {
    const auto result = compare(a + " " + other);
    INFO(result.err);
    CHECK(result.code == code);
    CHECK(result.out.empty());
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
    CHECK_THAT(result.err, Catch::Matchers::Contains(part));
  };
  ordered_json old = after();
  old["version"] = 1;
  refused(file("old.json", old), 1, "version 1");
  ordered_json foreign = after();
  foreign["schema"] = "other";
  refused(file("foreign.json", foreign), 1, "is no result of sceneplay bench");
  refused(file("nothing.json", ordered_json()), 1, "is no result");
  test::write_file(folder.file("cut.json"), after().dump().substr(0, 300));
  refused(folder.file("cut.json"), 1, "cut.json");
  ordered_json strange = after();
  strange["cases"][1]["frameMs"] = "fast";
  refused(file("strange.json", strange), 1, "strange.json");
  refused(folder.file("none.json"), 3, "none.json");
  ordered_json empty = after();
  empty["cases"] = ordered_json::array();
  const auto vacuous = compare(a + " " + file("empty.json", empty) + " --fail-on counters");
  CHECK(vacuous.code == 1);
  CHECK_THAT(vacuous.err, Catch::Matchers::Contains("no case in common"));
  test::write_file(folder.file("deep.json"),
                   R"({"version":)" + std::string(200'000, '[') + std::string(200'000, ']') + "}");
  refused(folder.file("deep.json"), 1, "is no result");
  refused("--fail-on slow " + b, 2, "did you mean 'slower'");
}
