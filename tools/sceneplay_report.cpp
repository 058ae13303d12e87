// sceneplay report RESULTS... -o FILE: what was measured, as a page, text or tables.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "tools/bench_report.h"
#include "tools/output.h"
#include "tools/report/read_results.h"
#include "tools/report/write.h"
#include "tools/sceneplay.h"
#include "tools/verb.h"

namespace scenegen::tools {
namespace {

namespace fs = std::filesystem;

enum class ReportFormat : std::uint8_t { by_name, html, md, csv, json };

struct ReportRequest {
  std::vector<std::string> results;
  std::string output, title;
  ReportFormat format = ReportFormat::by_name;
  bool quiet = false;

  [[nodiscard]] ReportFormat chosen() const {
    if (format != ReportFormat::by_name) return format;
    const std::string ending = fs::path(output).extension().string();
    if (ending == ".md") return ReportFormat::md;
    if (ending == ".json") return ReportFormat::json;
    return ReportFormat::html;
  }
};

Result<void> check(const ReportRequest& r) {
  if (r.output.empty())
    return fail(ErrorKind::usage, "--output",
                "is missing (a file, or - for stdout; with --format csv a folder)");
  std::error_code error;
  if (r.output != "-" && r.chosen() == ReportFormat::csv) {
    if (fs::exists(r.output, error) && !fs::is_directory(r.output, error))
      return fail(ErrorKind::io, r.output, "is no folder: --format csv writes one file a table");
    return {};
  }
  return r.output == "-" ? Result<void>() : check_output_file(r.output);
}

Result<RunReport> read_all(const ReportRequest& r, std::vector<std::string>& files) {
  for (const std::string& path : r.results) {
    Result<std::vector<std::string>> found = results_files(path);
    if (!found) return forward_error(found);
    files.insert(files.end(), found->begin(), found->end());
  }
  RunReport out{r.title, {}};
  std::vector<nlohmann::ordered_json> benches;
  for (const std::string& file : files) {
    Result<std::string> schema = results_schema(file);
    if (!schema) return forward_error(schema);
    if (*schema == kBenchSchema) {
      auto bench = read_bench(file);
      if (!bench) return forward_error(bench);
      benches.push_back(std::move(*bench));
      continue;
    }
    Result<ReportRun> run = read_results(file);
    if (!run) return forward_error(run);
    out.runs.push_back(std::move(*run));
  }
  // Benchmarks stand together, so that other renderers' figures are beside ours.
  if (!benches.empty()) out.runs.push_back({bench_document(benches), ""});
  if (out.title.empty()) {
    const std::string& first = out.runs.front().document.title;
    const bool same = std::all_of(out.runs.begin(), out.runs.end(),
                                  [&](const ReportRun& run) { return run.document.title == first; });
    out.title = same ? first : "Measurements";
  }
  return out;
}

Result<void> write_csv(const ReportRequest& r, const RunReport& report) {
  const auto files = report_csv(report);
  if (r.output == "-") {
    std::string all;
    for (const auto& [name, text] : files) {
      all.append(all.empty() ? "# " : "\n# ").append(name).append("\n").append(text);
    }
    return write_stdout(all);
  }
  std::error_code error;
  fs::create_directories(r.output, error);
  if (error) return fail(ErrorKind::io, r.output, "cannot be made: " + error.message());
  for (const auto& [name, text] : files) {
    if (auto written = write_file((fs::path(r.output) / name).string(), text); !written) return written;
  }
  return {};
}

Result<void> write_report(const ReportRequest& r, const RunReport& report, Warnings& warnings) {
  const std::string folder = r.output == "-" ? "" : fs::path(r.output).parent_path().string();
  switch (r.chosen()) {
    case ReportFormat::md:
      return write_file(r.output, report_markdown(report, folder));
    case ReportFormat::json:
      return write_file(r.output, report_json(report));
    case ReportFormat::csv:
      return write_csv(r, report);
    default:
      return write_file(r.output, report_html(report, warnings));
  }
}

Result<int> run(const ReportRequest& r) {
  std::vector<std::string> files;
  const Result<RunReport> report = read_all(r, files);
  if (!report) return tl::unexpected(report.error());
  std::vector<NamedPath> inputs;
  inputs.reserve(files.size());
  for (const std::string& file : files) inputs.push_back({"RESULTS", file});
  if (auto apart = check_distinct_files({{"--output", r.output}}, inputs); !apart)
    return forward_error(apart);
  Warnings warnings;
  if (auto written = write_report(r, *report, warnings); !written) return forward_error(written);
  for (const std::string& warning : warnings)
    std::fprintf(stderr, "warning: %s\n", printable(warning).c_str());
  if (!r.quiet && r.output != "-") {
    std::size_t sections = 0;
    std::size_t failures = 0;
    for (const ReportRun& one : report->runs) {
      sections += one.document.sections.size();
      failures += failure_count(one.document);
    }
    const std::string failed = failures == 0 ? "" : "  " + counted(failures, "case") + " failed";
    std::fprintf(stderr, "%s  %s  %s%s\n", printable(r.output).c_str(),
                 counted(report->runs.size(), "run").c_str(), counted(sections, "section").c_str(),
                 failed.c_str());
  }
  return 0;
}

}  // namespace

int report_verb(std::span<const std::string> arguments) {
  ReportRequest r;
  Options options("sceneplay report", {"sceneplay report RESULTS... -o FILE [options]"},
                  "makes a page, a text or tables of what experiments and benchmarks found.");
  options.positional("RESULTS...", r.results,
                     "experiment.json or bench.json, or folders that hold them; each becomes a part of the "
                     "report, named after its device");
  options.group("Report");
  options.add("-o,--output", text_value(r.output, "FILE"),
              "the file to write (- is stdout); with --format csv a folder: a file a table and chart");
  options.add("--format",
              choice_value<ReportFormat>(r.format,
                                         {{"html", ReportFormat::html},
                                          {"md", ReportFormat::md},
                                          {"csv", ReportFormat::csv},
                                          {"json", ReportFormat::json}},
                                         "FORMAT"),
              "html: one page that needs no network; md: Markdown, pictures as links", Role::run,
              "by the file's ending, else html");
  options.add("--title", text_value(r.title, "TEXT"), "heading of the report", Role::run,
              "that of the results");
  options.group("General");
  options.add_general(r.quiet);
  return run_verb(options, arguments, {.check = [&] { return check(r); }, .work = [&] { return run(r); }});
}

}  // namespace scenegen::tools
