// scenegen --profile from end to end.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/tools/process.h"

using namespace scenegen::test;
using nlohmann::json;

namespace {

ProcessResult made_by(const TemporaryFolder& folder, const std::string& arguments) {
  ProcessResult result = run(SCENEGEN_PROGRAM, words(arguments), {.folder = folder.path()});
  INFO("scenegen " << arguments << "\n" << result.err);
  REQUIRE(result.code == 0);
  return result;
}

json inspected(const TemporaryFolder& folder, const std::string& file) {
  return json::parse(made_by(folder, "inspect --format json " + file).out);
}

const char* const kHouse = "--floors 1 --building-size 6x6 --cells 8x8x8 --coherence 0.9 ";

}  // namespace

TEST_CASE("every profile reads back as it was made, in every layout and color form") {
  const TemporaryFolder folder;
  for (const std::string profile :
       {"appear", "construct", "demolish", "temporary", "drop", "move", "operate", "neutral"}) {
    const std::string base = kHouse + std::string("--profile ") + profile;
    made_by(folder, base + " --layout nodes -o base.glb");
    const json facts = inspected(folder, "base.glb");
    INFO(profile);
    CHECK(facts["findings"].empty());
    CHECK(facts["coherence"].get<double>() == facts["coherenceStored"].get<double>());
    CHECK(facts["coherence"].get<double>() == Approx(0.9).margin(1e-3));
    const bool moves = profile == "drop" || profile == "move";
    CHECK(facts["classes"]["static"] == 2);  // the ground
    CHECK((facts["classes"]["dynamic"] > 0) == moves);
    CHECK((facts["classes"]["pseudoDynamic"] > 0) == !moves);
    for (const std::string layout : {"groups", "instances"}) {
      made_by(folder, base + (" --visibility both --layout " + layout + " -o other.glb"));
      CHECK_THAT(made_by(folder, "diff base.glb other.glb").out, Catch::Matchers::StartsWith("equal  "));
    }
    if (profile == "appear" || profile == "neutral" || profile == "drop") continue;
    made_by(folder, base + " --color pointer --layout nodes -o pointer.glb");
    CHECK(inspected(folder, "pointer.glb")["coherence"] == facts["coherence"]);
    CHECK(run(SCENEGEN_PROGRAM, words("diff base.glb pointer.glb"), {.folder = folder.path()}).code == 1);
    made_by(folder, base + " --color pointer --visibility pointer --layout groups -o other.glb");
    CHECK_THAT(made_by(folder, "diff pointer.glb other.glb").out, Catch::Matchers::StartsWith("equal  "));
  }
}

TEST_CASE("profile options decide the content and are kept in the file") {
  const TemporaryFolder folder;
  made_by(folder, kHouse + std::string("--profile drop --profile-duration 2 --drop-height 3 "
                                       "--highlight drop=#3A86D8,move=none -o a.glb"));
  const json facts = inspected(folder, "a.glb");
  const json wanted{
      "--profile",     "drop", "--profile-duration", "2", "--highlight", "drop=#3a86d8,move=none",
      "--drop-height", "3"};
  std::string arguments;
  for (const json& argument : facts["arguments"]) arguments += argument.get<std::string>() + " ";
  for (const json& part : wanted) CHECK_THAT(arguments, Catch::Matchers::Contains(part.get<std::string>()));
  made_by(folder, arguments + "-o b.glb");
  CHECK(read_file(folder.file("a.glb")) == read_file(folder.file("b.glb")));
  // What follows the last event: two seconds of falling and the hold.
  CHECK(facts["durationS"].get<double>() <= 512 * 0.01 + 2 + 1 + 1e-4);
  CHECK(facts["durationS"].get<double>() > 3);
}

TEST_CASE("wrong profile options are one line") {
  struct Case {
    const char* arguments;
    const char* line;
  };
  const TemporaryFolder folder;
  for (const Case& wrong : {
           Case{"--profile constuct", "--profile: unknown value 'constuct' (did you mean 'construct'?"},
           {"--profile construct --highlight green", "--highlight: 'green' is not of the form"},
           {"--profile construct --highlight constrct=#ffffff", "did you mean 'construct'?"},
           {"--profile construct --highlight construct=green", "'green' is not a color like #40b060"},
           {"--profile construct --highlight construct=#ffffff,", "--highlight: '' is not of the form"},
           {"--profile construct --highlight appear=#ffffff", "appear takes no time"},
           {"--profile construct --highlight demolish=#ffffff", "has no effect with --profile construct"},
           {"--highlight construct=#ffffff", "--highlight: has no effect with --profile appear"},
           {"--profile neutral --profile-duration 3", "--profile-duration: has no effect"},
           {"--profile construct --drop-height 3", "--drop-height: has no effect with --profile construct"},
           {"--profile drop --move-offset 1,2,3", "--move-offset: has no effect with --profile drop"},
           {"--profile drop --color pointer", "--color: has no effect with --profile drop"},
           {"--profile move --move-offset 1,2", "--move-offset: '1,2' is not of the form X,Y,Z"},
           {"--profile move --move-offset 1,2,3,4", "is not of the form X,Y,Z"},
           {"--profile move --move-offset 1,2,east", "--move-offset: 'east' is not a number"},
           {"--profile move --move-offset 1,2,1e9", "out of range"},
           {"--profile construct --profile-duration 0", "--profile-duration: 0 is out of range"},
           {"--curve none --profile construct", "--profile: cannot be used with --curve none"},
       }) {
    INFO(wrong.arguments);
    const ProcessResult result = run(SCENEGEN_PROGRAM, words(wrong.arguments), {.folder = folder.path()});
    CHECK(result.code == 2);
    CHECK_THAT(result.err, Catch::Matchers::StartsWith("error: ") && Catch::Matchers::Contains(wrong.line));
    CHECK(folder.entries().empty());
  }
}
