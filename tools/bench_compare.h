// Two results of benchmarks beside each other: what changed, and whether it is more than noise.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/result.h"
#include "tools/bench_results.h"

namespace scenegen::tools {

/// A bench.json, or the one in a folder. Errors: io; bad_input for what is no such file or is of another
/// version (docs/BENCH_FORMAT.md), with the path.
[[nodiscard]] Result<nlohmann::ordered_json> read_bench(const std::string& path);

enum class Change : std::uint8_t { same, faster, slower, unknown };
[[nodiscard]] std::string_view name_of(Change change);

/// 95 % interval of the difference of the means of two samples whose variances may differ: Welch (1947), with
/// Student's t at Welch and Satterthwaite's degrees of freedom, rounded down. None when one has fewer than
/// two.
[[nodiscard]] std::optional<Interval> welch95(const std::vector<double>& a, const std::vector<double>& b);

struct CounterChange {
  std::string name;
  double a = 0, b = 0;
};
/// One case of both; `what.way.label` is its strategy.
struct CaseChange {
  BenchCase what;
  double mean_a_ms = 0, mean_b_ms = 0, median_a_ms = 0, median_b_ms = 0;
  std::optional<Interval> difference_ms;  ///< of the means, B - A
  Change change = Change::unknown;
  bool counters_vary = false;  ///< between repetitions, in A or B: then none are compared
  std::vector<CounterChange> counters;
};

struct BenchComparison {
  std::string a, b;  ///< paths
  std::vector<CaseChange> cases;
  std::vector<std::string> only_a, only_b;      ///< cases by name
  std::vector<std::string> failed_a, failed_b;  ///< with their errors
  std::vector<std::string> warnings;            ///< machine, device, driver, program or settings differ

  [[nodiscard]] bool any_slower() const;
  [[nodiscard]] bool any_counters() const;
  [[nodiscard]] std::uint64_t count(Change change) const;
};

/// Files and camera paths are the same when their names without folders are; devices are not told apart by
/// name when each of both has only one. A difference counts from `least_share` of A's mean on. Error:
/// bad_input.
[[nodiscard]] Result<BenchComparison> compare_bench(const nlohmann::ordered_json& a,
                                                    const nlohmann::ordered_json& b, double least_share);

/// Entries: one a case.
[[nodiscard]] nlohmann::ordered_json comparison_json(const BenchComparison& comparison);
/// For people; at most 100 characters a line.
[[nodiscard]] std::string comparison_text(const BenchComparison& comparison);

}  // namespace scenegen::tools
