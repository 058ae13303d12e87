#include "tools/report/html_blocks.h"

#include <algorithm>
#include <cctype>

#include "tools/report/chart.h"
#include "tools/report/pictures.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

std::string figure_open(const std::string& kind, std::size_t run, const std::string& id,
                        const std::string& title) {
  const std::string name = escaped(anchor(run, kind, id));
  return "<figure class=\"" + kind + "\" id=\"" + name + "\">\n<figcaption id=\"" + name + ".c\">" +
         escaped(title) + "</figcaption>\n";
}

std::string note_html(const std::string& note) {
  return note.empty() ? note : "<p class=\"note\">" + escaped(note) + "</p>\n";
}

/// Says of what is the paper's that it is, unless its title does.
std::string paper_tag(Origin origin, std::string title) {
  if (origin != Origin::paper) return {};
  for (char& c : title) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const bool says =
      title.find("paper") != std::string::npos || title.find("dissertation") != std::string::npos;
  return says ? std::string() : " <span class=\"tag\">paper</span> ";
}

constexpr std::size_t kShortWords = 24;

/// Words that stay in one line, so that rows stay one line high.
bool short_words(const DocumentTable& table, std::size_t column) {
  return std::all_of(table.rows.begin(), table.rows.end(), [column](const auto& row) {
    const auto* text = std::get_if<std::string>(&row[column]);
    return text == nullptr || display_width(*text) <= kShortWords;
  });
}

/// What cells of one column have in common.
struct Look {
  ColumnFormat format;
  std::string classes;
};

Look look_of(const DocumentTable& table, std::size_t column) {
  Look out{column_format(table, column), {}};
  out.classes = out.format.numeric ? "n" : short_words(table, column) ? "s" : "w";
  if (table.columns[column].origin == Origin::paper) out.classes += " paper";
  return out;
}

std::string head_html(const DocumentTable& table, const std::vector<Look>& looks) {
  std::string out = "<thead><tr>";
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const Column& column = table.columns[i];
    out += "<th scope=\"col\" class=\"" + looks[i].classes + "\">" + paper_tag(column.origin, column.title) +
           escaped(column.title);
    const std::string& unit = looks[i].format.unit;
    if (!unit.empty()) out += " <span class=\"unit\">" + escaped(unit) + "</span>";
    out += "</th>";
  }
  return out + "</tr></thead>\n";
}

std::string cell_html(const DocumentTable& table, std::size_t row, std::size_t column, const Look& look) {
  const std::string text = escaped(cell_text(table.rows[row][column], look.format));
  if (column == 0) return "<th scope=\"row\" class=\"" + look.classes + "\">" + text + "</th>";
  std::string out = "<td class=\"" + look.classes + "\">" + text;
  if (!table.columns[column].against.empty()) {
    // Every cell of such a column has the place for it, so that figures stay below each other.
    const auto comparison = compare_cell(table, row, column);
    out += comparison ? comparison_html(*comparison) : "<span class=\"mark\"></span>";
  }
  return out + "</td>";
}

/// The figures behind a chart, for those who want them or do not see it.
std::string points_html(const Chart& chart) {
  std::size_t count = 0;
  bool spread = false;
  for (const Series& series : chart.series) {
    count += series.points.size();
    spread = spread || std::any_of(series.points.begin(), series.points.end(),
                                   [](const ChartPoint& p) { return p.low || p.high; });
  }
  constexpr std::size_t kMost = 3000;  // more are in the CSV
  if (count == 0 || count > kMost) return {};
  std::string out =
      "<details><summary>Figures</summary><div class=\"scroll\" tabindex=\"0\" role=\"region\" "
      "aria-label=\"Figures of the chart\"><table><thead><tr><th scope=\"col\" class=\"w\">curve"
      "</th><th scope=\"col\" class=\"n\">" +
      escaped(chart.x_title) + "</th><th scope=\"col\" class=\"n\">" + escaped(chart.y_title) + "</th>";
  if (spread) out += "<th scope=\"col\" class=\"n\">low</th><th scope=\"col\" class=\"n\">high</th>";
  out += "</tr></thead>\n<tbody>";
  const auto cell = [](const std::optional<double>& value) {
    return "<td class=\"n\">" + (value ? figure_text(*value, 4) : std::string("\u2013")) + "</td>";
  };
  for (const Series& series : chart.series) {
    for (const ChartPoint& point : series.points) {
      out += "<tr><th scope=\"row\" class=\"w\">" + escaped(series.name) + "</th>" + cell(point.x) +
             cell(point.y);
      if (spread) out += cell(point.low) + cell(point.high);
      out += "</tr>\n";
    }
  }
  return out + "</tbody></table></div></details>\n";
}

}  // namespace

std::string comparison_html(const Comparison& comparison) {
  std::string_view sign = "\u2248";
  std::string_view word = "level";
  if (comparison.outcome == Outcome::better) sign = "\u2713", word = "better";
  if (comparison.outcome == Outcome::worse) sign = "\u2717", word = "worse";
  std::string out = "<span class=\"mark " + std::string(word) + "\"><span aria-hidden=\"true\">" +
                    std::string(sign) + "</span>";
  if (comparison.factor && comparison.outcome != Outcome::level)
    out += " " + factor_text(std::max(*comparison.factor, 1 / *comparison.factor)) + "\u00D7";
  return out + "<span class=\"sr\"> " + std::string(word) + "</span></span>";
}

std::string table_html(const DocumentTable& table, std::size_t run) {
  std::vector<Look> looks;
  for (std::size_t i = 0; i < table.columns.size(); ++i) looks.push_back(look_of(table, i));
  constexpr std::size_t kManyColumns = 8;
  const std::string name = escaped(anchor(run, "table", table.id));
  std::string out = figure_open("table", run, table.id, table.title) +
                    "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"" + name +
                    ".c\"><table" + (table.columns.size() > kManyColumns ? " class=\"wide\"" : "") + ">\n" +
                    head_html(table, looks) + "<tbody>\n";
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    out += "<tr>";
    for (std::size_t i = 0; i < looks.size(); ++i) out += cell_html(table, row, i, looks[i]);
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n" + note_html(table.note) + "</figure>\n";
}

std::string chart_html(const Chart& chart, std::size_t run) {
  const std::vector<std::size_t> colors = series_colors(chart);
  std::string out = figure_open("chart", run, chart.id, chart.title) + "<ul class=\"legend\">";
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const Series& series = chart.series[i];
    out += "<li>" + series_swatch(colors[i], series.origin) + escaped(series.name);
    out += paper_tag(series.origin, series.name) + "</li>";
  }
  out += "</ul>\n";
  const std::string id = anchor(run, "chart", chart.id);
  out += chart_svg(chart, id, {"broad", 760, 380}) + chart_svg(chart, id, {"slim", 340, 300});
  const std::string missing = left_out(chart);
  out += note_html(chart.note + (chart.note.empty() || missing.empty() ? "" : " ") + missing);
  return out + points_html(chart) + "</figure>\n";
}

std::string picture_html(const Picture& picture, std::size_t run, const std::string& folder,
                         Warnings& warnings) {
  std::string out = figure_open("picture", run, picture.id, picture.title);
  const Result<EmbeddedPicture> embedded = embed_picture(folder, picture.file);
  if (embedded) {
    out += "<img alt=\"" + escaped(picture.title + (picture.note.empty() ? "" : ": " + picture.note)) +
           "\" width=\"" + std::to_string(embedded->width) + "\" height=\"" +
           std::to_string(embedded->height) + "\" src=\"" + embedded->data_uri + "\">\n";
  } else {
    warnings.push_back(embedded.error().str());
    out += "<p class=\"missing\">The picture " + escaped(picture.file) +
           " cannot be shown: " + escaped(embedded.error().what) + ".</p>\n";
  }
  return out + note_html(picture.note) + "</figure>\n";
}

}  // namespace scenegen::tools
