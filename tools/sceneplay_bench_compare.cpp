// sceneplay bench compare A B: what changed between two results, and whether it is more than noise.
#include <cstdio>

#include "tools/bench_compare.h"
#include "tools/output.h"
#include "tools/sceneplay.h"
#include "tools/trace.h"
#include "tools/verb.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

enum class FailOn : std::uint8_t { nothing, slower, counters, any };

struct CompareRequest {
  std::string a, b;
  Format format = Format::table;
  FailOn fail_on = FailOn::nothing;
  double least_percent = 1;
  bool quiet = false;
};

std::string text_of(const BenchComparison& found, Format format) {
  if (format == Format::table) return comparison_text(found);
  const ordered_json cases = comparison_json(found);
  if (format == Format::csv) return flat_csv(cases);
  return pretty({{"schema", "sceneplay/bench-comparison"},
                 {"version", 1},
                 {"a", found.a},
                 {"b", found.b},
                 {"warnings", found.warnings},
                 {"cases", cases},
                 {"onlyA", found.only_a},
                 {"onlyB", found.only_b},
                 {"failedA", found.failed_a},
                 {"failedB", found.failed_b}});
}

bool fails(const BenchComparison& found, FailOn what) {
  if (what == FailOn::nothing) return false;
  // What cannot be compared any more cannot be said to be as good as it was.
  if (!found.only_a.empty()) return true;
  const bool slower = what != FailOn::counters && found.any_slower();
  const bool counters = what != FailOn::slower && found.any_counters();
  return slower || counters;
}

Result<int> work(const CompareRequest& r) {
  auto a = read_bench(r.a);
  if (!a) return forward_error(a);
  auto b = read_bench(r.b);
  if (!b) return forward_error(b);
  auto found = compare_bench(*a, *b, r.least_percent / 100);
  if (!found) {
    found.error().where = r.a + " or " + r.b;
    return forward_error(found);
  }
  found->a = r.a;
  found->b = r.b;
  if (!r.quiet) {
    for (const std::string& warning : found->warnings)
      (void)std::fprintf(stderr, "warning: %s\n", printable(warning).c_str());
  }
  if (auto written = write_stdout(text_of(*found, r.format)); !written) return forward_error(written);
  if (found->cases.empty()) return fail(ErrorKind::bad_input, r.b, "has no case in common with " + r.a);
  return fails(*found, r.fail_on) ? 1 : 0;
}

}  // namespace

int bench_compare_verb(std::span<const std::string> arguments) {
  CompareRequest r;
  Options options(
      "sceneplay bench compare", {"sceneplay bench compare A B [options]"},
      "says what changed from A to B in the cases that both have, and whether that is more than noise.");
  options.positional("A", r.a, "a bench.json, or the folder that it is in");
  options.positional("B", r.b, "the same, measured later");
  options.group("Comparing");
  options.add("--least", real_value(r.least_percent, 0, 1000, "PERCENT"),
              "differences of the mean below this count as none, even if they are more than noise");
  options.add(
      "--fail-on",
      choice_value<FailOn>(r.fail_on, {{"nothing", FailOn::nothing},
                                       {"slower", FailOn::slower},
                                       {"counters", FailOn::counters},
                                       {"any", FailOn::any}}),
      "exit code 1 when a case is slower, a counter differs, or one of both; also when B lacks a case");
  options.group("Output");
  options.add("--format", format_value(r.format), "form of what is printed");
  options.group("General");
  options.add_general(r.quiet);
  return run_verb(options, arguments, {.work = [&] { return work(r); }});
}

}  // namespace scenegen::tools
