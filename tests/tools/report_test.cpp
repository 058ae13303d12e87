// What reports make of figures, and the verb as a user meets it. How the page looks: interop/report_page.
#include <catch2/catch.hpp>
#include <filesystem>

#include "tests/tools/process.h"
#include "tools/report/axis.h"
#include "tools/report/chart.h"
#include "tools/report/report.h"
#include "tools/report/write.h"

using namespace scenegen;
using namespace scenegen::tools;
using nlohmann::ordered_json;

namespace {

DocumentTable one_column(std::vector<double> figures, const std::string& unit = "ms") {
  DocumentTable out{"t", "T", {{"a", "a", unit}}, {}};
  for (const double figure : figures) out.rows.push_back({figure});
  return out;
}

std::vector<std::string> texts(const DocumentTable& table) {
  std::vector<std::string> out;
  const ColumnFormat format = column_format(table, 0);
  for (const auto& row : table.rows) out.push_back(cell_text(row[0], format));
  return out;
}

DocumentTable compared() {
  DocumentTable out{"times", "Times", {}, {}};
  out.columns = {{"case", "case", ""},
                 {"p", "time", "ms", Origin::paper, Better::lower},
                 {"o", "time", "ms", Origin::ours, Better::lower, "p"}};
  out.rows = {{"a|b", 10.0, 5.0}, {"b", 10.0, 10.1}, {"c", 10.0, 30.0}, {"d", {}, 1.0}, {"e", 0.0, 0.5}};
  return out;
}

Document small() {
  Chart chart{"chart", "Chart", "x", "y", {{"ours", {{1, 2, 1.5, 2.5}}}}};
  return {"Title", {{"device", "GPU"}}, {{"one", "First", {"It came out well."}, {compared(), chart}}}};
}

std::string results(const Document& document) {
  return ordered_json{
      {"schema", "sceneplay/experiment"}, {"version", 1}, {"document", document_json(document)}}
      .dump();
}

test::ProcessResult report(const test::TemporaryFolder& folder, const std::string& line) {
  std::vector<std::string> arguments = test::words(line);
  arguments.insert(arguments.begin(), "report");
  return test::run(SCENEPLAY_PROGRAM, arguments, {.folder = folder.path()});
}

}  // namespace

TEST_CASE("figures of a column have as many decimals, so that they can be compared") {
  CHECK(texts(one_column({1.5, 22.26, 100})) == std::vector<std::string>{"1.5", "22.3", "100.0"});
  CHECK(texts(one_column({1, 20, 300})) == std::vector<std::string>{"1", "20", "300"});
  CHECK(texts(one_column({1e-5, 100.7})) == std::vector<std::string>{"0.0000100", "101"});
  CHECK(texts(one_column({-1234567})) == std::vector<std::string>{"\u22121\u202F234\u202F567"});
  CHECK(texts(one_column({1.5e6, 305e6, 21e6}, "B")) == std::vector<std::string>{"1.5", "305.0", "21.0"});
  CHECK(column_format(one_column({1.5e6, 305e6, 21e6}, "B"), 0).unit == "MB");
  CHECK(figure_text(1e300) == "1.00e+300");
}

TEST_CASE("figures of ours are better, level or worse than the paper's") {
  const DocumentTable table = compared();
  CHECK(compare_cell(table, 0, 2)->outcome == Outcome::better);
  CHECK(compare_cell(table, 0, 2)->factor == 2.0);
  CHECK(compare_cell(table, 1, 2)->outcome == Outcome::level);
  CHECK(compare_cell(table, 2, 2)->outcome == Outcome::worse);
  CHECK_FALSE(compare_cell(table, 3, 2));  // no figure of the paper's
  CHECK(compare_cell(table, 4, 2)->outcome == Outcome::worse);
  CHECK_FALSE(compare_cell(table, 4, 2)->factor);  // nothing is so many times 0
  CHECK_FALSE(compare_cell(table, 0, 1));
  DocumentTable rates = table;
  rates.columns[2].better = Better::higher;
  CHECK(compare_cell(rates, 0, 2)->outcome == Outcome::worse);
  CHECK(compare_cell(rates, 2, 2)->factor == 3.0);
  const Tally sum = tally({"s", "S", {}, {table, table}});
  CHECK(sum.better == 2);
  CHECK(sum.level == 2);
  CHECK(sum.worse == 4);
  CHECK(sum.typical() == Approx(10 / 10.1));
}

TEST_CASE("axes have round ticks, whatever the values are") {
  CHECK(make_axis({0.3, 87}, {false, 6, true, true}).ticks == std::vector<double>{0, 20, 40, 60, 80, 100});
  CHECK(make_axis({1, 1000}, {true, 6}).ticks == std::vector<double>{1, 10, 100, 1000});
  const Axis log = make_axis({5, 80}, {true, 8});
  CHECK(log.ticks == std::vector<double>{5, 10, 20, 50});
  CHECK(log.place(20) == Approx(0.5));
  CHECK_FALSE(log.shows(0));
  CHECK(make_axis({10'000, 2e6}, {true, 6}).text(200'000) == "200k");
  const std::vector<std::vector<double>> awkward{
      {},        {0}, {5, 5}, {-1e308, 1e308}, {5e-324, 1e-320}, {1e99, -1e99}, {1, 1 + 1e-15}, {1e-99, 1e99},
      {-3, -2.9}};
  for (const std::vector<double>& values : awkward) {
    for (const bool logarithmic : {false, true}) {
      for (const bool ends : {false, true}) {
        const Axis axis = make_axis(values, {logarithmic, 6, ends, ends});
        INFO(axis.low << " to " << axis.high);
        CHECK(axis.low < axis.high);
        CHECK(axis.ticks.size() <= 20);
        for (const double tick : axis.ticks) CHECK(axis.text(tick).size() < 24);
      }
    }
  }
}

TEST_CASE("one long frame does not press the curves flat, and is told of") {
  Chart chart{"c", "C", "view", "ms", {{"a", {{1, 5, 4, 150}, {2, 6, 5, 7}}}}};
  const auto lines = [&] { return chart_svg(chart, "c", {"", 600, 400}); };
  CHECK(lines().find(">150<") == std::string::npos);
  CHECK(left_out(chart) == "A spread that reaches up to 150 is cut at the top.");
  chart.series[0].points[0].high = 11;
  CHECK(left_out(chart).empty());
  // Whole numbers of views have no tenths between them.
  CHECK(lines().find(">1<") != std::string::npos);
  CHECK(lines().find(">1.4<") == std::string::npos);
  chart.series[0].points[1].x = 2.5;
  CHECK(lines().find(">1.4<") != std::string::npos);
}

TEST_CASE("runs have names that tell them apart") {
  Document cpu = small();
  cpu.facts = {{"processor", "Intel"}};
  Document two = small();
  two.facts.emplace_back("device", "other");
  const RunReport all{"T", {{small(), ""}, {cpu, ""}, {two, ""}}};
  CHECK(run_name(all, 0) == "GPU");
  CHECK(run_name(all, 1) == "Intel");
  CHECK(run_name(all, 2) == "Title");
}

TEST_CASE("the paper's curve has the color of ours of the same name") {
  const Chart chart{
      "c", "C", "x", "y", {{"a (D)", {}, Origin::paper}, {"b", {}}, {"A", {}}, {"c", {}, Origin::paper}}};
  CHECK(series_colors(chart) == std::vector<std::size_t>{1, 0, 1, 2});
}

TEST_CASE("Markdown and CSV say what the page says") {
  const RunReport all{"Both", {{small(), ""}, {small(), ""}}};
  const std::string text = report_markdown(all, "");
  CHECK(text.starts_with("# Both\n\n## At a glance\n"));
  CHECK(text.find("| GPU: First | First | 1 | 1 | 2 | ") != std::string::npos);
  CHECK(text.find("\n## GPU: First, 2\n") != std::string::npos);
  CHECK(text.find("| a\\|b | 10.00 | 5.00 \u2713 2.0\u00D7 |\n") != std::string::npos);
  CHECK(text.find("| c | 10.00 | 30.00 \u2717 3.0\u00D7 |\n") != std::string::npos);
  const auto files = report_csv(all);
  REQUIRE(files.size() == 5);
  CHECK(files[0].first == "_facts.csv");
  CHECK(files[0].second == "run,name,value\n1,device,GPU\n2,device,GPU\n");
  CHECK(files[1].first == "run1_times.csv");
  CHECK(files[1].second == "case,p,o\na|b,10.0,5.0\nb,10.0,10.1\nc,10.0,30.0\nd,,1.0\ne,0.0,0.5\n");
  CHECK(files[4].second == "series,origin,x,y,low,high\nours,ours,1.0,2.0,1.5,2.5\n");
  const ordered_json json = ordered_json::parse(report_json(all));
  CHECK(json["schema"] == "sceneplay/report");
  CHECK(json["runs"].size() == 2);
  CHECK(document_from_json(json["runs"][1], ""));
}

TEST_CASE("what failed is said with its reason, in every form and at the top") {
  Document document = small();
  document.failures = {{"recording", "device lost <&>"}};
  document.sections[0].failures = {
      {"a: octree", "too large"}, {"a: inline", "too large"}, {"b", "device lost <&>"}};
  const RunReport all{"T", {{document, ""}, {small(), ""}}};
  CHECK(failure_count(document) == 4);
  const std::vector<FailureGroup> groups = failures_of(document);
  REQUIRE(groups.size() == 2);
  CHECK(groups[0].cases == std::vector<std::string>{"recording", "b"});
  CHECK(FailureGroup{"", {"a", "b", "c", "d", "e"}}.cases_text(3) == "a; b; c and 2 more");
  CHECK(FailureGroup{"", {"a", "b", "c", "d"}}.cases_text(3) == "a; b; c; d");
  const std::string text = report_markdown(all, "");
  const std::string glance = text.substr(0, text.find("## GPU"));
  CHECK(glance.find("**4 cases failed**\n\n- recording; b: device lost &lt;&amp;\\>\n- a: octree; a: inline: "
                    "too large\n") != std::string::npos);
  Warnings warnings;
  const std::string html = report_html(all, warnings);
  CHECK(html.find("4 cases failed") < html.find("class=\"glance\""));
  CHECK(html.find("<span class=\"case\">a: octree; a: inline</span>: too large") != std::string::npos);
  CHECK(html.find("device lost &lt;&amp;&gt;") != std::string::npos);
  const auto files = report_csv(all);
  CHECK(files[1].first == "_failures.csv");
  CHECK(files[1].second ==
        "run,what,why\n1,recording,device lost <&>\n1,b,device lost <&>\n1,a: octree,too large\n1,a: "
        "inline,too large\n");
  const auto again = document_from_json(ordered_json::parse(report_json(all))["runs"][0], "");
  REQUIRE(again);
  CHECK(failure_count(*again) == 4);
  CHECK(again->sections[0].failures[1].what == "a: inline");
}

TEST_CASE("the paper's tables stand at the top, a line each") {
  Document document = small();
  document.sections[0].verdicts = {
      {"D table 6", "kept | <b>", "13.9 ms", "8.6 ms", Finding::better, "less is recorded"},
      {"D 5.2", "building", "octree faster", "octree slower", Finding::differs, "sorted"}};
  const RunReport all{"T", {{document, ""}}};
  CHECK(finding_of(1, 2, Better::lower) == Finding::better);
  CHECK(finding_of(1, 2, Better::higher) == Finding::worse);
  CHECK(finding_of(1.01, 1, Better::lower) == Finding::level);
  // What is behind stands first.
  const std::string text = report_markdown(all, "");
  CHECK(text.find("**Behind the paper, or not as it says: 1**") <
        text.find("**Ahead of the paper, or as it says: 1**"));
  CHECK(text.find("Level with it") == std::string::npos);
  CHECK(
      text.find("| D table 6 | kept \\| &lt;b\\> | 13.9 ms | 8.6 ms | \u2713 better | less is recorded |\n") <
      text.find("Figures of ours beside the paper's"));
  CHECK(text.find("| \u2260 differs | sorted |\n") != std::string::npos);
  Warnings warnings;
  const std::string html = report_html(all, warnings);
  CHECK(html.find("class=\"verdicts\"") < html.find("class=\"glance\""));
  CHECK(html.find("not as it says: 1</th>") < html.find("octree slower"));
  CHECK(html.find("octree slower") < html.find("or as it says: 1</th>"));
  CHECK(html.find("kept | &lt;b&gt;") != std::string::npos);
  CHECK(html.find("</span> differs</span>") != std::string::npos);
  const auto files = report_csv(all);
  CHECK(files[1].first == "_glance.csv");
  CHECK(files[1].second ==
        "run,source,what,paper,ours,finding,why\n1,D table 6,kept | <b>,13.9 ms,8.6 ms,better,less is "
        "recorded\n"
        "1,D 5.2,building,octree faster,octree slower,differs,sorted\n");
  const auto again = document_from_json(ordered_json::parse(report_json(all))["runs"][0], "");
  REQUIRE(again);
  REQUIRE(again->sections[0].verdicts.size() == 2);
  CHECK(again->sections[0].verdicts[1].finding == Finding::differs);
  CHECK(again->sections[0].verdicts[0].why == "less is recorded");
}

TEST_CASE("failures of experiments are in the report") {
  const test::TemporaryFolder folder;
  ordered_json json = ordered_json::parse(results(small()));
  json["failures"] = {{{"experiment", "recording"}, {"error", "device 'X': lost"}}};
  test::write_file(folder.file("r.json"), json.dump());
  const test::ProcessResult page = report(folder, "r.json -o r.md");
  CHECK(page.code == 0);
  CHECK(page.err == "r.md  1 run  1 section  1 case failed\n");
  CHECK(test::read_file(folder.file("r.md")).find("- recording: device 'X': lost\n") != std::string::npos);
  json["failures"][0].erase("error");
  test::write_file(folder.file("r.json"), json.dump());
  CHECK(report(folder, "r.json -o x.md").err ==
        "error: r.json: /failures/0: has no text experiment or no text error\n");
}

TEST_CASE("sceneplay report takes files and folders and writes every form") {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder.file("all/b"));
  std::filesystem::create_directories(folder.file("all/a"));
  Document second = small();
  second.facts[0].second = "Other GPU";
  test::write_file(folder.file("all/a/experiment.json"), results(second));
  test::write_file(folder.file("all/b/experiment.json"), results(small()));
  const test::ProcessResult page = report(folder, "all -o report.html");
  CHECK(page.err == "report.html  2 runs  2 sections\n");
  REQUIRE(page.code == 0);
  const std::string html = test::read_file(folder.file("report.html"));
  CHECK(html.find("<h2>Other GPU</h2>") < html.find("<h2>GPU</h2>"));
  CHECK(html.find("better than the paper in <strong>1</strong> of 4 figures") != std::string::npos);
  CHECK(report(folder, "all/a -o report.md").code == 0);
  CHECK(test::read_file(folder.file("report.md")).starts_with("# Title\n"));
  CHECK(report(folder, "all/a/experiment.json -o tables --format csv -q").code == 0);
  CHECK(std::filesystem::exists(folder.file("tables/times.csv")));
  CHECK(report(folder, "all/a -o - --format csv").out.starts_with("# _facts.csv\nrun,name,value\n"));
  CHECK(ordered_json::parse(report(folder, "all/a -o - --format json --title X").out)["title"] == "X");
}

TEST_CASE("sceneplay report says what is wrong in one line, and leaves nothing behind") {
  const test::TemporaryFolder folder;
  const auto refused = [&](const std::string& line, int code, const std::string& message) {
    const test::ProcessResult result = report(folder, line);
    CHECK(result.code == code);
    CHECK(result.err == "error: " + message + "\n");
  };
  std::filesystem::create_directories(folder.file("empty"));
  test::write_file(folder.file("good.json"), results(small()));
  refused("good.json", 2, "--output: is missing (a file, or - for stdout; with --format csv a folder)");
  refused("gone.json -o x.html", 3, "gone.json: cannot be read");
  refused("empty -o x.html", 3,
          "empty: neither this folder nor one in it holds an experiment.json or bench.json");
  refused("good.json -o nowhere/x.html", 3, "nowhere/x.html: cannot be written: No such file or directory");
  refused("good.json -o good.json", 2, "--output: would overwrite 'good.json', which is read (RESULTS)");
  refused("good.json -o good.json --format csv", 3,
          "good.json: is no folder: --format csv writes one file a table");
  const auto damaged = [&](const std::string& text, const std::string& message) {
    test::write_file(folder.file("bad.json"), text);
    const test::ProcessResult result = report(folder, "bad.json -o x.html");
    CHECK(result.code == 1);
    CHECK(result.err.starts_with("error: bad.json" + message));
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  };
  damaged("", ": is damaged: parse error");
  damaged("[1, 2", ": is damaged: parse error");
  damaged("[1, 2]", ": is no results file: it has no schema\n");
  damaged(R"({"schema": "sceneplay/experimnt"})",
          ": /schema: unknown schema 'sceneplay/experimnt' (did you mean 'sceneplay/experiment'?");
  damaged(R"({"schema": "sceneplay/experiment", "version": 2})", ": /version: is 2; this program reads 1\n");
  damaged(R"({"schema": "sceneplay/experiment", "version": 1})", ": /document: is missing\n");
  damaged(R"({"schema": "sceneplay/experiment", "version": 1, "document": {"title": 1}})",
          ": /document/title: is not text\n");
  damaged(std::string(200'000, '['), ": is damaged: it is nested deeper than 64 levels");
  damaged(R"({"schema":"sceneplay/experiment","version":)" + std::string(200'000, '[') +
              std::string(200'000, ']') + "}",
          ": is damaged: it is nested deeper than 64 levels");
  CHECK_FALSE(std::filesystem::exists(folder.file("x.html")));
}

TEST_CASE("a picture that cannot be shown is a warning and words in its place") {
  const test::TemporaryFolder folder;
  Document document = small();
  document.sections[0].blocks = {Picture{"gone", "Gone", "gone.png"}, Picture{"bad", "Bad", "bad.png"},
                                 Picture{"out", "Out", "out.png"}};
  std::filesystem::create_directories(folder.file("r"));
  test::write_file(folder.file("r/experiment.json"), results(document));
  test::write_file(folder.file("r/bad.png"), "\x89PNG\r\n\x1a\n but damaged, and long enough for a head");
  test::write_file(folder.file("secret.png"), "\x89PNG\r\n\x1a\n");
  std::filesystem::create_symlink("../secret.png", folder.file("r/out.png"));
  const test::ProcessResult result = report(folder, "r -o x.html --quiet");
  CHECK(result.code == 0);
  CHECK(result.err.find("warning: r/gone.png: there is no such picture\n") != std::string::npos);
  CHECK(result.err.find("warning: r/bad.png: ") != std::string::npos);
  CHECK(result.err.find("warning: r/out.png: leads out of the folder of the results\n") != std::string::npos);
  const std::string html = test::read_file(folder.file("x.html"));
  CHECK(html.find("<img") == std::string::npos);
  CHECK(html.find("The picture gone.png cannot be shown: there is no such picture.") != std::string::npos);
}
