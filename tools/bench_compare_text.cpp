// The table of a comparison that a person reads.
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "tools/bench_compare.h"
#include "tools/cli.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

std::string signed_percent(double share) {
  std::array<char, 40> text{};
  (void)std::snprintf(text.data(), text.size(), "%+.1f %%", 100 * share);
  return text.data();
}

std::string number(double value) {
  const bool whole = value == std::round(value) && value >= 0 && value < 1e15;
  return whole ? human_count(static_cast<std::uint64_t>(value)) : human_real(value, 3);
}

std::string group_name(const BenchCase& what) {
  return printable(std::filesystem::path(what.file).filename().string()) + "  " + printable(what.device) +
         (what.camera.empty() ? "" : "  " + printable(what.camera)) + "  " +
         std::to_string(what.frames_in_flight) +
         (what.frames_in_flight == 1 ? " frame in flight\n" : " frames in flight\n");
}

std::vector<std::string> cells(const CaseChange& c) {
  const double mean = c.mean_a_ms;
  std::string interval = "-";
  if (c.difference_ms)
    interval =
        signed_percent(c.difference_ms->low / mean) + " to " + signed_percent(c.difference_ms->high / mean);
  const std::string counters = c.counters_vary      ? "vary"
                               : c.counters.empty() ? "same"
                                                    : counted(c.counters.size(), "differ", "differ");
  return {printable(c.what.way.label),
          milliseconds_text(mean),
          milliseconds_text(c.mean_b_ms),
          signed_percent(c.mean_b_ms / mean - 1),
          interval,
          std::string(c.change == Change::unknown ? "too few runs" : name_of(c.change)),
          counters};
}

void add_counters(const CaseChange& c, std::string& out) {
  if (c.counters.empty()) return;
  std::vector<std::string> words;
  words.reserve(c.counters.size());
  for (const CounterChange& k : c.counters)
    words.push_back(k.name + " " + number(k.a) + " -> " + number(k.b));
  for (const std::string& line : wrap(printable(c.what.way.label + ": " + join(words, ", ")), 94))
    out += "    " + line + "\n";
}

void add_list(const std::string& title, const std::vector<std::string>& lines, std::string& out) {
  if (lines.empty()) return;
  out += "\n" + title + "\n";
  for (const std::string& line : lines) {
    for (const std::string& part : wrap(printable(line), 96)) out += "  " + part + "\n";
  }
}

}  // namespace

std::string comparison_text(const BenchComparison& comparison) {
  std::string out = "A  " + comparison.a + "\nB  " + comparison.b + "\n";
  for (std::size_t begin = 0; begin < comparison.cases.size();) {
    const std::string name = group_name(comparison.cases[begin].what);
    std::vector<std::vector<std::string>> rows{
        {"strategy", "A ms", "B ms", "B - A", "95 % of it", "frame time", "counters"}};
    std::string counters;
    std::size_t end = begin;
    for (; end < comparison.cases.size() && group_name(comparison.cases[end].what) == name; ++end) {
      rows.push_back(cells(comparison.cases[end]));
      add_counters(comparison.cases[end], counters);
    }
    out.append("\n").append(name).append(aligned(rows)).append(counters);
    begin = end;
  }
  add_list("only in A:", comparison.only_a, out);
  add_list("only in B:", comparison.only_b, out);
  add_list("failed in A:", comparison.failed_a, out);
  add_list("failed in B:", comparison.failed_b, out);
  std::uint64_t counters = 0;
  for (const CaseChange& c : comparison.cases) counters += c.counters.empty() ? 0 : 1;
  out += "\n" + counted(comparison.cases.size(), "case") +
         " in both: " + std::to_string(comparison.count(Change::faster)) + " faster, " +
         std::to_string(comparison.count(Change::slower)) + " slower, " +
         std::to_string(comparison.count(Change::same)) + " the same within noise";
  if (const auto unknown = comparison.count(Change::unknown); unknown > 0)
    out += ", " + std::to_string(unknown) + " with too few runs to tell";
  return out + "\ncounters differ in " + counted(counters, "case") + "\n";
}

}  // namespace scenegen::tools
