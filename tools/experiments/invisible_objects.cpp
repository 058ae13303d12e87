// D 5.3: how many objects a number of occlusion queries finds hidden.
#include "tools/experiments/invisible_objects.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/calibration/measure.h"
#include "render/spatial/query_box.h"
#include "tools/experiments/all.h"
#include "tools/experiments/flat_tree.h"
#include "tools/experiments/measures.h"
#include "tools/experiments/octree_or_bvh.h"
#include "tools/experiments/paper.h"
#include "tools/experiments/scenes.h"
#include "tools/report/report.h"

namespace scenegen::tools {

using render::vkr::PassPart;

NodeQueries::NodeQueries(DrawStage& stage, std::size_t most_queries)
    : stage_(stage),
      most_(most_queries),
      pool_(stage.device().device, vk::QueryPoolCreateInfo({}, vk::QueryType::eOcclusion,
                                                           static_cast<std::uint32_t>(most_queries))) {
  samples_.resize(most_);
  draw_scene();
}

void NodeQueries::draw_scene() {
  stage_.frame([&](const render::PassContext& c) {
    render::begin_pass(c.frame.commands, c.pipelines, stage_.target(), c.barriers,
                       vk::SubpassContents::eInline, PassPart::first);
    render::DrawRecorder recorder(c.frame.commands, c.pipelines, c.gpu, c.scene, stage_.target().pass);
    render::record_all_solid(recorder, c.scene);
    c.frame.commands.endRenderPass();
  });
}

StageFrame NodeQueries::ask(const AskedNode* asked, std::size_t count) {
  return stage_.frame([&](const render::PassContext& c) {
    const vk::raii::CommandBuffer& commands = c.frame.commands;
    if (count > 0) commands.resetQueryPool(*pool_, 0, static_cast<std::uint32_t>(count));
    render::begin_pass(commands, c.pipelines, stage_.target(), c.barriers, vk::SubpassContents::eInline,
                       PassPart::second);
    commands.bindPipeline(vk::PipelineBindPoint::eGraphics, c.pipelines.box(stage_.target().pass));
    c.gpu.bind_frame_set(commands, c.pipelines.box_layout());
    commands.setCullMode(vk::CullModeFlagBits::eNone);
    commands.setFrontFace(vk::FrontFace::eCounterClockwise);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::array corners{glm::vec4(asked[i].box_m.lo, 1.0F), glm::vec4(asked[i].box_m.hi, 1.0F)};
      commands.pushConstants<glm::vec4>(c.pipelines.box_layout(), vk::ShaderStageFlagBits::eVertex, 0,
                                        corners);
      commands.beginQuery(*pool_, i, {});
      commands.draw(36, 1, 0, 0);
      commands.endQuery(*pool_, i);
    }
    commands.endRenderPass();
  });
}

void NodeQueries::read(std::size_t count) {
  if (count == 0) return;
  const vk::raii::Device& device = stage_.device().device;
  const vk::Result result = (*device).getQueryPoolResults(
      *pool_, 0, static_cast<std::uint32_t>(count), count * sizeof(samples_[0]), samples_.data(),
      sizeof(samples_[0]), vk::QueryResultFlagBits::eWait, *device.getDispatcher());
  if (result != vk::Result::eSuccess) throw vk::OutOfHostMemoryError("reading results of queries");
}

std::vector<AskedNode> NodeQueries::ask_all(const render::Octree& tree) {
  const render::QueryBoxes boxes(stage_.view(),
                                 {stage_.target().extent.width, stage_.target().extent.height});
  const render::CullPlanes planes =
      render::cull_planes(render::frustum_of(stage_.view().clip_from_world), stage_.scene().bounds_m());
  std::vector<AskedNode> out;
  std::vector<std::uint32_t> level{0};
  while (!level.empty()) {
    std::vector<AskedNode> asked;
    std::vector<std::uint32_t> next;
    const auto go_below = [&](std::uint32_t number) {
      const render::Octree::Node& node = tree.node(number);
      for (std::uint32_t k = 0; !node.leaf() && k < 8; ++k) next.push_back(node.first_child + k);
    };
    for (const std::uint32_t number : level) {
      const render::Octree::Node& node = tree.node(number);
      if (node.content.slots == 0 || !in_frustum(planes, node.content.box_m)) continue;
      const Box grown = boxes.grown(node.content.box_m);
      if (boxes.touches_eye(grown)) {
        go_below(number);
      } else {
        asked.push_back({number, grown, node.content.slots, false});
      }
    }
    for (std::size_t begin = 0; begin < asked.size(); begin += most_) {
      const std::size_t count = std::min(most_, asked.size() - begin);
      ask(asked.data() + begin, count);
      read(count);
      for (std::size_t i = 0; i < count; ++i) asked[begin + i].hidden = samples_[i] == 0;
    }
    for (const AskedNode& a : asked) {
      if (!a.hidden) go_below(a.node);
    }
    out.insert(out.end(), asked.begin(), asked.end());
    level = std::move(next);
  }
  return out;
}

NodeQueries::Times NodeQueries::time(const std::vector<AskedNode>& asked, std::size_t count) {
  const StageFrame frame = ask(asked.data(), count);
  Times out{frame.gpu_ms >= 0 ? frame.gpu_ms : frame.wait_ms, frame.record_ms + frame.submit_ms, 0};
  const Stopwatch watch;
  read(count);
  out.read_ms = watch.seconds() * 1e3;
  return out;
}

namespace {

/// Times of the first so many queries, beyond those of a pass without any.
struct QueryTimes {
  std::vector<double> device_ms, ask_ms, read_ms;
};

std::vector<QueryTimes> time_counts(NodeQueries& queries, const std::vector<AskedNode>& asked,
                                    const std::vector<std::size_t>& counts, std::uint32_t repeat) {
  std::vector<QueryTimes> out(counts.size());
  for (std::uint32_t r = 0; r < repeat + 2; ++r) {
    const NodeQueries::Times empty = queries.time(asked, 0);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const NodeQueries::Times t = queries.time(asked, counts[i]);
      if (r < 2) continue;  // what a driver does once
      out[i].device_ms.push_back(std::max(0.0, t.device_ms - empty.device_ms));
      out[i].ask_ms.push_back(std::max(0.0, t.ask_ms - empty.ask_ms));
      out[i].read_ms.push_back(t.read_ms);
    }
  }
  return out;
}

/// invisible(x) = c1 + c2 ln(1 + x), by least squares (METHODS 6).
render::calibration::Line log_fit(const std::vector<std::pair<double, double>>& points) {
  std::vector<double> x;
  std::vector<double> y;
  for (const auto& [queries, objects] : points) {
    x.push_back(std::log1p(queries));
    y.push_back(objects);
  }
  return render::calibration::fit_line(x, y);
}

/// Share of the variance that the fit explains.
double r_squared(const std::vector<std::pair<double, double>>& points, const render::calibration::Line& fit) {
  double mean = 0;
  for (const auto& p : points) mean += p.second / static_cast<double>(points.size());
  double left = 0;
  double all = 0;
  for (const auto& [x, y] : points) {
    const double off = y - (fit.offset + fit.slope * std::log1p(x));
    left += off * off;
    all += (y - mean) * (y - mean);
  }
  return all > 0 ? 1 - left / all : 0;
}

struct EffectFigures {
  DocumentTable table{
      "invisible-by-queries",
      "Invisible objects found, by number of queries",
      {{"queries", "queries", "", Origin::ours, Better::none, {}, 6},
       {"invisible", "invisible objects", "", Origin::ours, Better::higher, "invisiblePaper", 6},
       {"invisiblePaper", "invisible objects", "", Origin::paper, Better::higher, {}, 6},
       {"share", "of all", "%", Origin::ours, Better::none},
       {"sharePaper", "of all", "%", Origin::paper, Better::none},
       {"fit", "by the fit", "", Origin::ours, Better::none, {}, 6},
       {"deviceMs", "queries on the device", "ms", Origin::ours, Better::lower, "paperMs"},
       {"paperMs", "queries", "ms", Origin::paper, Better::lower},
       {"spread", "spread", "%"},
       {"askMs", "asking, processor", "ms", Origin::ours, Better::lower},
       {"readMs", "reading", "ms", Origin::ours, Better::lower}},
      {},
      {}};
  Chart chart{"invisible-chart",
              "Invisible objects by number of queries",
              "queries + 1",
              "share of all objects, %",
              {{"ours", {}, Origin::ours},
               {"ours, c1 + c2 ln(1 + x)", {}, Origin::ours},
               {"paper", {}, Origin::paper}},
              true,
              false,
              {}};
};

constexpr double kPaperObjects = 300000;

/// `share`: of the objects, invisible by so many queries, which take `device_ms`.
void judge_queries(const ExperimentContext& context, std::size_t count, double share, double device_ms,
                   std::vector<Verdict>& out) {
  const PaperTable paper("query_effect");
  const PaperTable::Where row{{"queried_nodes", std::to_string(count)}};
  const auto theirs = paper.number(row, "invisible_objects");
  const auto theirs_ms = paper.number(row, "query_ms");
  if (!theirs || !theirs_ms) return;
  const auto shown = static_cast<double>(count);
  out.push_back(judged(
      {"D table 2", sized(context, "objects found invisible by " + figure_text(shown) + " queries"), "", "",
       Finding::level,
       (context.quick ? "of fewer boxes than D's 300 000; " : "") +
           std::string(
               "ours ask with the tight box of what is below a node; D does not give density and view")},
      100 * share, 100 * *theirs / kPaperObjects, "%", Better::higher));
  if (count == 100) return;
  const double each = 1e3 / shown;
  out.push_back(
      judged({"D table 2", "time of a query on the device, of " + figure_text(shown), "", "", Finding::level,
              on_device(context, "the first boxes cover nearly all of the " + std::to_string(context.width) +
                                     "x" + std::to_string(context.height) +
                                     " pixels; D does not give its picture's size")},
             device_ms * each, *theirs_ms * each, "\u00B5s", Better::lower));
}

void fill(const ExperimentContext& context, const std::vector<AskedNode>& asked, std::size_t objects,
          NodeQueries& queries, EffectFigures& out, DocumentSection& section) {
  const PaperTable paper("query_effect");
  std::vector<std::size_t> counts;
  for (std::size_t row = 0; row < paper.rows(); ++row) {
    counts.push_back(static_cast<std::size_t>(paper.value(row, "queried_nodes")));
    if (counts.back() >= asked.size()) break;
  }
  counts.back() = std::min(counts.back(), asked.size());  // there are no more to ask about
  std::vector<std::pair<double, double>> points;
  std::uint64_t invisible = 0;
  std::size_t at = 0;
  for (const std::size_t count : counts) {
    for (; at < count; ++at) invisible += asked[at].hidden ? asked[at].objects : 0;
    points.emplace_back(count, invisible);
  }
  const render::calibration::Line fit = log_fit(points);
  const std::vector<QueryTimes> times = time_counts(queries, asked, counts, repetitions(context, 21, 5));
  const auto all = static_cast<double>(objects);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const PaperTable::Where row{{"queried_nodes", std::to_string(counts[i])}};
    const auto theirs = paper.number(row, "invisible_objects");
    const Spread ms = spread_of(times[i].device_ms);
    const double by_fit = fit.offset + fit.slope * std::log1p(points[i].first);
    out.table.rows.push_back({points[i].first, points[i].second, paper.cell(row, "invisible_objects"),
                              100 * points[i].second / all,
                              known(theirs ? 100 * *theirs / kPaperObjects : -1.0), by_fit, ms.median,
                              paper.cell(row, "query_ms"), spread_cell({ms}),
                              spread_of(times[i].ask_ms).median, spread_of(times[i].read_ms).median});
    const double x = points[i].first + 1;
    out.chart.series[0].points.push_back({x, 100 * points[i].second / all, {}, {}});
    out.chart.series[1].points.push_back({x, 100 * by_fit / all, {}, {}});
  }
  for (std::size_t row = 0; row < paper.rows(); ++row)
    out.chart.series[2].points.push_back({paper.value(row, "queried_nodes") + 1,
                                          100 * paper.value(row, "invisible_objects") / kPaperObjects,
                                          {},
                                          {}});
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 100 || counts[i] == 1000 || counts[i] == 10000)
      judge_queries(context, counts[i], points[i].second / all, spread_of(times[i].device_ms).median,
                    section.verdicts);
  }
  section.paragraphs.push_back(
      human_count(counts.back()) + " queries find " + in_words(100 * points.back().second / all) + " % of " +
      human_count(objects) +
      " objects invisible; invisible(x) = c1 + c2 ln(1 + x) fits with c1 = " + in_words(fit.offset) +
      ", c2 = " + in_words(fit.slope) + ", R^2 = " + in_words(r_squared(points, fit)) + ".");
}

}  // namespace

Result<DocumentSection> invisible_objects(const ExperimentContext& context) {
  const std::uint32_t count = context.quick ? 20000 : 300000;
  begin_step(context, "invisible-objects: " + human_count(count) + " boxes");
  const Scene scene = random_boxes(count, context.seed);
  const float aspect = static_cast<float>(context.width) / static_cast<float>(context.height);
  const render::View view =
      render::view_of_camera(scene.cameras.front(), scene.cameras.front().frame_from_camera.matrix(), aspect);
  auto stage = DrawStage::make(context, scene, view, render::vkr::PassKind::ids);
  if (!stage) return forward_error(stage);
  // Five objects a node: what the dissertation starts from.
  BoxedObjects objects = boxed(scene, 5);
  render::Octree tree(
      objects.slots,
      [](std::uint32_t) {
        return render::Octree::Work{36, 12};
      },
      objects.options);
  for (std::uint32_t o = 0; o < objects.boxes.size(); ++o) tree.insert(o);
  tree.refresh();
  EffectFigures figures;
  DocumentSection out{"invisible-objects", "Invisible objects and queries", {}, {}};
  auto done = (*stage)->guarded([&] {
    NodeQueries queries(**stage, 1U << 16U);
    const std::vector<AskedNode> asked = queries.ask_all(tree);
    fill(context, asked, objects.boxes.size(), queries, figures, out);
  });
  if (!done) return forward_error(done);
  out.paragraphs.emplace_back(
      "The dissertation: 163 287 of 300 000 after 50 000 queries, most of them after 1000; hence it asks "
      "only so many "
      "queries as pay, and fits a logarithm to what they find.");
  figures.table.note =
      std::string(context.quick ? "A smaller scene than the paper's 300 000 boxes: look at the shares. "
                                : "") +
      "D table 2. Boxes of random size and place; nodes of an octree of at most 5 objects a node are asked "
      "about "
      "breadth first, each with its tight box; what lies below a hidden node is hidden with it. Counts are "
      "exact for the "
      "size of the picture, and D does not give its density or view. Device: the pass with the queries less "
      "one without.";
  std::vector<Picture> pictures;
  keep_picture(take_picture(context, scene, 0, "invisible-objects", human_count(count) + " random boxes"),
               pictures, out.failures);
  out.blocks.emplace_back(std::move(figures.table));
  out.blocks.emplace_back(std::move(figures.chart));
  for (Picture& picture : pictures) out.blocks.emplace_back(std::move(picture));
  return out;
}

}  // namespace scenegen::tools
