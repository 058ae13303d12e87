// Figures for people, and beside the paper's.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>

#include "tools/report/report.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

/// Decimals with which `value` has `digits` significant ones; whole parts are never rounded away.
int decimals_for(double value, int digits) {
  if (value == 0) return 0;
  const int order = static_cast<int>(std::floor(std::log10(std::abs(value))));
  return std::clamp(digits - 1 - order, 0, 12);
}

std::string fixed(double value, int decimals) {
  std::array<char, 400> buffer{};
  (void)std::snprintf(buffer.data(), buffer.size(), "%.*f", decimals, value);
  std::string out = buffer.data();
  const bool negative = out.front() == '-';
  if (negative) out.erase(0, 1);
  const std::size_t point = std::min(out.find('.'), out.size());
  constexpr std::size_t kWithoutGaps = 4;  // 4096 is as easy to read in one piece
  for (std::size_t i = point; point > kWithoutGaps && i > 3; i -= 3) out.insert(i - 3, "\u202F");
  const bool nothing = out.find_first_not_of("0.") == std::string::npos;
  return negative && !nothing ? "\u2212" + out : out;
}

bool whole(double value) {
  return value == std::floor(value);
}

std::vector<double> figures_of(const DocumentTable& table, std::size_t column) {
  std::vector<double> out;
  for (const auto& row : table.rows) {
    const auto* figure = std::get_if<double>(&row[column]);
    if (figure != nullptr && std::isfinite(*figure)) out.push_back(*figure);
  }
  return out;
}

/// Figures of a column and of those that it is compared with: they are written alike.
std::vector<double> figures_beside(const DocumentTable& table, std::size_t column) {
  const Column& self = table.columns[column];
  std::vector<double> out;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const Column& other = table.columns[i];
    const bool beside = other.name == self.against || other.against == self.name ||
                        (!self.against.empty() && other.against == self.against);
    if (i != column && !(beside && other.unit == self.unit)) continue;
    const std::vector<double> figures = figures_of(table, i);
    out.insert(out.end(), figures.begin(), figures.end());
  }
  return out;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const double upper = *middle;
  if (values.size() % 2 == 1) return upper;
  return (upper + *std::max_element(values.begin(), middle)) / 2;
}

/// Bytes are read as megabytes when most of them are that large.
void scale_bytes(ColumnFormat& format, const std::vector<double>& figures) {
  constexpr std::array<const char*, 4> kUnits{"kB", "MB", "GB", "TB"};
  double left = std::abs(median(figures));
  for (const char* unit : kUnits) {
    if (left < 1000) return;
    left /= 1000;
    format.scale /= 1000;
    format.unit = unit;
  }
}

void choose_decimals(ColumnFormat& format, std::vector<double> figures) {
  for (double& figure : figures) figure = std::abs(figure * format.scale);
  std::erase(figures, 0);
  if (figures.empty() || std::all_of(figures.begin(), figures.end(), whole)) {
    format.decimals = 0;
    return;
  }
  const auto [least, most] = std::minmax_element(figures.begin(), figures.end());
  constexpr double kMostSpread = 2e4;
  if (*most / *least > kMostSpread || *least < 1e-6 || *most > 1e12) return;
  format.decimals = std::max(decimals_for(median(figures), format.digits),
                             decimals_for(*least, std::min(2, format.digits)));
}

}  // namespace

namespace {

std::string own_name(const Document& document) {
  std::vector<std::string> devices;
  std::string processor;
  for (const auto& [name, value] : document.facts) {
    if ((name == "device" || name == "Device" || name == "GPU") && !value.empty()) devices.push_back(value);
    if (name == "processor") processor = value;
  }
  if (devices.size() == 1) return devices.front();
  return devices.empty() && !processor.empty() ? processor : document.title;
}

/// What a run is of: its first section, and how many there are beside it.
std::string subject(const Document& document) {
  if (document.sections.empty()) return document.title;
  const std::size_t more = document.sections.size() - 1;
  return document.sections.front().title + (more == 0 ? "" : " and " + std::to_string(more) + " more");
}

}  // namespace

std::string run_name(const RunReport& report, std::size_t run) {
  const Document& document = report.runs[run].document;
  std::string name = own_name(document);
  const std::string of = subject(document);
  std::size_t alike = 0;
  std::size_t same_before = 0;
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    if (own_name(report.runs[i].document) != name) continue;
    ++alike;
    if (i < run && subject(report.runs[i].document) == of) ++same_before;
  }
  if (alike == 1) return name;
  name.append(": ").append(of);
  return same_before == 0 ? name : name + ", " + std::to_string(same_before + 1);
}

std::vector<VerdictGroup> verdict_groups(const Document& document) {
  // better, level, worse, agrees, differs
  constexpr std::array<std::size_t, 5> kGroup{2, 1, 0, 2, 0};
  std::vector<VerdictGroup> all{{"Behind the paper, or not as it says", {}},
                                {"Level with it", {}},
                                {"Ahead of the paper, or as it says", {}}};
  for (const DocumentSection& section : document.sections) {
    for (const Verdict& v : section.verdicts)
      all[kGroup[static_cast<std::size_t>(v.finding)]].verdicts.push_back(&v);
  }
  std::erase_if(all, [](const VerdictGroup& group) { return group.verdicts.empty(); });
  return all;
}

std::string anchor(std::size_t run, const std::string& kind, const std::string& id) {
  return "run" + std::to_string(run + 1) + "-" + kind + "-" + id;
}

std::optional<Comparison> compare_cell(const DocumentTable& table, std::size_t row, std::size_t column) {
  const Column& ours = table.columns[column];
  if (ours.against.empty() || ours.better == Better::none) return std::nullopt;
  const auto theirs = std::find_if(table.columns.begin(), table.columns.end(),
                                   [&](const Column& other) { return other.name == ours.against; });
  if (theirs == table.columns.end()) return std::nullopt;
  const auto* a = std::get_if<double>(&table.rows[row][column]);
  const auto* b =
      std::get_if<double>(&table.rows[row][static_cast<std::size_t>(theirs - table.columns.begin())]);
  if (a == nullptr || b == nullptr || !std::isfinite(*a) || !std::isfinite(*b)) return std::nullopt;
  Comparison out;
  if (*a > 0 && *b > 0) out.factor = ours.better == Better::lower ? *b / *a : *a / *b;
  if (std::abs(*a - *b) <= kLevel * std::abs(*b)) return out;
  out.outcome = (*a < *b) == (ours.better == Better::lower) ? Outcome::better : Outcome::worse;
  return out;
}

std::optional<double> Tally::typical() const {
  std::vector<double> factors;
  for (const Comparison& comparison : all) {
    if (comparison.factor) factors.push_back(*comparison.factor);
  }
  return factors.empty() ? std::nullopt : std::optional(median(factors));
}

void Tally::add(const Comparison& comparison) {
  all.push_back(comparison);
  if (comparison.outcome == Outcome::better) ++better;
  if (comparison.outcome == Outcome::level) ++level;
  if (comparison.outcome == Outcome::worse) ++worse;
}

Tally tally(const DocumentSection& section) {
  Tally out;
  for (const Block& block : section.blocks) {
    const auto* table = std::get_if<DocumentTable>(&block);
    if (table == nullptr) continue;
    for (std::size_t row = 0; row < table->rows.size(); ++row) {
      for (std::size_t column = 0; column < table->columns.size(); ++column) {
        if (const auto comparison = compare_cell(*table, row, column)) out.add(*comparison);
      }
    }
  }
  return out;
}

Finding finding_of(double ours, double paper, Better better) {
  if (std::abs(ours - paper) <= kLevel * std::abs(paper)) return Finding::level;
  return (ours < paper) == (better == Better::lower) ? Finding::better : Finding::worse;
}

std::string_view sign_of(Finding finding) {
  constexpr std::array<std::string_view, 5> kSigns{"\u2713", "\u2248", "\u2717", "=", "\u2260"};
  return kSigns[static_cast<std::size_t>(finding)];
}

std::string FailureGroup::cases_text(std::size_t most) const {
  // A rest of one is named too: it takes no more room.
  const std::size_t named = cases.size() <= most + 1 ? cases.size() : most;
  std::string out = join(std::span(cases).first(named), "; ");
  return named == cases.size() ? out : out + " and " + human_count(cases.size() - named) + " more";
}

std::vector<FailureGroup> failures_of(const Document& document) {
  std::vector<FailureGroup> out;
  const auto add = [&out](const std::vector<Failure>& failures) {
    for (const Failure& f : failures) {
      auto group = std::find_if(out.begin(), out.end(), [&](const auto& g) { return g.why == f.why; });
      if (group == out.end()) group = out.insert(out.end(), FailureGroup{f.why, {}});
      group->cases.push_back(f.what);
    }
  };
  add(document.failures);
  for (const DocumentSection& section : document.sections) add(section.failures);
  return out;
}

std::size_t failure_count(const Document& document) {
  std::size_t out = document.failures.size();
  for (const DocumentSection& section : document.sections) out += section.failures.size();
  return out;
}

ColumnFormat column_format(const DocumentTable& table, std::size_t column) {
  ColumnFormat out;
  out.unit = table.columns[column].unit;
  out.digits = table.columns[column].digits;
  const bool words = std::any_of(table.rows.begin(), table.rows.end(), [column](const auto& row) {
    return std::holds_alternative<std::string>(row[column]);
  });
  if (figures_of(table, column).empty()) return out;
  out.numeric = !words;
  const std::vector<double> figures = figures_beside(table, column);
  if (out.unit == "B") scale_bytes(out, figures);
  choose_decimals(out, figures);
  return out;
}

std::string cell_text(const Cell& cell, const ColumnFormat& format) {
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  const auto* figure = std::get_if<double>(&cell);
  if (figure == nullptr || !std::isfinite(*figure)) return "\u2013";
  const double value = *figure * format.scale;
  return format.decimals >= 0 ? fixed(value, format.decimals) : figure_text(value, format.digits);
}

std::string figure_text(double value, int digits) {
  const double size = std::abs(value);
  if (size != 0 && (size < 1e-6 || size >= 1e15)) {
    std::array<char, 48> buffer{};
    (void)std::snprintf(buffer.data(), buffer.size(), "%.*e", digits - 1, value);
    return buffer.data();
  }
  return fixed(value, whole(value) ? 0 : decimals_for(value, digits));
}

std::string factor_text(double factor) {
  if (factor >= 1000) return ">1000";
  return fixed(factor, factor < 9.95 ? (factor < 1.095 ? 2 : 1) : 0);
}

}  // namespace scenegen::tools
