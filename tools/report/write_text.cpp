// Reports as Markdown, CSV and JSON.
#include <algorithm>
#include <filesystem>

#include "tools/output.h"
#include "tools/report/write.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

// ---- Markdown --------------------------------------------------------------------------------------------

/// Text of a stranger in one line: nothing in it is markup.
std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '&') {
      out += "&amp;";
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += ' ';
    } else {
      if (std::string_view("\\`*_[]|#~>").find(c) != std::string_view::npos) out += '\\';
      out += c;
    }
  }
  const bool list = !out.empty() && std::string_view("-+=").find(out.front()) != std::string_view::npos;
  return list ? "\\" + out : out;
}

std::string row_text(const std::vector<std::string>& cells) {
  std::string out = "|";
  for (const std::string& cell : cells) out += " " + cell + " |";
  return out + "\n";
}

std::string rule_text(const std::vector<bool>& right) {
  std::string out = "|";
  for (const bool r : right) out += r ? "---:|" : "---|";
  return out + "\n";
}

std::string mark(const Comparison& comparison) {
  if (comparison.outcome == Outcome::level) return " \u2248";
  const std::string sign = comparison.outcome == Outcome::better ? " \u2713" : " \u2717";
  return comparison.factor
             ? sign + " " + factor_text(std::max(*comparison.factor, 1 / *comparison.factor)) + "\u00D7"
             : sign;
}

std::string block_text(const DocumentTable& table, const std::string& /*folder*/) {
  std::vector<ColumnFormat> formats;
  std::vector<std::string> heads;
  std::vector<bool> right;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const Column& column = table.columns[i];
    formats.push_back(column_format(table, i));
    right.push_back(formats.back().numeric);
    std::string head = plain(column.title);
    if (!formats.back().unit.empty()) head += ", " + plain(formats.back().unit);
    heads.push_back(column.origin == Origin::paper ? "*" + head + "*" : head);
  }
  std::string out = "**" + plain(table.title) + "**\n\n" + row_text(heads) + rule_text(right);
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    std::vector<std::string> cells;
    for (std::size_t i = 0; i < formats.size(); ++i) {
      cells.push_back(plain(cell_text(table.rows[row][i], formats[i])));
      if (const auto comparison = compare_cell(table, row, i)) cells.back() += mark(*comparison);
    }
    out += row_text(cells);
  }
  return out + "\n" + (table.note.empty() ? "" : plain(table.note) + "\n\n");
}

std::string block_text(const Chart& chart, const std::string& /*folder*/) {
  constexpr std::size_t kMost = 400;
  std::size_t count = 0;
  for (const Series& series : chart.series) count += series.points.size();
  std::string out = "**" + plain(chart.title) + "**\n\n";
  if (count > kMost) {
    out += counted(count, "point") + "; `--format csv` has them.\n\n";
  } else {
    out += row_text({"curve", plain(chart.x_title), plain(chart.y_title), "low", "high"}) +
           rule_text({false, true, true, true, true});
    const auto figure = [](const std::optional<double>& value) {
      return value ? figure_text(*value, 4) : std::string("\u2013");
    };
    for (const Series& series : chart.series) {
      const std::string name = plain(series.name);
      for (const ChartPoint& point : series.points)
        out += row_text({series.origin == Origin::paper ? "*" + name + "*" : name, figure(point.x),
                         figure(point.y), figure(point.low), figure(point.high)});
    }
    out += "\n";
  }
  return out + (chart.note.empty() ? "" : plain(chart.note) + "\n\n");
}

/// A path as the target of a link.
std::string link(const std::string& path) {
  constexpr std::string_view kHex = "0123456789ABCDEF";
  std::string out;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= 0x20 || byte >= 0x7F ||
        std::string_view("()<>[]\\\"%#?:").find(c) != std::string_view::npos) {
      out.append("%").append(1, kHex[byte >> 4U]).append(1, kHex[byte & 15U]);
    } else {
      out += c;
    }
  }
  return out;
}

std::string block_text(const Picture& picture, const std::string& folder) {
  const std::string file = (std::filesystem::path(folder) / picture.file).lexically_normal().generic_string();
  return "![" + plain(picture.title) + "](" + link(file) + ")\n\n" +
         (picture.note.empty() ? "" : plain(picture.note) + "\n\n");
}

/// One line a reason; empty when nothing failed.
std::string failures_text(const Document& document, std::size_t most) {
  const std::size_t count = failure_count(document);
  if (count == 0) return {};
  std::string out = "**" + counted(count, "case") + " failed**\n\n";
  for (const FailureGroup& group : failures_of(document))
    out += "- " + plain(group.cases_text(most)) + ": " + plain(group.why) + "\n";
  return out + "\n";
}

std::string verdicts_text(const Document& document) {
  std::string out;
  for (const VerdictGroup& group : verdict_groups(document)) {
    out += "**" + plain(group.title) + ": " + std::to_string(group.verdicts.size()) + "**\n\n" +
           row_text({"paper's table", "what", "paper", "ours", "finding", "why"}) +
           rule_text({false, false, true, true, false, false});
    for (const Verdict* v : group.verdicts)
      out += row_text({plain(v->source), plain(v->what), plain(v->paper), plain(v->ours),
                       std::string(sign_of(v->finding)) + " " + std::string(word_of(v->finding)),
                       plain(v->why)});
    out += "\n";
  }
  return out;
}

/// With the run's name above each where there are several.
std::string verdicts_of_runs(const RunReport& report) {
  std::string out;
  for (std::size_t run = 0; run < report.runs.size(); ++run) {
    const std::string verdicts = verdicts_text(report.runs[run].document);
    if (!verdicts.empty() && report.runs.size() > 1) out += "### " + plain(run_name(report, run)) + "\n\n";
    out += verdicts;
  }
  return out;
}

std::string summary_text(const RunReport& report) {
  std::vector<std::string> heads{"experiment", "better", "level", "worse", "typically", "what came out"};
  std::vector<bool> right{false, true, true, true, true, false};
  if (report.runs.size() > 1) heads.insert(heads.begin(), "run"), right.insert(right.begin(), false);
  std::string out = "## At a glance\n\n" + verdicts_of_runs(report) +
                    "Figures of ours beside the paper's: \u2713 better, \u2248 level (within 2 %), "
                    "\u2717 worse.\n\n" +
                    row_text(heads) + rule_text(right);
  for (std::size_t run = 0; run < report.runs.size(); ++run) {
    for (const DocumentSection& section : report.runs[run].document.sections) {
      const Tally t = tally(section);
      const auto count = [&](std::size_t n) { return t.count() == 0 ? "" : std::to_string(n); };
      const auto typical = t.typical();
      std::vector<std::string> cells{plain(section.title),
                                     count(t.better),
                                     count(t.level),
                                     count(t.worse),
                                     typical ? factor_text(std::max(*typical, 1 / *typical)) + "\u00D7 " +
                                                   (*typical >= 1 ? "better" : "worse")
                                             : "",
                                     section.paragraphs.empty() ? "" : plain(section.paragraphs.front())};
      if (report.runs.size() > 1) cells.insert(cells.begin(), plain(run_name(report, run)));
      out += row_text(cells);
    }
  }
  out += "\n";
  for (std::size_t run = 0; run < report.runs.size(); ++run) {
    const std::string failures = failures_text(report.runs[run].document, 3);
    out += failures.empty() || report.runs.size() == 1 ? failures
                                                       : plain(run_name(report, run)) + ":\n\n" + failures;
  }
  return out;
}

/// The way from one folder to another, or the other itself when there is none.
std::string way(const std::string& from, const std::string& to) {
  std::error_code error;
  const std::filesystem::path out =
      std::filesystem::relative(to.empty() ? "." : to, from.empty() ? "." : from, error);
  return error || out.empty() ? to : out.string();
}

// ---- CSV -------------------------------------------------------------------------------------------------

ordered_json csv_cell(const Cell& cell) {
  if (const auto* figure = std::get_if<double>(&cell)) return *figure;
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return nullptr;
}

std::string table_csv(const DocumentTable& table) {
  std::vector<Table::Column> columns;
  for (const Column& column : table.columns) columns.push_back({column.name, column.title});
  Table out(std::move(columns));
  for (const auto& row : table.rows) {
    std::vector<ordered_json> cells;
    cells.reserve(row.size());
    for (const Cell& cell : row) cells.push_back(csv_cell(cell));
    out.row(std::move(cells));
  }
  return out.str(Format::csv);
}

std::string chart_csv(const Chart& chart) {
  Table out({{"series", ""}, {"origin", ""}, {"x", ""}, {"y", ""}, {"low", ""}, {"high", ""}});
  const auto optional = [](const std::optional<double>& value) {
    return value ? ordered_json(*value) : ordered_json();
  };
  for (const Series& series : chart.series) {
    const std::string origin = series.origin == Origin::paper ? "paper" : "ours";
    for (const ChartPoint& point : series.points)
      out.row({series.name, origin, point.x, point.y, optional(point.low), optional(point.high)});
  }
  return out.str(Format::csv);
}

}  // namespace

std::string report_markdown(const RunReport& report, const std::string& folder) {
  std::string out = "# " + plain(report.title) + "\n\n" + summary_text(report);
  for (std::size_t number = 0; number < report.runs.size(); ++number) {
    const ReportRun& run = report.runs[number];
    out += "## " + plain(run_name(report, number)) + "\n\n";
    for (const auto& [name, value] : run.document.facts)
      out += "- " + plain(name) + ": " + plain(value) + "\n";
    if (!run.document.facts.empty()) out += "\n";
    out += failures_text(run.document, 100);
    const std::string pictures = way(folder, run.folder);
    for (const DocumentSection& section : run.document.sections) {
      out += "### " + plain(section.title) + "\n\n";
      for (const std::string& paragraph : section.paragraphs) out += plain(paragraph) + "\n\n";
      for (const Block& block : section.blocks)
        out += std::visit([&](const auto& b) { return block_text(b, pictures); }, block);
    }
  }
  while (out.ends_with("\n\n")) out.pop_back();
  return out;
}

std::vector<std::pair<std::string, std::string>> report_csv(const RunReport& report) {
  Table facts({{"run", ""}, {"name", ""}, {"value", ""}});
  Table failures({{"run", ""}, {"what", ""}, {"why", ""}});
  bool failed = false;
  Table verdicts(
      {{"run", ""}, {"source", ""}, {"what", ""}, {"paper", ""}, {"ours", ""}, {"finding", ""}, {"why", ""}});
  bool judged = false;
  std::vector<std::pair<std::string, std::string>> out;
  for (std::size_t run = 0; run < report.runs.size(); ++run) {
    const Document& document = report.runs[run].document;
    for (const auto& [name, value] : document.facts) facts.row({run + 1, name, value});
    for (const FailureGroup& group : failures_of(document)) {
      for (const std::string& what : group.cases) failures.row({run + 1, what, group.why});
      failed = true;
    }
    const std::string prefix = report.runs.size() > 1 ? "run" + std::to_string(run + 1) + "_" : "";
    for (const DocumentSection& section : document.sections) {
      for (const Verdict& v : section.verdicts) {
        verdicts.row({run + 1, v.source, v.what, v.paper, v.ours, word_of(v.finding), v.why});
        judged = true;
      }
      for (const Block& block : section.blocks) {
        if (const auto* table = std::get_if<DocumentTable>(&block))
          out.emplace_back(prefix + table->id + ".csv", table_csv(*table));
        if (const auto* chart = std::get_if<Chart>(&block))
          out.emplace_back(prefix + chart->id + ".chart.csv", chart_csv(*chart));
      }
    }
  }
  // With an underscore in front, no table can have this name.
  out.emplace(out.begin(), "_facts.csv", facts.str(Format::csv));
  if (judged) out.emplace(out.begin() + 1, "_glance.csv", verdicts.str(Format::csv));
  if (failed) out.emplace(out.begin() + 1, "_failures.csv", failures.str(Format::csv));
  return out;
}

std::string report_json(const RunReport& report) {
  ordered_json runs = ordered_json::array();
  for (const ReportRun& run : report.runs) runs.push_back(document_json(run.document));
  return pretty(
      {{"schema", "sceneplay/report"}, {"version", 1}, {"title", report.title}, {"runs", std::move(runs)}});
}

}  // namespace scenegen::tools
