#include <catch2/catch.hpp>
#include <limits>

#include "tools/report/document.h"

using namespace scenegen;
using namespace scenegen::tools;
using nlohmann::ordered_json;

namespace {

/// One of everything, with every member set to something else than its default.
Document full() {
  Document out{"Laboratory <1>", {{"device", "llvmpipe"}, {"seed", "7"}}, {}};
  DocumentTable table{
      "times", "Frame times", {}, {{"C = 0.5", 57.4, 12.25}, {"C = 1", {}, 11.0}}, "paper's from D 5.6"};
  table.columns = {{"case", "case", ""},
                   {"paperMs", "paper", "ms", Origin::paper, Better::lower},
                   {"frameMs", "frame", "ms", Origin::ours, Better::lower, "paperMs", 4}};
  Chart chart{"sweep", "Sweep", "C", "frame time, ms", {}, true, true, "log"};
  chart.series = {{"ours", {{0.1, 2.0, 1.5, 2.5}, {1.0, 3.0}}},
                  {"adaptive (D)", {{0.1, 52.0, {}, 53.0}}, Origin::paper}};
  out.sections.push_back({"d56",
                          "D 5.6",
                          {"Faster.", "Why."},
                          {table, chart, Picture{"view", "The town", "a/town.png", "end"}}});
  out.sections.push_back({"d57", "D 5.7", {}, {}});
  return out;
}

std::string error_of(const ordered_json& json) {
  const Result<Document> read = document_from_json(json, "x.json: /document");
  return read ? "" : read.error().str();
}

/// The error when the value at `pointer` of a good document is replaced.
std::string error_with(const std::string& pointer, const ordered_json& value) {
  ordered_json json = document_json(full());
  json[ordered_json::json_pointer(pointer)] = value;
  return error_of(json);
}

std::string error_without(const std::string& parent, const std::string& name) {
  ordered_json json = document_json(full());
  json[ordered_json::json_pointer(parent)].erase(name);
  return error_of(json);
}

}  // namespace

TEST_CASE("a document comes back from JSON as it was") {
  const ordered_json json = document_json(full());
  const Result<Document> read = document_from_json(ordered_json::parse(json.dump()), "");
  REQUIRE(read);
  CHECK(document_json(*read) == json);
  REQUIRE(read->sections.size() == 2);
  REQUIRE(read->sections[0].blocks.size() == 3);
  const auto& table = std::get<DocumentTable>(read->sections[0].blocks[0]);
  CHECK(table.columns[2].against == "paperMs");
  CHECK(table.columns[2].better == Better::lower);
  CHECK(table.columns[2].digits == 4);
  CHECK(table.columns[1].origin == Origin::paper);
  CHECK(std::holds_alternative<std::monostate>(table.rows[1][1]));
  CHECK(std::get<double>(table.rows[0][2]) == 12.25);
  const auto& chart = std::get<Chart>(read->sections[0].blocks[1]);
  CHECK(chart.log_x);
  CHECK(chart.log_y);
  CHECK(chart.series[1].origin == Origin::paper);
  CHECK(chart.series[0].points[0].low == 1.5);
  CHECK_FALSE(chart.series[1].points[0].low);
  CHECK(chart.series[1].points[0].high == 53.0);
  CHECK(std::get<Picture>(read->sections[0].blocks[2]).file == "a/town.png");
}

TEST_CASE("figures that are no numbers become nothing") {
  Document document = full();
  auto& blocks = document.sections[0].blocks;
  std::get<DocumentTable>(blocks[0]).rows[0][2] = std::numeric_limits<double>::infinity();
  std::get<Chart>(blocks[1]).series[0].points[0].y = std::numeric_limits<double>::quiet_NaN();
  const Result<Document> read = document_from_json(ordered_json::parse(document_json(document).dump()), "");
  REQUIRE(read);
  const auto& read_blocks = read->sections[0].blocks;
  CHECK(std::holds_alternative<std::monostate>(std::get<DocumentTable>(read_blocks[0]).rows[0][2]));
  CHECK(std::get<Chart>(read_blocks[1]).series[0].points.size() == 1);
}

TEST_CASE("a section, a table and a chart may have the same id, two tables may not") {
  CHECK(error_with("/sections/0/blocks/0/id", "d56").empty());
  CHECK(error_with("/sections/0/blocks/1/id", "times").empty());
  Document document = full();
  document.sections[1].blocks.push_back(document.sections[0].blocks[0]);
  CHECK(error_of(document_json(document)) ==
        "x.json: /document/sections/1/blocks/0/id: 'times' is there twice");
}

TEST_CASE("what later versions add and what has a default may differ") {
  CHECK(error_with("/sections/0/more", 1).empty());
  CHECK(error_without("/sections/0/blocks/0", "note").empty());
  CHECK(error_without("/sections/0/blocks/0/columns/0", "unit").empty());
  CHECK(error_without("/sections/0/blocks/1", "logX").empty());
}

TEST_CASE("damaged documents are refused at their place") {
  CHECK(error_of(3) == "x.json: /document: is not an object");
  CHECK(error_without("", "title") == "x.json: /document/title: is missing");
  CHECK(error_without("/sections/0/blocks/0", "rows") ==
        "x.json: /document/sections/0/blocks/0/rows: is missing");
  CHECK(error_with("/title", 4) == "x.json: /document/title: is not text");
  CHECK(error_with("/title", std::string(2000, 'a')) ==
        "x.json: /document/title: has 2000 bytes; at most 1000");
  CHECK(error_with("/facts", "x") == "x.json: /document/facts: is not an array");
  CHECK(error_with("/sections/1/id", "d56") == "x.json: /document/sections/1/id: 'd56' is there twice");
  CHECK(error_with("/sections/1/id", "../x") ==
        "x.json: /document/sections/1/id: is not a word of letters, digits, - and _");
  const std::string table = "/sections/0/blocks/0";
  const std::string at = "x.json: /document" + table;
  CHECK(error_with(table + "/kind", "tabel") ==
        at + "/kind: unknown value 'tabel' (did you mean 'table'? one of: table, chart, picture)");
  CHECK(error_with(table + "/rows/1", {1, 2}) == at + "/rows/1: has 2 cells; the table has 3 columns");
  CHECK(error_with(table + "/rows/1/0", true) == at + "/rows/1/0: is neither a number, nor text, nor null");
  CHECK(error_with(table + "/columns", ordered_json::array()) == at + "/columns: is empty");
  CHECK(error_with(table + "/columns/1/name", "case") == at + "/columns/1/name: 'case' is there twice");
  CHECK(error_with(table + "/columns/2/against", "paprMs") ==
        at + "/columns/2/against: unknown column of the paper's 'paprMs' (did you mean 'paperMs'? one of: "
             "paperMs)");
  CHECK(error_with(table + "/columns/2/against", 5) == at + "/columns/2/against: is not text");
  CHECK(error_with(table + "/columns/2/digits", 1e9) ==
        at + "/columns/2/digits: is not a whole number from 1 to 17");
  CHECK(error_with(table + "/columns/2/better", "more").starts_with(at + "/columns/2/better: unknown value"));
  const std::string chart = "/sections/0/blocks/1";
  CHECK(error_with(chart + "/series/0/points/0/x", nullptr) ==
        "x.json: /document" + chart + "/series/0/points/0/x: is not a finite number");
  CHECK(error_with(chart + "/series/0/points/0/low", 9) ==
        "x.json: /document" + chart + "/series/0/points/0: low is above high");
  CHECK(error_with(chart + "/logX", "yes") ==
        "x.json: /document" + chart + "/logX: is neither true nor false");
  for (const char* file : {"/etc/passwd", "../../secret.png", "a/../../b.png", "", "a\\..\\b"}) {
    INFO(file);
    CHECK(error_with("/sections/0/blocks/2/file", file) ==
          "x.json: /document/sections/0/blocks/2/file: is not a path below the folder of the results");
  }
}

TEST_CASE("no part of a document can be of the wrong kind without an error, and nothing throws") {
  const ordered_json good = document_json(full());
  const ordered_json flat = good.flatten();
  const std::vector<ordered_json> wrong{ordered_json::object(), ordered_json::array({ordered_json::array()}),
                                        true};
  for (const auto& [pointer, value] : flat.items()) {
    for (const ordered_json& other : wrong) {
      if (value.is_boolean() && other.is_boolean()) continue;
      INFO(pointer << " = " << other.dump());
      CHECK_FALSE(error_with(pointer, other).empty());
    }
  }
}
