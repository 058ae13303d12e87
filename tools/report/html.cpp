// The page: head, what came out at a glance, and the runs one after another.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tools/report/chart.h"
#include "tools/report/html_blocks.h"
#include "tools/report/style.h"
#include "tools/report/write.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

std::string tenths(double value) {
  std::array<char, 32> buffer{};
  (void)std::snprintf(buffer.data(), buffer.size(), "%.1f", value);
  return buffer.data();
}

std::string element(const std::string& name, const std::string& text) {
  return "<" + name + ">" + escaped(text) + "</" + name + ">\n";
}

// ---- At a glance -----------------------------------------------------------------------------------------

/// Factors on a line: better to the right of 1, worse to the left.
constexpr double kStripWidth = 300;

/// Decimal logarithm at the ends of all strips of the report.
double strip_reach(const std::vector<Tally>& tallies) {
  constexpr double kMost = 4;
  double reach = std::log10(3.0);
  for (const Tally& t : tallies) {
    for (const Comparison& c : t.all) {
      if (c.factor) reach = std::max(reach, std::min(kMost, std::abs(std::log10(*c.factor))));
    }
  }
  return reach * 1.06;
}

std::string strip_dot(const Comparison& comparison, double x, double y) {
  const std::string place = tenths(x) + " " + tenths(y);
  if (comparison.outcome == Outcome::worse)
    return "<path class=\"worse\" d=\"M" + place + "m-3 -3l6 6m0 -6l-6 6\"/>";
  return "<path class=\"" + std::string(comparison.outcome == Outcome::better ? "better" : "level") +
         "\" d=\"M" + place + "m-3.2 0a3.2 3.2 0 1 0 6.4 0a3.2 3.2 0 1 0 -6.4 0z\"/>";
}

std::string tally_words(const Tally& t) {
  std::string out = std::to_string(t.better) + " better, " + std::to_string(t.level) + " level, " +
                    std::to_string(t.worse) + " worse";
  if (const auto typical = t.typical()) {
    out += "; typically " + factor_text(std::max(*typical, 1 / *typical)) + " times " +
           (*typical >= 1 ? "better" : "worse");
  }
  return out;
}

std::string strip_svg(const Tally& t, double reach) {
  const auto place = [reach](double factor) {
    const double share = std::clamp(std::log10(factor) / reach, -1.0, 1.0);
    return kStripWidth / 2 + share * (kStripWidth / 2 - 8);
  };
  std::string out = "<svg class=\"strip\" viewBox=\"0 0 300 40\" role=\"img\"><title>" +
                    escaped(tally_words(t)) + "</title>";
  std::string lines = "M0 12.0H300";
  std::string texts;
  const auto tick = [&](double factor, const std::string& text) {
    const std::string x = tenths(place(factor));
    lines += "M" + x + " 0V24";
    texts += "<text class=\"tick middle\" x=\"" + x + "\" y=\"37\">" + text + "</text>";
  };
  tick(1, "1\u00D7");
  // One more number on each side, where it is clear of the words at the ends and of the middle.
  double step = 2;
  for (const double larger : {3.0, 5.0, 10.0, 30.0, 100.0}) {
    if (std::log10(larger) <= 0.7 * reach) step = larger;
  }
  tick(step, figure_text(step) + "\u00D7");
  tick(1 / step, figure_text(step) + "\u00D7");
  texts +=
      "<text class=\"tick\" x=\"0\" y=\"37\">worse</text><text class=\"tick end\" x=\"300\" "
      "y=\"37\">better</text>";
  out += "<path class=\"grid\" d=\"" + lines + "\"/>" + texts;
  for (std::size_t i = 0; i < t.all.size(); ++i) {
    constexpr std::array<double, 5> kRows{12, 7, 17, 4.5, 19.5};  // so that equal ones do not hide each other
    if (t.all[i].factor) out += strip_dot(t.all[i], place(*t.all[i].factor), kRows[i % kRows.size()]);
  }
  return out + "</svg>";
}

std::string counts_html(const Tally& t) {
  const auto part = [](const char* kind, const char* sign, std::size_t count) {
    if (count == 0) return std::string();
    return "<span class=\"" + std::string(kind) + "\"><span aria-hidden=\"true\">" + sign + "</span> " +
           std::to_string(count) + " " + kind + "</span> ";
  };
  std::string out = "<p class=\"counts\">" + part("better", "\u2713", t.better) +
                    part("level", "\u2248", t.level) + part("worse", "\u2717", t.worse);
  if (const auto typical = t.typical()) {
    out += "<span class=\"typical\">typically " + factor_text(std::max(*typical, 1 / *typical)) + "\u00D7 " +
           (*typical >= 1 ? "better" : "worse") + "</span>";
  }
  return out + "</p>\n";
}

std::string headline_html(const RunReport& report, std::size_t run, const Tally& all) {
  std::string out = "<p class=\"headline\">";
  out += report.runs.size() > 1 ? escaped(run_name(report, run)) + ": better" : "Better";
  out += " than the paper in <strong>" + std::to_string(all.better) + "</strong> of " +
         counted(all.count(), "figure") + ", level in <strong>" + std::to_string(all.level) +
         "</strong>, worse in <strong>" + std::to_string(all.worse) +
         "</strong>.</p>\n<div class=\"bar\" "
         "aria-hidden=\"true\">";
  const auto part = [](const char* kind, std::size_t count) {
    return count == 0 ? std::string()
                      : "<span class=\"" + std::string(kind) +
                            "\" style=\"flex-grow:" + std::to_string(count) + "\"></span>";
  };
  return out + part("better", all.better) + part("level", all.level) + part("worse", all.worse) + "</div>\n";
}

std::string glance_html(const DocumentSection& section, std::size_t run, const Tally& t, double reach) {
  std::string out = "<div class=\"glance\"><div><h3><a href=\"#" +
                    escaped(anchor(run, "section", section.id)) + "\">" + escaped(section.title) +
                    "</a></h3>\n";
  if (!section.paragraphs.empty()) out += element("p", section.paragraphs.front());
  out += "</div><div>";
  if (t.count() > 0) out += strip_svg(t, reach) + counts_html(t);
  return out + "</div></div>\n";
}

std::string finding_html(Finding finding) {
  constexpr std::array<std::string_view, 5> kLooks{"better", "level", "worse", "better", "worse"};
  const auto at = static_cast<std::size_t>(finding);
  return "<span class=\"" + std::string(kLooks[at]) + "\"><span aria-hidden=\"true\">" +
         std::string(sign_of(finding)) + "</span> " + std::string(word_of(finding)) + "</span>";
}

std::string verdict_html(const Verdict& v) {
  return "<tr><th scope=\"row\">" + escaped(v.source) + "</th><td>" + escaped(v.what) +
         "</td><td class=\"paper\"><span class=\"key\">paper </span>" + escaped(v.paper) +
         "</td><td class=\"ours\"><span class=\"key\">ours </span>" + escaped(v.ours) +
         "</td><td class=\"s\">" + finding_html(v.finding) + "</td><td>" + escaped(v.why) + "</td></tr>\n";
}

/// The paper's tables and claims, a line each.
std::string verdicts_html(const ReportRun& run) {
  const std::vector<VerdictGroup> groups = verdict_groups(run.document);
  if (groups.empty()) return {};
  std::string out =
      "<table class=\"verdicts\">\n<thead><tr><th scope=\"col\">paper\u2019s table</th><th "
      "scope=\"col\">what</th><th scope=\"col\" class=\"paper\">paper</th><th scope=\"col\">ours</th><th "
      "scope=\"col\">finding</th><th scope=\"col\">why</th></tr></thead>\n";
  bool dissertation = false;
  for (const VerdictGroup& group : groups) {
    out += "<tbody>\n<tr class=\"group\"><th colspan=\"6\" scope=\"rowgroup\">" + escaped(group.title) +
           ": " + std::to_string(group.verdicts.size()) + "</th></tr>\n";
    for (const Verdict* v : group.verdicts) {
      out += verdict_html(*v);
      dissertation = dissertation || v->source.starts_with("D ");
    }
    out += "</tbody>\n";
  }
  out += "</table>\n";
  if (dissertation) {
    out +=
        "<p class=\"note sources\">D is the dissertation whose experiments these are; its figures are from "
        "an Intel "
        "Core i7-7700 with a GeForce GTX 1070.</p>\n";
  }
  return out;
}

/// What failed and why, one line a reason. `most`: cases named of each.
std::string failures_html(const Document& document, std::size_t most) {
  const std::size_t count = failure_count(document);
  if (count == 0) return {};
  std::string out =
      "<div class=\"failures\"><p><strong>" + counted(count, "case") + " failed</strong></p>\n<ul>\n";
  for (const FailureGroup& group : failures_of(document)) {
    out += "<li><span class=\"case\">" + escaped(group.cases_text(most)) + "</span>: " + escaped(group.why) +
           "</li>\n";
  }
  return out + "</ul></div>\n";
}

std::string summary_html(const RunReport& report) {
  std::vector<Tally> runs(report.runs.size());
  std::vector<Tally> sections;
  for (std::size_t run = 0; run < report.runs.size(); ++run) {
    for (const DocumentSection& section : report.runs[run].document.sections) {
      sections.push_back(tally(section));
      for (const Comparison& comparison : sections.back().all) runs[run].add(comparison);
    }
  }
  const double reach = strip_reach(sections);
  std::string out = "<section id=\"summary\">\n<h2>At a glance</h2>\n";
  bool compared = false;
  std::size_t next = 0;
  for (std::size_t run = 0; run < report.runs.size(); ++run) {
    if (runs[run].count() > 0) {
      compared = true;
      out += headline_html(report, run, runs[run]);
    } else if (report.runs.size() > 1) {
      out += "<p class=\"headline\">" + escaped(run_name(report, run)) + "</p>\n";
    }
    out += failures_html(report.runs[run].document, 3) + verdicts_html(report.runs[run]);
    for (const DocumentSection& section : report.runs[run].document.sections)
      out += glance_html(section, run, sections[next++], reach);
  }
  if (compared) {
    out +=
        "<p class=\"note\">A dot is a figure of ours beside the paper\u2019s: \u2713 better, \u2248 level "
        "(within "
        "2\u00A0%), \u2717 worse; 1.8\u00D7 says how many times. The paper\u2019s are from its authors\u2019 "
        "machine; "
        "what else differs is said with each table.</p>\n";
  }
  return out + "</section>\n";
}

// ---- Runs ------------------------------------------------------------------------------------------------

std::string facts_html(const Document& document) {
  if (document.facts.empty()) return {};
  std::string out = "<dl class=\"facts\">\n";
  constexpr std::size_t kLong = 40;  // does not fit beside others
  for (const auto& [name, value] : document.facts)
    out += std::string(display_width(value) > kLong ? "<div class=\"long\">" : "<div>") + "<dt>" +
           escaped(name) + "</dt><dd>" + escaped(value) + "</dd></div>\n";
  return out + "</dl>\n";
}

std::string section_html(const ReportRun& from, const DocumentSection& section, std::size_t run,
                         Warnings& warnings) {
  std::string out =
      "<section id=\"" + escaped(anchor(run, "section", section.id)) + "\">\n" + element("h3", section.title);
  for (std::size_t i = 0; i < section.paragraphs.size(); ++i)
    out += (i == 0 ? "<p class=\"lead\">" : "<p>") + escaped(section.paragraphs[i]) + "</p>\n";
  for (const Block& block : section.blocks) {
    if (const auto* table = std::get_if<DocumentTable>(&block)) out += table_html(*table, run);
    if (const auto* chart = std::get_if<Chart>(&block)) out += chart_html(*chart, run);
    if (const auto* picture = std::get_if<Picture>(&block))
      out += picture_html(*picture, run, from.folder, warnings);
  }
  return out + "</section>\n";
}

std::string run_html(const RunReport& report, std::size_t run, Warnings& warnings) {
  const ReportRun& from = report.runs[run];
  std::string out = "<section class=\"run\" id=\"run" + std::to_string(run + 1) + "\">\n" +
                    element("h2", run_name(report, run)) + facts_html(from.document) +
                    failures_html(from.document, 100);
  for (const DocumentSection& section : from.document.sections)
    out += section_html(from, section, run, warnings);
  return out + "</section>\n";
}

std::string contents_html(const RunReport& report) {
  std::string out = "<nav aria-label=\"Contents\"><ul>\n<li><a href=\"#summary\">At a glance</a></li>\n";
  for (std::size_t run = 0; run < report.runs.size(); ++run) {
    out += "<li><a href=\"#run" + std::to_string(run + 1) + "\">" + escaped(run_name(report, run)) +
           "</a></li>\n";
  }
  return out + "</ul></nav>\n";
}

}  // namespace

std::string report_html(const RunReport& report, Warnings& warnings) {
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src "
      "'unsafe-inline'\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" "
      "href=\"data:,\">\n" +
      element("title", report.title) + "<style>\n" + std::string(report_style()) +
      "</style>\n</head>\n<body>\n" + "<header>\n" + element("h1", report.title) + contents_html(report) +
      "</header>\n<main>\n" + summary_html(report);
  for (std::size_t run = 0; run < report.runs.size(); ++run) out += run_html(report, run, warnings);
  return out + "</main>\n<footer><p>Made by sceneplay report, scenegen " SCENEGEN_VERSION
               ".</p></footer>\n</body>\n</html>\n";
}

}  // namespace scenegen::tools
