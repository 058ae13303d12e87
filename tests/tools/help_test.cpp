// The help as a person sees it, and docs/CLI.md, which repeats it.
#include <catch2/catch.hpp>
#include <sstream>

#include "tests/tools/process.h"

using namespace scenegen::test;

namespace {

std::vector<std::string> lines(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> out;
  for (std::string line; std::getline(stream, line);) out.push_back(line);
  return out;
}

std::string help(const std::string& verb) {
  std::vector<std::string> arguments = words(verb);
  arguments.emplace_back("--help");
  const ProcessResult result = run(SCENEGEN_PROGRAM, arguments);
  CHECK(result.code == 0);
  CHECK(result.err.empty());
  return result.out;
}

}  // namespace

TEST_CASE("help has headed groups, defaults and ranges") {
  const std::string text = help("");
  std::size_t last = 0;
  for (const char* title : {"\nUsage:\n", "\nTown:\n", "\nBuilding:\n", "\nExtra objects:\n",
                            "\nAppearance:\n", "\nOutput:\n", "\nGeneral:\n"}) {
    INFO(title);
    const std::size_t place = text.find(title);
    REQUIRE(place != std::string::npos);
    CHECK(place > last);
    last = place;
  }
  CHECK_THAT(text, Catch::Matchers::Contains("(1x1 to 1000x1000; default: 1x1)"));
  CHECK_THAT(text, Catch::Matchers::Contains("-o, --output FILE"));
}

TEST_CASE("help fits a terminal and is in docs/CLI.md as it stands") {
  const std::string reference = read_file(SCENEGEN_SOURCE_DIR "/docs/CLI.md");
  for (const char* verb : {"", "animate", "schedule", "inspect", "diff", "optimize", "truth"}) {
    INFO(verb);
    const std::string text = help(verb);
    for (const std::string& line : lines(text)) {
      INFO(line);
      CHECK(line.size() <= 100);
      CHECK(line == line.substr(0, line.find_last_not_of(' ') + 1));
      CHECK(line.find('\x1b') == std::string::npos);
    }
    CHECK_THAT(reference, Catch::Matchers::Contains("```text\n$ scenegen " + std::string(verb) +
                                                    (*verb == '\0' ? "" : " ") + "--help\n" + text + "```"));
  }
}

#ifdef SCENEPLAY_PROGRAM
TEST_CASE("every option of sceneplay is in docs/CLI.md") {
  const std::string reference = read_file(SCENEGEN_SOURCE_DIR "/docs/CLI.md");
  for (const char* verb : {"frames", "bench", "experiment", "calibrate", "camera-path"}) {
    const ProcessResult result = run(SCENEPLAY_PROGRAM, {verb, "--help"});
    REQUIRE(result.code == 0);
    std::size_t options = 0;
    for (const std::string& line : lines(result.out)) {
      INFO(line);
      CHECK(line.size() <= 100);
      const std::size_t dashes = line.find("--");
      if (!line.starts_with("  -") || dashes == std::string::npos) continue;
      ++options;
      const std::string name = line.substr(dashes, line.find_first_of(" ,", dashes) - dashes);
      CHECK_THAT(reference, Catch::Matchers::Contains("\n$ sceneplay " + std::string(verb) + " --help\n"));
      CHECK_THAT(reference.substr(reference.find("$ sceneplay " + std::string(verb))),
                 Catch::Matchers::Contains(name + " ") || Catch::Matchers::Contains(name + "\n"));
    }
    CHECK(options > 3);
  }
}
#endif

TEST_CASE("help and version win over the rest of the line") {
  CHECK(run(SCENEGEN_PROGRAM, words("--coherence 7 --help")).code == 0);
  CHECK(run(SCENEGEN_PROGRAM, words("inspect --help")).code == 0);
  CHECK(run(SCENEGEN_PROGRAM, words("diff --version")).out == "scenegen " SCENEGEN_VERSION "\n");
}
