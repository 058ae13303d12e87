#include "tools/bench_results.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "tools/frame_fields.h"
#include "tools/output.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

ordered_json summary_json(const std::vector<double>& values) {
  // A device without timestamps knows no stage of its own.
  if (values.empty() || *std::min_element(values.begin(), values.end()) < 0) return nullptr;
  const Summary s = summarize(values);
  return {{"mean", s.mean}, {"median", s.median}, {"p25", s.p25},
          {"p75", s.p75},   {"p95", s.p95},       {"min", s.min}};
}

/// The same stage of all runs, one behind the other.
std::vector<double> pooled(const std::vector<BenchRun>& runs, const auto& values_of) {
  std::vector<double> out;
  for (const BenchRun& run : runs) {
    const std::vector<double>& values = values_of(run);
    out.insert(out.end(), values.begin(), values.end());
  }
  return out;
}

ordered_json frame_json(const CaseResult& result) {
  ordered_json out = summary_json(pooled(result.runs, [](const BenchRun& r) { return r.frame_ms; }));
  const std::vector<double> means = result.run_means();
  out["mean"] = result.mean_ms();
  const std::optional<Interval> interval = interval95(means);
  out["low"] = interval ? ordered_json(interval->low) : ordered_json();
  out["high"] = interval ? ordered_json(interval->high) : ordered_json();
  out["runs"] = means;
  return out;
}

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return quantile(values, 0.5);
}

/// The frame time along the timeline: median over the runs, neighbouring frames joined where there are many.
ordered_json over_time(const CaseResult& result) {
  constexpr std::size_t kMost = 500;
  const std::size_t frames = result.runs.front().frame_ms.size();
  const std::size_t points = std::min(frames, kMost);
  ordered_json times = ordered_json::array();
  ordered_json values = ordered_json::array();
  for (std::size_t point = 0; point < points; ++point) {
    const std::size_t begin = point * frames / points;
    const std::size_t end = (point + 1) * frames / points;
    double time_s = 0;
    std::vector<double> of_runs(result.runs.size(), 0);
    for (std::size_t i = begin; i < end; ++i) {
      time_s += result.moments_s[i];
      for (std::size_t run = 0; run < of_runs.size(); ++run) of_runs[run] += result.runs[run].frame_ms[i];
    }
    const auto count = static_cast<double>(end - begin);
    times.push_back(std::round(time_s / count * 1e6) / 1e6);
    values.push_back(std::round(median_of(of_runs) / count * 1e5) / 1e5);
  }
  return {{"timeS", times}, {"frameMs", values}};
}

ordered_json start_json(const CaseResult& result) {
  std::vector<double> starts;
  for (const BenchRun& run : result.runs) {
    if (run.start_ms) starts.push_back(*run.start_ms);
  }
  return starts.empty() ? ordered_json() : ordered_json(median_of(starts));
}

/// Over the runs, each of which has one figure.
ordered_json process_cpu_json(const std::vector<BenchRun>& runs) {
  std::vector<double> values;
  for (const BenchRun& run : runs) {
    if (run.process_cpu_ms) values.push_back(*run.process_cpu_ms);
  }
  return values.size() == runs.size() ? summary_json(values) : ordered_json();
}

ordered_json case_json(const CaseResult& result, std::optional<double> best_ms) {
  ordered_json out{{"file", result.what.file},
                   {"device", result.what.device},
                   {"camera", result.what.camera},
                   {"framesInFlight", result.what.frames_in_flight},
                   {"strategy", result.what.way.label}};
  if (!result.error.empty()) out["error"] = result.error;
  if (result.runs.empty()) return out;
  const BenchRun& first = result.runs.front();
  const auto frames = static_cast<double>(first.frame_ms.size());
  out["objects"] = first.objects;
  out["frames"] = first.frame_ms.size();
  out["repetitions"] = result.runs.size();
  out["frameMs"] = frame_json(result);
  if (result.moments_s.size() == first.frame_ms.size()) out["overTime"] = over_time(result);
  out["startMs"] = start_json(result);
  out["totalMs"] = result.mean_ms() * frames;
  out["vsBest"] = result.mean_ms() / best_ms.value_or(result.mean_ms());
  out["cpuMs"] = summary_json(pooled(result.runs, [](const BenchRun& r) { return r.cpu_ms; }));
  out["processCpuMs"] = process_cpu_json(result.runs);
  for (std::size_t i = 0; i < first.stages.size(); ++i) {
    out["stagesMs"][first.stages[i]] =
        summary_json(pooled(result.runs, [i](const BenchRun& r) { return r.stages_ms[i]; }));
  }
  for (std::size_t i = 0; i < first.counters.size(); ++i)
    out["counters"][std::string(counter_fields()[i].name)] = static_cast<double>(first.counters[i]) / frames;
  // What depends on the scene and the path alone is the same in every repetition.
  out["sameCounters"] = std::all_of(result.runs.begin(), result.runs.end(),
                                    [&](const BenchRun& r) { return r.counters == first.counters; });
  out["deviceBytes"] = first.device_bytes;
  if (first.memory.is_object()) out.update(first.memory);
  out["warnings"] = result.runs.back().warnings;
  return out;
}

}  // namespace

Summary summarize(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {mean_of(values),        quantile(values, 0.5),  quantile(values, 0.25),
          quantile(values, 0.75), quantile(values, 0.95), values.front()};
}

double student95(std::size_t degrees) {
  static constexpr std::array kTable{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
                                     2.201,  2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
                                     2.080,  2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042};
  return degrees <= kTable.size() ? kTable[degrees - 1] : 1.96 + 2.5 / static_cast<double>(degrees);
}

std::optional<Interval> interval95(const std::vector<double>& repetitions) {
  if (repetitions.size() < 2) return std::nullopt;
  const double mean = mean_of(repetitions);
  double squares = 0;
  for (const double r : repetitions) squares += (r - mean) * (r - mean);
  const auto n = static_cast<double>(repetitions.size());
  const double half = student95(repetitions.size() - 1) * std::sqrt(squares / (n - 1) / n);
  return Interval{mean - half, mean + half};
}

std::vector<double> CaseResult::run_means() const {
  std::vector<double> out;
  for (const BenchRun& run : runs) out.push_back(mean_of(run.frame_ms));
  return out;
}

double CaseResult::mean_ms() const {
  return mean_of(run_means());
}

std::optional<double> GroupResult::best_ms() const {
  std::optional<double> best;
  for (const CaseResult& result : cases) {
    if (!result.runs.empty()) best = std::min(best.value_or(result.mean_ms()), result.mean_ms());
  }
  return best;
}

ordered_json cases_json(const std::vector<GroupResult>& groups) {
  ordered_json out = ordered_json::array();
  for (const GroupResult& group : groups) {
    for (const CaseResult& result : group.cases) out.push_back(case_json(result, group.best_ms()));
  }
  return out;
}

}  // namespace scenegen::tools
