// D 5.5: how far predictions of the model are from what frames take, on the public test sets in four ways of
// drawing.
#include <algorithm>
#include <array>

#include "gen/generate.h"
#include "tools/experiments/accuracy.h"
#include "tools/experiments/all.h"
#include "tools/experiments/measures.h"
#include "tools/experiments/paper.h"
#include "tools/report/report.h"

namespace scenegen::tools {
namespace {

/// Names of kAccuracyMethods in model_accuracy.csv.
constexpr std::array kPaperNames{"inline_frustum", "inline_frustum_query_each_object", "octree_cached",
                                 "octree_cached_query_nodes"};
constexpr std::size_t kWays = kAccuracyMethods.size();
static_assert(kPaperNames.size() == kWays);

std::string way_name(std::size_t way) {
  return std::string(name_of(kAccuracyMethods[way]));
}

struct Case {
  Spread measured_ms;
  double predicted_ms = 0;
  [[nodiscard]] double deviation() const { return deviation_percent(predicted_ms, measured_ms.median); }
};

Result<Case> measure(const ExperimentContext& context, const Scene& scene, render::model::Method method) {
  render::RendererOptions o = accuracy_options(drawing(context), method);
  o.frames_in_flight = 1;
  auto run = measure_accuracy(scene, method, o, {.frames = context.quick ? 5U : 20U});
  if (!run) return forward_error(run);
  return Case{spread_of(run->one_ms), run->predicted_one_ms};
}

struct Deviations {
  std::vector<double> ours, paper;
};

DocumentTable summary_table(const std::array<Deviations, kWays>& by_way) {
  DocumentTable table{
      "accuracy-summary",
      "Deviation of predictions, %",
      {{"way", "way", ""},
       {"cases", "cases", "", Origin::ours, Better::none, {}, 4},
       {"mean", "mean", "%", Origin::ours, Better::lower, "meanPaper"},
       {"meanPaper", "mean", "%", Origin::paper, Better::lower},
       {"median", "median", "%", Origin::ours, Better::lower, "medianPaper"},
       {"medianPaper", "median", "%", Origin::paper, Better::lower},
       {"p90", "90th percentile", "%", Origin::ours, Better::lower, "p90Paper"},
       {"p90Paper", "90th percentile", "%", Origin::paper, Better::lower},
       {"worst", "worst", "%", Origin::ours, Better::lower, "worstPaper"},
       {"worstPaper", "worst", "%", Origin::paper, Better::lower}},
      {},
      "Of the same sets in the same ways; without the dissertation's sets 1 to 4, which are private."};
  Deviations all;
  const auto add = [&](const std::string& name, const Deviations& d) {
    if (d.ours.empty() || d.paper.empty()) return;
    const DeviationSummary ours = summarize_deviations(d.ours);
    const DeviationSummary paper = summarize_deviations(d.paper);
    table.rows.push_back({name, static_cast<double>(d.ours.size()), ours.mean, paper.mean, ours.median,
                          paper.median, ours.p90, paper.p90, ours.worst, paper.worst});
  };
  for (std::size_t w = 0; w < kWays; ++w) {
    add(way_name(w), by_way[w]);
    all.ours.insert(all.ours.end(), by_way[w].ours.begin(), by_way[w].ours.end());
    all.paper.insert(all.paper.end(), by_way[w].paper.begin(), by_way[w].paper.end());
  }
  add("all", all);
  return table;
}

/// Deviations in order: how large that of a share of the cases is at most.
Chart distribution(const std::array<Deviations, kWays>& by_way) {
  Chart chart{"accuracy-distribution",
              "Deviation that so many cases stay below",
              "share of cases, %",
              "deviation, %",
              {{"ours", {}, Origin::ours}, {"paper", {}, Origin::paper}},
              false,
              false,
              {}};
  for (const bool paper : {false, true}) {
    std::vector<double> all;
    for (const Deviations& d : by_way) {
      const std::vector<double>& values = paper ? d.paper : d.ours;
      all.insert(all.end(), values.begin(), values.end());
    }
    std::sort(all.begin(), all.end());
    for (std::size_t i = 0; i < all.size(); ++i)
      chart.series[paper ? 1 : 0].points.push_back(
          {100.0 * static_cast<double>(i + 1) / static_cast<double>(all.size()), all[i], {}, {}});
  }
  return chart;
}

std::vector<int> sets_of(const ExperimentContext& context) {
  if (context.quick) return {5, 14, 16, 41, 45, 48};
  std::vector<int> out;
  for (int set = 5; set <= 48; ++set) out.push_back(set);
  return out;
}

void add_case(const Case& found, const PaperTable& paper, const PaperTable::Where& row,
              std::vector<Cell> first_cells, DocumentTable& table, Deviations& deviations) {
  std::vector<Cell>& cells = first_cells;
  cells.insert(cells.end(), {found.measured_ms.median, found.predicted_ms, spread_cell({found.measured_ms}),
                             found.deviation()});
  deviations.ours.push_back(found.deviation());
  const auto theirs = paper.number(row, "deviation_percent");
  if (theirs) deviations.paper.push_back(*theirs);
  cells.insert(cells.end(),
               {paper.cell(row, "measured_ms"), paper.cell(row, "predicted_ms"), known(theirs.value_or(-1))});
  table.rows.push_back(std::move(cells));
}

/// `all`: the last row of summary_table().
std::vector<Verdict> verdicts_of(const ExperimentContext& context, const DocumentTable& summary,
                                 const DocumentTable& by_set) {
  const auto number = [](const std::vector<Cell>& row, std::size_t column) {
    return std::get<double>(row[column]);
  };
  const std::vector<Cell>& all = summary.rows.back();
  const auto worst_way =
      std::max_element(summary.rows.begin(), std::prev(summary.rows.end()),
                       [&](const auto& a, const auto& b) { return number(a, 2) < number(b, 2); });
  const auto worst =
      std::max_element(by_set.rows.begin(), by_set.rows.end(),
                       [&](const auto& a, const auto& b) { return number(a, 7) < number(b, 7); });
  const std::string sets = context.quick ? "six of the 44 sets" : "44 sets";
  const std::string guessed = context.costs ? "" : "unit costs are guesses, as nothing was calibrated; ";
  return {judged({"D tables 7-30", "deviation of predictions, mean of " + sets + " in 4 ways", "", "",
                  Finding::level,
                  guessed + "largest for " + std::get<std::string>((*worst_way)[0]) + " (" +
                      with_unit(number(*worst_way, 2), "%") + ")"},
                 number(all, 2), number(all, 3), "%", Better::lower),
          judged({"D tables 7-30", "deviation of predictions, median", "", "", Finding::level,
                  guessed + "half of the predictions are nearer than this"},
                 number(all, 4), number(all, 5), "%", Better::lower),
          judged({"D tables 7-30", "deviation of predictions, worst", "", "", Finding::level,
                  "set " + figure_text(number(*worst, 1)) + " by " + std::get<std::string>((*worst)[0]) +
                      ", a frame of " + with_unit(number(*worst, 4), "ms") + " predicted as " +
                      with_unit(number(*worst, 5), "ms")},
                 number(all, 8), number(all, 9), "%", Better::lower)};
}

}  // namespace

Result<DocumentSection> model_accuracy(const ExperimentContext& context) {
  const PaperTable paper("model_accuracy");
  const PaperTable sizes("test_sets");
  DocumentTable table{"accuracy-by-set",
                      "Frame times, measured and predicted",
                      {{"way", "way", ""},
                       {"set", "set", "", Origin::ours, Better::none, {}, 2},
                       {"objects", "objects", "", Origin::ours, Better::none, {}, 6},
                       {"vertices", "vertices", "", Origin::ours, Better::none, {}, 9},
                       {"measuredMs", "measured", "ms"},
                       {"predictedMs", "predicted", "ms"},
                       {"spread", "spread", "%"},
                       {"deviation", "deviation", "%", Origin::ours, Better::lower, "deviationPaper"},
                       {"measuredPaper", "measured", "ms", Origin::paper},
                       {"predictedPaper", "predicted", "ms", Origin::paper},
                       {"deviationPaper", "deviation", "%", Origin::paper, Better::lower}},
                      {},
                      {}};
  std::array<Deviations, kWays> by_way;
  std::vector<Failure> failures;
  for (const int set : sets_of(context)) {
    begin_step(context, "model-accuracy: set " + std::to_string(set));
    auto made = gen::generate_test_set(set, context.seed);
    if (!made) return forward_error(made);
    const PaperTable::Where size{{"set", std::to_string(set)}};
    const double objects = *sizes.number(size, "objects");
    const double vertices = *sizes.number(size, "vertices");
    for (std::size_t w = 0; w < kWays; ++w) {
      const PaperTable::Where row{
          {"method", kPaperNames[w]}, {"objects", shortest(objects)}, {"vertices", shortest(vertices)}};
      const std::string name = way_name(w);
      const Result<Case> found = measure(context, made->scene, kAccuracyMethods[w]);
      if (!found) {
        failures.push_back({"model-accuracy, set " + std::to_string(set) + ": " + name, found.error().str()});
        continue;
      }
      add_case(*found, paper, row, {name, static_cast<double>(set), objects, vertices}, table, by_way[w]);
    }
  }
  DocumentTable summary = summary_table(by_way);
  if (summary.rows.empty())
    return fail(ErrorKind::no_device, "device '" + context.device_info.name + "'",
                "no set could be drawn" + (failures.empty() ? "" : "; the first: " + failures.front().why));
  table.note = std::string("D tables 7 to 30. Unit costs ") +
               (context.costs ? "come from a calibration of this device, whose scenes are none of these"
                              : "are rough guesses, as nothing was calibrated: the deviation says little") +
               "; nothing is corrected by what is measured. One frame in flight, so processor and device "
               "work one after the "
               "other; kept command buffers.";
  const std::vector<Cell>& all = summary.rows.back();
  DocumentSection out{"model-accuracy", "Accuracy of the model", {}, {}};
  const auto words = [&](std::size_t column) { return in_words(std::get<double>(all[column])); };
  out.paragraphs.push_back("Predictions are off by " + words(2) +
                           " % in the mean (the dissertation's for the same sets and ways: " + words(3) +
                           " %), " + words(4) + " % in the median (" + words(5) + " %), " + words(8) +
                           " % at worst (" + words(9) + " %).");
  out.verdicts = verdicts_of(context, summary, table);
  out.blocks.emplace_back(std::move(summary));
  out.blocks.emplace_back(distribution(by_way));
  out.blocks.emplace_back(std::move(table));
  out.failures = std::move(failures);
  return out;
}

}  // namespace scenegen::tools
