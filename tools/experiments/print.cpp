// Sections of a document for a terminal.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tools/experiments/run.h"
#include "tools/report/report.h"

namespace scenegen::tools {
namespace {

/// `digits` significant ones, whole numbers whole.
std::string number_text(double value, int digits) {
  if (value == std::floor(value) && std::abs(value) < 1e15)
    return value < 0 ? "-" + human_count(static_cast<std::uint64_t>(-value))
                     : human_count(static_cast<std::uint64_t>(value));
  std::array<char, 64> text{};
  const int before = value == 0 ? 1 : static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
  const int behind = std::clamp(digits - before, 0, 12);
  if (behind == 0) return number_text(std::round(value), digits);
  (void)std::snprintf(text.data(), text.size(), "%.*f", behind, value);
  return text.data();
}

std::string cell_of(const Cell& cell, const Column& column) {
  if (const auto* number = std::get_if<double>(&cell)) return number_text(*number, column.digits);
  if (const auto* word = std::get_if<std::string>(&cell)) return *word;
  return "-";
}

std::string padded(const std::string& text, std::size_t width, bool right) {
  const std::string blanks(width - std::min(width, display_width(text)), ' ');
  return right ? blanks + text : text + blanks;
}

/// Lines of the heading: the title's words, the unit, and whose figures they are.
std::vector<std::string> heading_of(const Column& column, std::size_t width) {
  std::vector<std::string> lines = wrap(column.title, width);
  if (!column.unit.empty()) lines.push_back(column.unit);
  if (column.origin == Origin::paper) lines.emplace_back("(paper)");
  return lines;
}

}  // namespace

std::string table_text(const DocumentTable& table) {
  const std::size_t columns = table.columns.size();
  std::vector<std::vector<std::string>> cells;
  for (const std::vector<Cell>& row : table.rows) {
    std::vector<std::string>& out = cells.emplace_back();
    for (std::size_t i = 0; i < columns; ++i) out.push_back(cell_of(row[i], table.columns[i]));
  }
  std::vector<std::size_t> widths(columns, 4);
  std::vector<bool> right(columns, false);
  std::vector<std::vector<std::string>> headings(columns);
  std::size_t heading_lines = 0;
  for (std::size_t i = 0; i < columns; ++i) {
    for (std::size_t r = 0; r < cells.size(); ++r) {
      widths[i] = std::max(widths[i], display_width(cells[r][i]));
      right[i] = right[i] || std::holds_alternative<double>(table.rows[r][i]);
    }
    headings[i] = heading_of(table.columns[i], std::max<std::size_t>(widths[i], 11));
    for (const std::string& line : headings[i]) widths[i] = std::max(widths[i], display_width(line));
    heading_lines = std::max(heading_lines, headings[i].size());
  }
  std::string out;
  const auto append = [&](const auto& text_of) {
    std::string line;
    for (std::size_t i = 0; i < columns; ++i)
      line += (i == 0 ? "" : "  ") + padded(text_of(i), widths[i], right[i]);
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  };
  for (std::size_t k = 0; k < heading_lines; ++k) {
    append([&](std::size_t i) {
      const std::size_t skip = heading_lines - headings[i].size();
      return k < skip ? std::string() : headings[i][k - skip];
    });
  }
  for (const std::vector<std::string>& row : cells) append([&](std::size_t i) { return row[i]; });
  return out;
}

/// Where ours stand beside the paper, without the reasons, for which a terminal is too narrow.
std::string verdicts_text(const DocumentSection& section) {
  if (section.verdicts.empty()) return {};
  DocumentTable table{
      "", "", {{"", "", ""}, {"", "table", ""}, {"", "what", ""}, {"", "ours", ""}, {"", "paper", ""}}, {}};
  for (const Verdict& v : section.verdicts)
    table.rows.push_back({std::string(sign_of(v.finding)) + " " + std::string(word_of(v.finding)), v.source,
                          v.what, v.ours, v.paper});
  return "\nBeside the paper\n\n" + table_text(table);
}

std::string section_text(const DocumentSection& section) {
  std::string out = section.title + "\n" + std::string(display_width(section.title), '=') + "\n";
  const auto paragraph = [&](const std::string& text) {
    out += "\n";
    for (const std::string& line : wrap(text, 100)) out += line + "\n";
  };
  for (const std::string& text : section.paragraphs) paragraph(text);
  out += verdicts_text(section);
  for (const Failure& f : section.failures) paragraph("Failed: " + f.what + ": " + f.why);
  for (const Block& block : section.blocks) {
    const auto* table = std::get_if<DocumentTable>(&block);
    if (table == nullptr) continue;
    out += "\n" + table->title + "\n\n" + table_text(*table);
    if (!table->note.empty()) paragraph(table->note);
  }
  return out;
}

}  // namespace scenegen::tools
