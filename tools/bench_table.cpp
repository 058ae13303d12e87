// The table that a person reads.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tools/bench_results.h"
#include "tools/frame_fields.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

double stage_mean(const CaseResult& result, std::string_view name) {
  double sum = 0;
  double count = 0;
  for (const BenchRun& run : result.runs) {
    for (std::size_t i = 0; i < run.stages.size(); ++i) {
      if (run.stages[i] != name) continue;
      for (const double ms : run.stages_ms[i]) {
        if (ms < 0) return -1;
        sum += ms;
        ++count;
      }
    }
  }
  return sum / count;
}

std::string per_frame(const CaseResult& result, std::uint64_t render::FrameReport::*counter) {
  const BenchRun& run = result.runs.front();
  for (std::size_t i = 0; i < counter_fields().size(); ++i) {
    if (counter_fields()[i].value == counter)
      return human_count(static_cast<std::uint64_t>(
          std::llround(static_cast<double>(run.counters[i]) / static_cast<double>(run.frame_ms.size()))));
  }
  return "-";
}

std::vector<std::string> cells(const CaseResult& result, double best_ms) {
  std::vector<double> frames;
  std::vector<double> cpu;
  for (const BenchRun& run : result.runs) {
    frames.insert(frames.end(), run.frame_ms.begin(), run.frame_ms.end());
    cpu.insert(cpu.end(), run.cpu_ms.begin(), run.cpu_ms.end());
  }
  const Summary s = summarize(frames);
  const double mean = result.mean_ms();
  const auto interval = interval95(result.run_means());
  const double gpu = stage_mean(result, "gpu");
  std::array<char, 40> ratio{};
  (void)std::snprintf(ratio.data(), ratio.size(), "%.3f", mean / best_ms);
  return {result.what.way.label,
          milliseconds_text(mean),
          interval ? "±" + milliseconds_text(interval->high - mean) : "-",
          milliseconds_text(s.median),
          milliseconds_text(s.p95),
          milliseconds_text(summarize(cpu).mean),
          gpu < 0 ? "-" : milliseconds_text(gpu),
          per_frame(result, &render::FrameReport::drawn),
          per_frame(result, &render::FrameReport::queries),
          ratio.data()};
}

}  // namespace

std::string milliseconds_text(double ms) {
  const int digits = ms >= 100 ? 1 : ms >= 10 ? 2 : 3;
  std::array<char, 40> text{};
  (void)std::snprintf(text.data(), text.size(), "%.*f", digits, ms);
  return text.data();
}

std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  std::string out;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    std::string line = " ";
    for (std::size_t i = 0; i < rows[row].size(); ++i) {
      std::size_t width = 0;
      for (const auto& other : rows) width = std::max(width, display_width(other[i]));
      const std::string blanks(width - display_width(rows[row][i]), ' ');
      line += " " + (i == 0 ? rows[row][i] + blanks : " " + blanks + rows[row][i]);
    }
    out += line + "\n";
  }
  return out;
}

std::string group_table(const GroupResult& group) {
  const BenchCase& what = group.cases.front().what;
  std::string out = printable(what.file) + "  " + printable(what.device) + "  " +
                    (what.camera.empty() ? "the file's camera" : printable(what.camera)) + "  " +
                    std::to_string(what.frames_in_flight) +
                    (what.frames_in_flight == 1 ? " frame in flight\n" : " frames in flight\n");
  std::vector<std::vector<std::string>> rows{
      {"strategy", "frame ms", "95 %", "median", "p95", "cpu ms", "gpu ms", "drawn", "queries", "vs best"}};
  for (const CaseResult& result : group.cases) {
    if (!result.runs.empty()) rows.push_back(cells(result, *group.best_ms()));
  }
  out += aligned(rows);
  for (const CaseResult& result : group.cases) {
    if (!result.error.empty())
      out += "  " + result.what.way.label + ": failed: " + printable(result.error) + "\n";
  }
  return out;
}

}  // namespace scenegen::tools
