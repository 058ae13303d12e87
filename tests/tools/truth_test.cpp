// scenegen truth: what is visible when, against the player; the same in both forms; streams and bad input.
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "scene/gltf/read.h"
#include "tests/tools/process.h"
#include "timeline/player.h"

using namespace scenegen;
using namespace scenegen::test;
using nlohmann::json;

namespace {

class Workplace {
 public:
  explicit Workplace(const std::string& options) {
    const std::string small =
        "--building-size 4x4 --floor-courses 8 --floors 1 --cells 3x3x3 --interval 0.5 --quiet -o town.glb ";
    REQUIRE(run(SCENEGEN_PROGRAM, words(small + options), {.folder = folder_.path()}).code == 0);
  }
  ProcessResult call(const std::string& arguments) {
    return run(SCENEGEN_PROGRAM, words("truth " + arguments), {.folder = folder_.path()});
  }
  [[nodiscard]] std::string read(const std::string& name) const { return read_file(folder_.file(name)); }
  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
};

/// The set that a list of changes leads to must be the player's at each moment.
void check_against_player(const json& truth, const std::string& file, std::size_t moments_at_least) {
  const auto read = gltf::read(file, {});
  REQUIRE(read);
  timeline::Player player(timeline::compile(read->scene));
  REQUIRE(truth["objects"].size() == read->scene.objects.size());
  std::set<std::uint32_t> visible;
  for (const json& moment : truth["moments"]) {
    for (const json& id : moment["appear"]) CHECK(visible.insert(id.get<std::uint32_t>()).second);
    for (const json& id : moment["vanish"]) CHECK(visible.erase(id.get<std::uint32_t>()) == 1);
    CHECK(moment["visible"] == visible.size());
    player.seek(moment["timeS"].get<double>());
    for (std::uint32_t i = 0; i < read->scene.objects.size(); ++i) {
      INFO("object " << i << " at " << moment["timeS"]);
      REQUIRE(player.visible(ObjectId(i)) == visible.contains(i));
      REQUIRE(truth["objects"][i] == std::string(read->scene.objects.names[i]));
    }
  }
  CHECK(truth["moments"].size() >= moments_at_least);
}

}  // namespace

TEST_CASE("truth: changes lead to what the player shows, at every event and at chosen times") {
  for (const char* options : {"--coherence 0.5", "--profile demolish --profile-duration 1"}) {
    INFO(options);
    Workplace w(options);
    REQUIRE(w.call("town.glb -o truth.json").code == 0);
    const json truth = json::parse(w.read("truth.json"));
    CHECK(truth["schema"] == "scenegen/truth");
    check_against_player(truth, w.folder().file("town.glb"), 20);
    for (std::size_t i = 1; i < truth["moments"].size(); ++i) {
      const json& moment = truth["moments"][i];
      CHECK(moment["appear"].size() + moment["vanish"].size() > 0);
      CHECK(truth["moments"][i - 1]["timeS"] < moment["timeS"]);
    }
    REQUIRE(w.call("town.glb -o chosen.json --times 10%,50%,50%,20%").code == 0);
    const json chosen = json::parse(w.read("chosen.json"));
    REQUIRE(chosen["moments"].size() == 4);
    CHECK(chosen["moments"][2]["appear"].empty());
    CHECK(chosen["moments"][2]["vanish"].empty());
    check_against_player(chosen, w.folder().file("town.glb"), 4);
  }
}

TEST_CASE("truth: CSV says what JSON says, and every run the same bytes") {
  Workplace w("--coherence 0.5");
  const ProcessResult said = w.call("town.glb -o truth.csv");
  REQUIRE(said.code == 0);
  CHECK_THAT(said.out, Catch::Matchers::StartsWith("truth.csv  "));
  const std::string csv = w.read("truth.csv");
  REQUIRE(w.call("town.glb -o truth.json").code == 0);
  const json truth = json::parse(w.read("truth.json"));
  std::string expected = "time_s,visible,change,object,name\n";
  for (const json& moment : truth["moments"]) {
    const std::string head = moment["timeS"].dump() + "," + moment["visible"].dump() + ",";
    for (const char* change : {"appear", "vanish"}) {
      for (const json& id : moment[change]) {
        const auto name = truth["objects"][id.get<std::size_t>()].get<std::string>();
        REQUIRE(name.find_first_of(",\"") == std::string::npos);
        expected += head + change + "," + id.dump() + "," + name + "\n";
      }
    }
    if (moment["appear"].empty() && moment["vanish"].empty()) expected += head + ",,\n";
  }
  // Numbers may be spelt in more than one way that gives the same value.
  std::istringstream got(csv), wanted(expected);
  std::size_t rows = 0;
  for (std::string a, b; std::getline(got, a); ++rows) {
    REQUIRE(std::getline(wanted, b));
    if (a == b) continue;
    CHECK(std::stod(a) == std::stod(b));
    CHECK(a.substr(a.find(',')) == b.substr(b.find(',')));
  }
  CHECK(rows > 100);
  CHECK_FALSE(wanted.peek() != std::istringstream::traits_type::eof());
  CHECK(w.call("town.glb -o -").out == csv);
  CHECK(w.call("town.glb -o - --threads 2").out == csv);
}

TEST_CASE("truth: bad input is one line, and leaves nothing behind") {
  Workplace w("--coherence 1");
  const auto refused = [&](const std::string& arguments, int code, const std::string& words) {
    INFO(arguments);
    const ProcessResult result = w.call(arguments);
    CHECK(result.code == code);
    CHECK_THAT(result.err, Catch::Matchers::StartsWith("error: ") && Catch::Matchers::Contains(words));
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  };
  refused("town.glb", 2, "--output: missing");
  refused("town.glb -o truth.xml", 2, ".csv or .json");
  refused("town.glb -o truth.csv --times 700%", 2, "--times");
  refused("nothere.glb -o truth.csv", 3, "nothere.glb");
  refused("town.glb -o nothere/truth.csv", 3, "nothere");
  const ProcessResult full = run(SCENEGEN_PROGRAM, words("truth town.glb -o truth.csv"),
                                 {.folder = w.folder().path(), .most_file_bytes = 1000});
  CHECK(full.code == 3);
  CHECK_THAT(full.err, Catch::Matchers::Contains("truth.csv"));
  CHECK(w.folder().entries() == std::vector<std::string>{"town.glb"});
}
