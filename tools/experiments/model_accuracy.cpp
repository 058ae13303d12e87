// D 5.5: how far predictions of the model are from what frames take, on the public test sets in four ways of
// drawing.
#include <algorithm>
#include <array>
#include <cmath>

#include "gen/generate.h"
#include "timeline/timeline.h"
#include "tools/experiments/all.h"
#include "tools/experiments/measures.h"
#include "tools/experiments/paper.h"

namespace scenegen::tools {
namespace {

using render::model::Method;

struct ModelWay {
  Method method;
  const char* paper;  ///< its name in model_accuracy.csv
};
constexpr std::array kWays{ModelWay{Method::inline_frustum, "inline_frustum"},
                           ModelWay{Method::inline_queries, "inline_frustum_query_each_object"},
                           ModelWay{Method::octree, "octree_cached"},
                           ModelWay{Method::queries_all, "octree_cached_query_nodes"}};

struct Case {
  Spread measured_ms;
  double predicted_ms = 0;
  [[nodiscard]] double deviation() const {
    return 100.0 * std::abs(predicted_ms - measured_ms.median) / measured_ms.median;
  }
};

/// Frames of the scene at the end of its time, one after the other. The first ones record what is kept and
/// learn what is hidden.
Result<Case> measure(const ExperimentContext& context, const Scene& scene,
                     const std::shared_ptr<const timeline::Timeline>& timeline, Method method) {
  const std::size_t frames = context.quick ? 5 : 20;
  constexpr std::size_t kWarm = 6;
  auto camera = CameraMan::of_scene(scene, "", {context.width, context.height});
  if (!camera) return forward_error(camera);
  timeline::Player player(timeline);
  const auto end_s = static_cast<double>(scene.duration_s);
  player.seek(end_s);
  render::RendererOptions o = drawing(context);
  o.strategy = std::string(name_of(method));
  o.how.node_form = render::NodeForm::secondaries;  // as in the dissertation
  o.frames_in_flight = 1;
  o.predictions = true;  // made while the device works
  auto renderer = render::Renderer::create(scene, player, o);
  if (!renderer) return forward_error(renderer);
  const render::View view = camera->view(player);
  render::FrameResult frame;
  std::vector<double> times_ms;
  std::vector<double> predicted_ms;
  const Stopwatch all;
  constexpr double kPatienceS = 1.0;
  for (std::size_t i = 0; i < kWarm + 3 || (times_ms.size() < frames && all.seconds() < kPatienceS); ++i) {
    const Stopwatch watch;
    if (auto done = renderer->submit(player.seek(end_s), player, view); !done) return forward_error(done);
    if (auto done = renderer->finish(frame); !done) return forward_error(done);
    if (i < kWarm) continue;
    times_ms.push_back(watch.seconds() * 1e3);
    predicted_ms.push_back(frame.report.predicted[static_cast<std::size_t>(method)].frame_s * 1e3);
  }
  return Case{spread_of(times_ms), spread_of(predicted_ms).median};
}

struct Deviations {
  std::vector<double> ours, paper;
};

struct Summary4 {
  double mean = 0, median = 0, p90 = 0, worst = 0;
};
Summary4 summary_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {mean_of(values), spread_of(values).median,
          values[std::min(values.size() - 1, values.size() * 9 / 10)], values.back()};
}

DocumentTable summary_table(const std::array<Deviations, kWays.size()>& by_way) {
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
    const Summary4 ours = summary_of(d.ours);
    const Summary4 paper = summary_of(d.paper);
    table.rows.push_back({name, static_cast<double>(d.ours.size()), ours.mean, paper.mean, ours.median,
                          paper.median, ours.p90, paper.p90, ours.worst, paper.worst});
  };
  for (std::size_t w = 0; w < kWays.size(); ++w) {
    add(std::string(name_of(kWays[w].method)), by_way[w]);
    all.ours.insert(all.ours.end(), by_way[w].ours.begin(), by_way[w].ours.end());
    all.paper.insert(all.paper.end(), by_way[w].paper.begin(), by_way[w].paper.end());
  }
  add("all", all);
  return table;
}

/// Deviations in order: how large that of a share of the cases is at most.
Chart distribution(const std::array<Deviations, kWays.size()>& by_way) {
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

void add_case(const Result<Case>& found, const PaperTable& paper, const PaperTable::Where& row,
              std::vector<Cell> first_cells, DocumentTable& table, Deviations& deviations) {
  std::vector<Cell>& cells = first_cells;
  if (found) {
    cells.insert(cells.end(), {found->measured_ms.median, found->predicted_ms,
                               spread_cell({found->measured_ms}), found->deviation()});
    deviations.ours.push_back(found->deviation());
  } else {
    cells.insert(cells.end(), {found.error().str(), Cell(), Cell(), Cell()});
  }
  const auto theirs = paper.number(row, "deviation_percent");
  if (found && theirs) deviations.paper.push_back(*theirs);
  cells.insert(cells.end(),
               {paper.cell(row, "measured_ms"), paper.cell(row, "predicted_ms"), known(theirs.value_or(-1))});
  table.rows.push_back(std::move(cells));
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
  std::array<Deviations, kWays.size()> by_way;
  for (const int set : sets_of(context)) {
    begin_step(context, "model-accuracy: set " + std::to_string(set));
    auto made = gen::generate_test_set(set, context.seed);
    if (!made) return forward_error(made);
    const auto timeline = timeline::compile(made->scene);
    const PaperTable::Where size{{"set", std::to_string(set)}};
    const double objects = *sizes.number(size, "objects");
    const double vertices = *sizes.number(size, "vertices");
    for (std::size_t w = 0; w < kWays.size(); ++w) {
      const PaperTable::Where row{
          {"method", kWays[w].paper}, {"objects", shortest(objects)}, {"vertices", shortest(vertices)}};
      add_case(measure(context, made->scene, timeline, kWays[w].method), paper, row,
               {std::string(name_of(kWays[w].method)), static_cast<double>(set), objects, vertices}, table,
               by_way[w]);
    }
  }
  DocumentTable summary = summary_table(by_way);
  if (summary.rows.empty())
    return fail(ErrorKind::no_device, "device '" + context.device_info.name + "'",
                "no set could be drawn; the first: " + std::get<std::string>(table.rows.front()[4]));
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
  out.blocks.emplace_back(std::move(summary));
  out.blocks.emplace_back(distribution(by_way));
  out.blocks.emplace_back(std::move(table));
  return out;
}

}  // namespace scenegen::tools
