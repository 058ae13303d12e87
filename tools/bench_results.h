// What a benchmark found: summaries with spread, the files bench.json and bench.csv, the table.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/result.h"
#include "tools/bench_case.h"

namespace scenegen::tools {

/// Of bench.json: docs/BENCH_FORMAT.md.
constexpr std::string_view kBenchSchema = "sceneplay/bench";
constexpr int kBenchVersion = 2;

struct Summary {
  double mean = 0, median = 0, p25 = 0, p75 = 0, p95 = 0, min = 0;
};
/// Quantiles by linear interpolation between the nearest two. Not of nothing.
[[nodiscard]] Summary summarize(std::vector<double> values);

/// Student's t for 95 %, two-sided, by degrees of freedom from 1 on.
[[nodiscard]] double student95(std::size_t degrees);
/// 95 % interval of the mean of what `repetitions` (their means) are samples of, after Student. None for
/// fewer than two.
struct Interval {
  double low = 0, high = 0;
};
[[nodiscard]] std::optional<Interval> interval95(const std::vector<double>& repetitions);

/// A case and its runs, one a repetition; or why there are none.
struct CaseResult {
  BenchCase what;
  std::vector<BenchRun> runs;
  std::string error;
  std::vector<double> moments_s = {};  ///< of the frames

  /// Mean milliseconds a frame of each run, and of all.
  [[nodiscard]] std::vector<double> run_means() const;
  [[nodiscard]] double mean_ms() const;
};

/// Cases that differ in the way of drawing alone: those that are compared with each other.
struct GroupResult {
  std::vector<CaseResult> cases;
  /// The least mean of them; none when all failed.
  [[nodiscard]] std::optional<double> best_ms() const;
};

/// Entries of "cases" in bench.json, flat.
[[nodiscard]] nlohmann::ordered_json cases_json(const std::vector<GroupResult>& groups);
/// Lines of columns, two blanks indented, the first to the left and the others to the right.
[[nodiscard]] std::string aligned(const std::vector<std::vector<std::string>>& rows);
/// Three digits that count: 0.0312, 4.68, 123.
[[nodiscard]] std::string milliseconds_text(double ms);
/// For people; at most 100 characters a line.
[[nodiscard]] std::string group_table(const GroupResult& group);

/// What the program was made with: "g++ 12.2.0".
[[nodiscard]] std::string compiler();
/// The machine: processor, cores, memory, system, load.
[[nodiscard]] nlohmann::ordered_json machine_json();

/// Runs on disk, a file each, so that a run that was killed loses only what it was at.
class RunStore {
 public:
  /// `settings` is what all runs have in common.
  RunStore(std::string folder, nlohmann::ordered_json settings)
      : folder_(std::move(folder)), settings_(std::move(settings)) {}

  /// Makes the folder; without `keep`, removes earlier runs from it.
  [[nodiscard]] Result<void> open(bool keep) const;
  /// None when there is no such run, or only a damaged one. An error when it was measured with other
  /// settings.
  [[nodiscard]] Result<std::optional<BenchRun>> find(const BenchCase& what, std::uint32_t repetition) const;
  [[nodiscard]] Result<void> save(const BenchCase& what, std::uint32_t repetition, const BenchRun& run) const;

 private:
  [[nodiscard]] std::string path(const BenchCase& what, std::uint32_t repetition) const;
  [[nodiscard]] nlohmann::ordered_json settings_of(const BenchCase& what) const;

  std::string folder_;
  nlohmann::ordered_json settings_;
  mutable std::map<std::string, std::uint64_t> hashes_;  // of files, each read once
};

}  // namespace scenegen::tools
