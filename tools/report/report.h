// Several runs as one report, and what its figures are beside the paper's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/report/document.h"

namespace scenegen::tools {

/// What one machine found.
struct ReportRun {
  Document document;
  std::string folder;  ///< that the paths of its pictures start from
};

struct RunReport {
  std::string title;
  std::vector<ReportRun> runs;
};

/// The device's name when the run's facts say one; the processor's when they say none; the title of its
/// document when neither names it. Runs of one name say what they are of as well.
[[nodiscard]] std::string run_name(const RunReport& report, std::size_t run);
/// Name of an id of a run's document in the whole report: "run1-chart-queries". `kind`: section, table, chart
/// or picture; ids are unique among those of one kind.
[[nodiscard]] std::string anchor(std::size_t run, const std::string& kind, const std::string& id);

enum class Outcome : std::uint8_t { better, level, worse };
/// Figures that differ by at most this share of the paper's are level: noise of one and rounding of the
/// other.
constexpr double kLevel = 0.02;

/// One figure of ours beside the paper's.
struct Comparison {
  Outcome outcome = Outcome::level;
  /// How many times better ours is, below 1: worse. None when one of both is not positive.
  std::optional<double> factor = {};
};

/// None when the column is compared with nothing, a reader wants nothing of it, or one of both has no figure.
[[nodiscard]] std::optional<Comparison> compare_cell(const DocumentTable& table, std::size_t row,
                                                     std::size_t column);

struct Tally {
  std::size_t better = 0, level = 0, worse = 0;
  std::vector<Comparison> all;  ///< in the order of the tables
  [[nodiscard]] std::size_t count() const { return all.size(); }
  /// Median of the factors.
  [[nodiscard]] std::optional<double> typical() const;
  void add(const Comparison& comparison);
};
[[nodiscard]] Tally tally(const DocumentSection& section);

/// How a figure of ours stands beside the paper's.
[[nodiscard]] Finding finding_of(double ours, double paper, Better better);
/// The paper's tables and claims by how ours stand, in the order of the sections; groups that are empty are
/// left out. What is behind comes first: a reader looks for it.
struct VerdictGroup {
  std::string title;  ///< "Behind the paper, or not as it says"
  std::vector<const Verdict*> verdicts;
};
[[nodiscard]] std::vector<VerdictGroup> verdict_groups(const Document& document);
/// "✓", "≈", "✗", "=", "≠".
[[nodiscard]] std::string_view sign_of(Finding finding);

/// Cases that failed for one reason.
struct FailureGroup {
  std::string why;
  std::vector<std::string> cases;

  /// "a; b; c and 4 more": at most `most`.
  [[nodiscard]] std::string cases_text(std::size_t most) const;
};
/// Of the document and of its sections, in this order, by reason.
[[nodiscard]] std::vector<FailureGroup> failures_of(const Document& document);
[[nodiscard]] std::size_t failure_count(const Document& document);

/// How the figures of one column are written for people: all with as many decimals, so that they can be
/// compared down the column, unless they differ too much in size.
struct ColumnFormat {
  bool numeric = false;  ///< has figures and no words
  double scale = 1;      ///< from the file's unit
  std::string unit;      ///< after scaling: "MB"
  int decimals = -1;     ///< -1: `digits` significant digits each
  int digits = 3;
};
[[nodiscard]] ColumnFormat column_format(const DocumentTable& table, std::size_t column);
/// "15 037 746", "0.0017", "-": thousands parted by narrow no-break spaces.
[[nodiscard]] std::string cell_text(const Cell& cell, const ColumnFormat& format);
/// A figure by itself, with three significant digits.
[[nodiscard]] std::string figure_text(double value, int digits = 3);
/// "1.8", "12", "140": of a factor.
[[nodiscard]] std::string factor_text(double factor);

}  // namespace scenegen::tools
