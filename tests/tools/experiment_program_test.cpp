// sceneplay experiment: files, tables, and what it refuses.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/tools/process.h"
#include "tools/experiments/all.h"
#include "tools/report/document.h"

using namespace scenegen;
using namespace scenegen::test;
using namespace scenegen::tools;

namespace {

ProcessResult play(const std::string& line) {
  return run(SCENEPLAY_PROGRAM, words(line));
}

Document document_in(const std::string& folder) {
  const auto json = nlohmann::ordered_json::parse(read_file(folder + "/experiment.json"));
  CHECK(json["schema"] == "sceneplay/experiment");
  CHECK(json["version"] == 1);
  CHECK(json["machine"]["cores"] >= 1);
  auto document = document_from_json(json["document"], "/document");
  INFO((document ? "" : document.error().str()));
  REQUIRE(document);
  return std::move(*document);
}

/// What does not depend on the machine: everything but times and their spread.
std::string counts_of(const Document& document) {
  std::string out;
  for (const DocumentSection& section : document.sections) {
    for (const Block& block : section.blocks) {
      const auto* table = std::get_if<DocumentTable>(&block);
      if (table == nullptr) continue;
      for (const std::vector<Cell>& row : table->rows) {
        for (std::size_t i = 0; i < row.size(); ++i) {
          if (table->columns[i].unit == "ms" || table->columns[i].title == "spread") continue;
          if (const auto* number = std::get_if<double>(&row[i])) out += std::to_string(*number) + " ";
        }
        out += "\n";
      }
    }
  }
  return out;
}

}  // namespace

TEST_CASE("experiment: the list") {
  const auto by_option = play("experiment --list");
  const auto by_itself = play("experiment");
  CHECK(by_option.code == 0);
  CHECK(by_option.out == by_itself.out);
  for (const Experiment& e : experiments())
    CHECK_THAT(by_option.out, Catch::Matchers::Contains(std::string(e.name)) &&
                                  Catch::Matchers::Contains(std::string(e.source)));
}

TEST_CASE("experiment: octree-or-bvh needs no device and gives the same counts again") {
  const TemporaryFolder folder;
  const auto result =
      play("experiment octree-or-bvh --quick --repeat 1 --device nonesuch -o " + folder.file("a/b"));
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK_THAT(result.out, Catch::Matchers::Contains("LBVH, Morton") && Catch::Matchers::Contains("D 5.2"));
  const Document first = document_in(folder.file("a/b"));
  REQUIRE(first.sections.size() == 1);
  CHECK(first.sections[0].id == "octree-or-bvh");
  CHECK(first.sections[0].blocks.size() >= 4);
  REQUIRE(first.sections[0].verdicts.size() == 5);
  for (const Verdict& v : first.sections[0].verdicts) {
    CHECK(v.source.starts_with("D 5.2"));
    CHECK((!v.paper.empty() && !v.ours.empty() && !v.why.empty()));
    CHECK_THAT(result.out, Catch::Matchers::Contains(v.source));
  }
  CHECK_THAT(read_file(folder.file("a/b/index-visible.csv")),
             Catch::Matchers::StartsWith("scene,objects,index,"));
  CHECK(std::filesystem::exists(folder.file("a/b/references-by-height.csv")));
  REQUIRE(play("experiment octree-or-bvh --quick --repeat 1 --quiet -o " + folder.file("c")).code == 0);
  CHECK(counts_of(document_in(folder.file("c"))) == counts_of(first));
  REQUIRE(play("experiment octree-or-bvh --quick --repeat 1 --quiet --seed 2 -o " + folder.file("d")).code ==
          0);
  CHECK(counts_of(document_in(folder.file("d"))) != counts_of(first));
}

TEST_CASE("experiment: drawing, with figures of the paper beside ours and a picture") {
  const TemporaryFolder folder;
  const std::string call =
      "experiment invisible-objects --quick --repeat 1 --size 96x54 --samples 1 --validation on --quiet -o ";
  const auto result = play(call + folder.file("a"));
  INFO(result.err);
  REQUIRE(result.code == 0);
  CHECK(result.out.empty());
  const Document document = document_in(folder.file("a"));
  REQUIRE(document.sections.size() == 1);
  bool found = false;
  std::size_t pictures = 0;
  for (const Block& block : document.sections[0].blocks) {
    if (const auto* picture = std::get_if<Picture>(&block)) {
      ++pictures;
      CHECK(read_file(folder.file("a/" + picture->file)).starts_with("\x89PNG"));
    }
    const auto* table = std::get_if<DocumentTable>(&block);
    if (table == nullptr) continue;
    double before = -1;
    for (const std::vector<Cell>& row : table->rows) {
      const double queries = std::get<double>(row[0]);
      const double invisible = std::get<double>(row[1]);
      CHECK(invisible >= before);  // more queries never find less
      before = invisible;
      if (queries == 100) {
        found = true;
        CHECK(std::get<double>(row[2]) == 45276);
        CHECK(table->columns[2].origin == Origin::paper);
        CHECK(table->columns[1].against == table->columns[2].name);
      }
    }
    CHECK(before > 2000);
    CHECK(before < 20000);
  }
  CHECK(found);
  CHECK(pictures == 1);
  REQUIRE(play(call + folder.file("b")).code == 0);
  // Times are columns in ms; what is counted is the same again.
  CHECK(counts_of(document_in(folder.file("b"))) == counts_of(document));
}

TEST_CASE("experiment: all of them, small, make one document", "[.all]") {
  const TemporaryFolder folder;
  const auto result =
      play("experiment all --quick --repeat 1 --size 64x36 --samples 1 --calibration none -q -o " +
           folder.file("a"));
  INFO(result.err);
  REQUIRE(result.code == 0);
  const Document document = document_in(folder.file("a"));
  REQUIRE(document.sections.size() == experiments().size());
  for (std::size_t i = 0; i < document.sections.size(); ++i) {
    CHECK(document.sections[i].id == experiments()[i].name);
    CHECK_FALSE(document.sections[i].verdicts.empty());
    CHECK(document.sections[i].failures.empty());
    for (const Verdict& v : document.sections[i].verdicts)
      CHECK((!v.paper.empty() && !v.ours.empty() && !v.why.empty()));
    for (const Block& block : document.sections[i].blocks) {
      if (const auto* table = std::get_if<DocumentTable>(&block)) {
        CHECK_FALSE(table->rows.empty());
        CHECK(std::filesystem::exists(folder.file("a/" + table->id + ".csv")));
      }
    }
  }
  CHECK(play("report " + folder.file("a") + " -o " + folder.file("report.html")).code == 0);
}

TEST_CASE("experiment: what cannot run is said, and the rest goes on") {
  const TemporaryFolder folder;
  const auto result =
      play("experiment invisible-objects octree-or-bvh --quick --repeat 1 --device nonesuch -o " +
           folder.file("a"));
  CHECK(result.code == 2);
  CHECK(result.err.starts_with("error: invisible-objects: --device"));
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  CHECK_THAT(result.out, Catch::Matchers::Contains("LBVH, Morton"));
  const Document document = document_in(folder.file("a"));
  REQUIRE(document.sections.size() == 1);
  CHECK(document.sections[0].id == "octree-or-bvh");
  const auto json = nlohmann::ordered_json::parse(read_file(folder.file("a/experiment.json")));
  REQUIRE(json["failures"].size() == 1);
  CHECK(json["failures"][0]["experiment"] == "invisible-objects");
  const auto report = play("report " + folder.file("a") + " -q -o " + folder.file("report.md"));
  CHECK(report.code == 0);
  CHECK_THAT(read_file(folder.file("report.md")), Catch::Matchers::Contains("1 case failed") &&
                                                      Catch::Matchers::Contains("- invisible-objects: ") &&
                                                      Catch::Matchers::Contains("nonesuch"));
  // When nothing can run there is nothing to go on with, and no file.
  const auto none = play("experiment recording --quick --device nonesuch -o " + folder.file("b"));
  CHECK(none.code == 2);
  CHECK_FALSE(std::filesystem::exists(folder.file("b/experiment.json")));
}

TEST_CASE("experiment: a disk that is full is said, and the rest is measured all the same") {
  const TemporaryFolder folder;
  ProcessOptions full;
  full.most_file_bytes = 500;
  const auto result = run(SCENEPLAY_PROGRAM,
                          words("experiment octree-or-bvh invisible-objects --quick --repeat 1 --size 96x54 "
                                "--samples 1 -o " +
                                folder.file("a")),
                          full);
  CHECK(result.code == 3);
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 2);  // once after each
  CHECK_THAT(result.err,
             Catch::Matchers::StartsWith("error: ") && Catch::Matchers::Contains("experiment.json"));
  // What the program prints goes to a file here, of which the limit leaves the beginning.
  CHECK(result.out.starts_with("Octree or hierarchy of boxes\n"));
  CHECK_FALSE(std::filesystem::exists(folder.file("a/experiment.json")));
}

TEST_CASE("experiment: wrong calls") {
  const TemporaryFolder folder;
  test::write_file(folder.file("file"), "no folder");
  const auto check_error = [&](const std::string& line, int code, const std::string& part) {
    const auto result = play(line);
    INFO(line << ": " << result.err);
    CHECK(result.code == code);
    CHECK(result.out.empty());
    CHECK(result.err.starts_with("error: "));
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
    CHECK_THAT(result.err, Catch::Matchers::Contains(part));
  };
  check_error("experiment octree-or-bhv -o x", 2, "did you mean 'octree-or-bvh'");
  check_error("experiment octree-or-bvh", 2, "--output");
  check_error("experiment --quick -o x", 2, "NAME");
  check_error("experiment octree-or-bvh -o x --repeat 0", 2, "--repeat");
  check_error("experiment merged-batch -o x --camera-path flyy", 2, "did you mean 'fly'");
  check_error("experiment octree-or-bvh --quick -o " + folder.file("file"), 3, "file");
  check_error("experiment octree-or-bvh --quick -o /proc/nowhere", 3, "/proc/nowhere");
}
