#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "render/calibration/calibration.h"
#include "render/calibration/measure.h"
#include "render/calibration/test_scene.h"
#include "render/calibration/unit_names.h"
#include "render/model/octree_size.h"
#include "render/model/prediction.h"

namespace scenegen::render {
namespace {

using calibration::Line;
using calibration::Measured;
using calibration::MeasureOptions;
using calibration::Stages;
using calibration::Step;
using calibration::TestScene;
using calibration::Trial;
using model::Curve;
using model::Shading;
using model::UnitCosts;

/// What one renderer measured, by trial.
struct Run {
  const TestScene* test = nullptr;
  std::vector<Measured> results;

  [[nodiscard]] const Measured& empty() const { return results.front(); }
  /// Steps of a trial that were measured, in order.
  [[nodiscard]] std::vector<std::size_t> of(Trial trial) const {
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < results.size(); ++i) {
      if (test->steps[i].trial == trial && results[i].samples > 0) out.push_back(i);
    }
    return out;
  }
  [[nodiscard]] const Step& step(std::size_t i) const { return test->steps[i]; }
  /// Device time beyond an empty frame.
  [[nodiscard]] double device_s(std::size_t i) const {
    return results[i].steady.device_s - empty().steady.device_s;
  }
  [[nodiscard]] double record_s(std::size_t i) const {
    return results[i].steady.record_s - empty().steady.record_s;
  }
  [[nodiscard]] double plan_s(std::size_t i) const {
    return results[i].steady.plan_s - empty().steady.plan_s;
  }
};

/// Takes costs from runs; remembers which came out negative.
class Fit {
 public:
  explicit Fit(Calibration& out, double pixels) : out_(out), c_(out.costs), pixels_(pixels) {}

  double positive(const char* name, double value) {
    if (value >= 0.0 && std::isfinite(value)) return value;
    if (std::find(out_.clamped.begin(), out_.clamped.end(), name) == out_.clamped.end())
      out_.clamped.emplace_back(name);
    return 0.0;
  }
  void set(const char* name, double& unit, double value) {
    unit = positive(name, value);
    measured_.emplace_back(name);
  }
  void set(const char* name, Curve& curve, Curve value) {
    for (double& y : value.y) y = positive(name, y);
    curve = std::move(value);
    measured_.emplace_back(name);
  }

  void inline_run(const Run& run);
  void shadows(const Run& with, const Run& without);
  void kept(const Run& inline_run, const std::vector<std::pair<std::uint32_t, Run>>& runs);
  void listed(const Run& run);
  void queries(const Run& flat, const Run& each);
  void second_part(const Run& kept, const Run& asking);
  void indirect(const Run& fine, const Run& coarse);
  void finish();

 private:
  /// Cost of one more unit, by how a time grows with its number.
  template <class X, class Y>
  static double slope(const Run& run, Trial trial, const X& x, const Y& y) {
    std::vector<double> xs{0.0};
    std::vector<double> ys{0.0};
    for (const std::size_t i : run.of(trial)) xs.push_back(x(i)), ys.push_back(y(i));
    return calibration::fit_line(xs, ys).slope;
  }
  /// More of it never costs less: what noise says otherwise is lifted.
  static void rising(Curve& curve) {
    for (std::size_t i = 1; i < curve.y.size(); ++i) curve.y[i] = std::max(curve.y[i], curve.y[i - 1]);
  }
  void empty_frame(const Run& run);
  void draws(const Run& run);
  void fragments(const Run& run);
  void fit_outlines(const Run& run);
  void overlaps(const Run& run);
  void meshes(const Run& run);
  Curve layers(const Run& run, Trial trial) const;

  Calibration& out_;
  UnitCosts& c_;
  double pixels_;
  std::vector<std::string> measured_;
};

void Fit::empty_frame(const Run& run) {
  const Measured& empty = run.empty();
  set("emptyCpuS", c_.empty_cpu_s, empty.steady.cpu_s());
  // Two in flight, the device's part is all that the frames can be apart, or less.
  const double device_s =
      empty.period_s > 0.0 ? std::min(empty.period_s, empty.steady.device_s) : empty.steady.device_s;
  set("emptyDeviceS", c_.empty_device_s, device_s);
  set("latencyS", c_.latency_s, empty.steady.device_s - device_s);
}

void Fit::draws(const Run& run) {
  const auto count = [&](std::size_t i) { return static_cast<double>(run.step(i).draws); };
  set("recordS", c_.record_s,
      slope(run, Trial::boxes, count, [&](std::size_t i) { return run.record_s(i); }));
  set("cullSlotS", c_.cull_slot_s,
      slope(run, Trial::boxes, count, [&](std::size_t i) { return run.plan_s(i); }));
  set("updateObjectS", c_.update_object_s, slope(run, Trial::boxes, count, [&](std::size_t i) {
        const Stages& first = run.results[i].first;
        const Stages& steady = run.results[i].steady;
        return first.update_s - steady.update_s + std::max(0.0, first.record_s - steady.record_s);
      }));

  const double box_s = slope(run, Trial::boxes, count, [&](std::size_t i) { return run.device_s(i); });
  set("drawS", c_.draw_s[static_cast<std::size_t>(Shading::plain)],
      Curve{{36.0}, {box_s - 36.0 * c_.shadow_vertex_s}});
}

/// Spheres whose triangles cover a fragment or so: those that cover none are dropped early and cost far less.
/// What their fragments and outlines cost is taken off, as far as it is not done beside the vertices' work.
void Fit::meshes(const Run& run) {
  const auto each_s = [&](std::size_t i, double textured) {
    const Step& step = run.step(i);
    const double n = step.draws;
    const double covered = step.share * pixels_;
    const model::Load load{n, n * step.vertices, covered, textured, step.share};
    const double fragments_s = step.share > 0.0 ? model::device_stages(load, pixels_, c_).fragments_s : 0.0;
    return (run.device_s(i) + covered * c_.background_s - (1.0 - c_.stage_overlap) * fragments_s) / n -
           c_.shadow_vertex_s * step.vertices;
  };
  Curve plain = c_.draw_s[static_cast<std::size_t>(Shading::plain)];
  std::vector<std::pair<double, double>> points{{plain.x.front(), plain.y.front()}};
  for (const std::size_t i : run.of(Trial::meshes)) points.emplace_back(run.step(i).vertices, each_s(i, 0.0));
  std::sort(points.begin(), points.end());
  plain = {};
  for (const auto& [vertices, s] : points)
    plain.x.push_back(vertices), plain.y.push_back(positive("drawS", s));
  rising(plain);
  // The textured ones are measured at two sizes: between them the ratio is interpolated.
  Curve ratio;
  for (const Trial trial : {Trial::textured_boxes, Trial::textured_meshes}) {
    for (const std::size_t i : run.of(trial)) {
      // Textures never save anything; above 10 it is noise.
      const double plain_s = plain.line_at(run.step(i).vertices);
      ratio.x.push_back(run.step(i).vertices);
      ratio.y.push_back(plain_s > 0.0 ? std::clamp(each_s(i, 1.0) / plain_s, 1.0, 10.0) : 1.0);
    }
  }
  Curve textured = plain;
  for (std::size_t k = 0; k < plain.x.size() && !ratio.x.empty(); ++k) textured.y[k] *= ratio.at(plain.x[k]);
  set("drawS", c_.draw_s[static_cast<std::size_t>(Shading::plain)], plain);
  set("drawS", c_.draw_s[static_cast<std::size_t>(Shading::textured)], textured);
}

Curve Fit::layers(const Run& run, Trial trial) const {
  Curve out;
  const auto steps = run.of(trial);
  for (const std::size_t one : steps) {
    for (const std::size_t more : steps) {
      if (run.step(one).layers != 1 || run.step(more).layers <= 1 ||
          run.step(one).share != run.step(more).share)
        continue;
      const double fragments = (run.step(more).layers - 1) * run.step(one).share * pixels_;
      out.x.push_back(run.step(one).share);
      out.y.push_back((run.device_s(more) - run.device_s(one)) / fragments);
    }
  }
  if (out.x.size() > 1 && out.x.front() > out.x.back()) {
    std::reverse(out.x.begin(), out.x.end());
    std::reverse(out.y.begin(), out.y.end());
  }
  return out;
}

void Fit::fragments(const Run& run) {
  const Curve plain = layers(run, Trial::layers);
  set("fragmentS", c_.fragment_s[static_cast<std::size_t>(Shading::plain)], plain);
  set("fragmentS", c_.fragment_s[static_cast<std::size_t>(Shading::textured)],
      layers(run, Trial::textured_layers));
  const Curve hidden = layers(run, Trial::hidden_layers);
  if (!hidden.y.empty()) set("hiddenFragmentS", c_.hidden_fragment_s, hidden.y.front());
  // A layer over the whole sky costs its fragments less the sky's.
  for (const std::size_t i : run.of(Trial::layers)) {
    if (run.step(i).layers == 1 && run.step(i).share == 1.0 && !plain.y.empty())
      set("backgroundS", c_.background_s, plain.y.back() - run.device_s(i) / pixels_);
  }
  fit_outlines(run);
}

/// Boxes that are large enough to be seen have vertices, fragments and outlines: what outlines cost and how
/// far all that is done side by side are the two numbers that explain their times best.
void Fit::fit_outlines(const Run& run) {
  struct Point {
    double vertices_s, fragments_s, outlines, measured_s;
  };
  std::vector<Point> points;
  double most_s = 0.0;  // an outline costs no more than all of the time
  for (const std::size_t i : run.of(Trial::large_boxes)) {
    const Step& step = run.step(i);
    const double n = step.draws;
    const double area = step.share * pixels_;
    points.push_back({n * c_.draw_s[0].line_at(36.0), area * c_.fragment_s[0].at(step.share),
                      model::outlines({n, 36.0 * n, area, 0, step.share}),
                      run.device_s(i) + area * c_.background_s});
    most_s = std::max(most_s, points.back().measured_s / points.back().outlines);
  }
  if (points.size() < 2) return;
  double best = std::numeric_limits<double>::max();
  constexpr int kSteps = 100;
  for (int e = 0; e <= kSteps; ++e) {
    for (int o = 0; o <= 10; ++o) {
      const double edge_s = most_s * e / kSteps;
      double error = 0.0;
      for (const Point& p : points) {
        const double model_s = model::beside_s(p.vertices_s, p.fragments_s + edge_s * p.outlines, 0.1 * o);
        error += std::pow(std::log(std::max(model_s, 1e-9) / std::max(p.measured_s, 1e-9)), 2.0);
      }
      if (error >= best) continue;
      best = error;
      c_.edge_s = edge_s;
      c_.stage_overlap = 0.1 * o;
    }
  }
  measured_.emplace_back("edgeS");
  measured_.emplace_back("stageOverlap");
}

void Fit::overlaps(const Run& run) {
  const auto boxes = run.of(Trial::boxes);
  if (boxes.empty() || run.results[boxes.back()].period_s <= 0.0) return;
  const Measured& m = run.results[boxes.back()];
  const double cpu_s = m.steady.cpu_s();
  const double gpu_s = m.steady.device_s - c_.latency_s;
  set("frameOverlap", c_.frame_overlap,
      std::clamp((cpu_s + gpu_s - m.period_s) / std::min(cpu_s, gpu_s), 0.0, 1.0));
}

void Fit::inline_run(const Run& run) {
  empty_frame(run);
  draws(run);
  fragments(run);
  meshes(run);
  overlaps(run);
}

void Fit::shadows(const Run& with, const Run& without) {
  const auto count = [&](std::size_t i) { return static_cast<double>(with.step(i).draws); };
  const auto grown = [&](auto stage) {
    return slope(with, Trial::boxes, count, [&](std::size_t i) { return (with.*stage)(i); }) -
           slope(without, Trial::boxes, count, [&](std::size_t i) { return (without.*stage)(i); });
  };
  set("shadowSlotS", c_.shadow_slot_s, grown(&Run::record_s));
  set("shadowVertexS", c_.shadow_vertex_s, grown(&Run::device_s) / 36.0);
}

void Fit::kept(const Run& flat, const std::vector<std::pair<std::uint32_t, Run>>& runs) {
  std::vector<std::pair<double, double>> sending;
  std::vector<double> chunks{0.0};
  std::vector<double> chunk_s{0.0};
  for (const auto& one : runs) {
    const Run& run = one.second;
    const auto boxes = run.of(Trial::boxes);
    if (boxes.empty()) continue;
    const FrameReport& last = run.results[boxes.back()].report;
    const auto secondaries = [&](std::size_t i) {
      return static_cast<double>(run.results[i].report.secondaries);
    };
    sending.emplace_back(
        static_cast<double>(last.draws) / std::max(1.0, secondaries(boxes.back())),
        slope(run, Trial::boxes, secondaries, [&](std::size_t i) { return run.record_s(i); }));
    for (const std::size_t i : boxes) {
      chunks.push_back(secondaries(i));
      chunk_s.push_back(run.device_s(i) - flat.device_s(i));
    }
  }
  std::sort(sending.begin(), sending.end());
  Curve curve;
  for (const auto& [draws, each_s] : sending) curve.x.push_back(draws), curve.y.push_back(each_s);
  rising(curve);
  set("secondaryS", c_.secondary_s, curve);
  set("secondaryDeviceS", c_.secondary_device_s, calibration::fit_line(chunks, chunk_s).slope);

  // The fewest command buffers: their own cost shows least. And the smallest nodes, for walking.
  const Run& coarse = runs.back().second;
  const auto drawn = [&](std::size_t i) {
    return static_cast<double>(coarse.results[i].first_report.recorded_draws);
  };
  set("recordKeptS", c_.record_kept_s, slope(coarse, Trial::boxes, drawn, [&](std::size_t i) {
        return coarse.results[i].first.record_s - coarse.results[i].steady.record_s;
      }));
  const Run& fine = runs.front().second;
  const auto levels = [&, n = runs.front().first](std::size_t i) {
    return fine.step(i).draws * std::max(1.0, model::octree_height(fine.step(i).draws, n));
  };
  set("intersectS", c_.intersect_s, slope(fine, Trial::boxes, levels, [&](std::size_t i) {
        return fine.results[i].first.update_s - flat.results[i].first.update_s;
      }));
  const auto nodes = [&](std::size_t i) { return static_cast<double>(fine.results[i].report.nodes); };
  set("visitNodeS", c_.visit_node_s,
      slope(fine, Trial::boxes, nodes, [&](std::size_t i) { return fine.plan_s(i); }));
  for (const std::size_t i : fine.of(Trial::halved_boxes)) {
    const double tests = static_cast<double>(fine.results[i].report.tested);
    // Few boxes need a test here, so noise weighs much; a test is no dearer than a visit with all it does.
    const double each_s = (fine.plan_s(i) - nodes(i) * c_.visit_node_s) / std::max(1.0, tests);
    set("cullNodeS", c_.cull_node_s, std::min(each_s, c_.visit_node_s));
  }
}

void Fit::listed(const Run& run) {
  set("listSlotS", c_.list_slot_s,
      slope(
          run, Trial::boxes, [&](std::size_t i) { return static_cast<double>(run.step(i).draws); },
          [&](std::size_t i) {
            return run.plan_s(i) - static_cast<double>(run.results[i].report.nodes) * c_.visit_node_s;
          }));
}

void Fit::queries(const Run& flat, const Run& each) {
  // A query for each of many boxes that are hardly seen: beyond drawing them.
  const auto asked = [&](std::size_t i) { return static_cast<double>(each.results[i].report.queries); };
  const double both_s = positive("askS", slope(each, Trial::boxes, asked, [&](std::size_t i) {
                                   return each.record_s(i) - flat.record_s(i);
                                 }));
  // Asking and reading happen in one frame; what is read alone shows in the empty frame that follows.
  const double read_s = slope(each, Trial::boxes, asked, [&](std::size_t i) {
    return each.results[i].leave_record_s - each.empty().steady.record_s;
  });
  set("receiveS", c_.receive_s, std::min(positive("receiveS", read_s), both_s));
  set("askS", c_.ask_s, both_s - c_.receive_s);
  set("queryS", c_.query_s,
      slope(each, Trial::boxes, asked, [&](std::size_t i) { return each.device_s(i) - flat.device_s(i); }));
}

/// Boxes behind a wall, asked about and skipped, against the same drawn from the same kept commands: the wall
/// and all that a frame costs besides are in both.
void Fit::second_part(const Run& kept, const Run& asking) {
  const double draw_s = c_.draw_s[static_cast<std::size_t>(Shading::plain)].line_at(36.0);
  std::vector<double> skipped, device_s, cpu_s;
  bool timed = true;
  for (const std::size_t i : asking.of(Trial::hidden_boxes)) {
    const FrameReport& r = asking.results[i].report;
    if (r.believed_hidden == 0 || kept.results[i].samples == 0) continue;
    const double share = static_cast<double>(r.believed_hidden) / static_cast<double>(r.secondaries);
    const double draws = share * asking.step(i).draws;
    const auto queries = static_cast<double>(r.queries);
    skipped.push_back(draws);
    const double second_part_ms = r.gpu_stages_ms[static_cast<std::size_t>(GpuStage::second_part)];
    timed = timed && second_part_ms >= 0.0;
    // Boxes behind the wall may be drawn while the wall is shaded, and cost nothing then: where the device
    // tells how long the second part took, that is the better figure.
    device_s.push_back(timed ? second_part_ms * 1e-3
                             : asking.device_s(i) - kept.device_s(i) + draws * draw_s - queries * c_.query_s);
    cpu_s.push_back(asking.record_s(i) - kept.record_s(i) - queries * (c_.ask_s + c_.receive_s));
  }
  if (skipped.size() < 2) return;
  const Line device = calibration::fit_line(skipped, device_s);
  set("skippedDrawS", c_.skipped_draw_s, device.slope);
  set("secondPartDeviceS", c_.second_part_device_s, device.offset);
  set("secondPartCpuS", c_.second_part_cpu_s, *std::min_element(cpu_s.begin(), cpu_s.end()));
}

void Fit::indirect(const Run& fine, const Run& coarse) {
  const auto nodes = [](const Run& run, std::size_t i) {
    return static_cast<double>(run.results[i].report.indirect_commands);
  };
  const auto boxes = fine.of(Trial::boxes);
  if (boxes.empty() || nodes(fine, boxes.back()) <= 0.0) return;  // the device cannot
  set("nodeCommandS", c_.node_command_s,
      slope(
          fine, Trial::boxes, [&](std::size_t i) { return nodes(fine, i); },
          [&](std::size_t i) { return fine.record_s(i); }));
  set("writeIndirectS", c_.write_indirect_s,
      slope(
          coarse, Trial::boxes,
          [&](std::size_t i) { return static_cast<double>(coarse.results[i].first_report.recorded_draws); },
          [&](std::size_t i) {
            return coarse.results[i].first.record_s - coarse.results[i].steady.record_s;
          }));
  // On the device: so much a node and so much a draw, from few and from many nodes.
  double nn = 0.0, nd = 0.0, dd = 0.0, nt = 0.0, dt = 0.0;
  for (const Run* run : {&fine, &coarse}) {
    for (const std::size_t i : run->of(Trial::boxes)) {
      const double n = nodes(*run, i);
      const double d = run->step(i).draws;
      nn += n * n, nd += n * d, dd += d * d;
      nt += n * run->device_s(i), dt += d * run->device_s(i);
    }
  }
  const double determinant = nn * dd - nd * nd;
  if (determinant <= 0.0) return;
  const double draw_s = (nn * dt - nd * nt) / determinant;
  const Curve& plain = c_.draw_s[static_cast<std::size_t>(Shading::plain)];
  set("nodeCommandDeviceS", c_.node_command_device_s, (dd * nt - nd * dt) / determinant);
  set("indirectDrawS", c_.indirect_draw_s, draw_s - plain.line_at(36.0) + plain.line_at(0.0));
}

void Fit::finish() {
  for (const UnitName& unit : unit_names()) {
    const std::string name(unit.name);
    if (std::find(measured_.begin(), measured_.end(), name) == measured_.end())
      out_.not_measured.push_back(name);
  }
}

/// The runs of a calibration, one renderer each, with a share of the time.
class Runs {
 public:
  Runs(const CalibrationOptions& options, std::shared_ptr<vkr::Device> device, bool software)
      : options_(options), device_(std::move(device)) {
    test_ = calibration::make_test_scene(calibration::test_sizes(software, options.quick), options.size);
    budget_s_ = options.budget_s > 0.0 ? options.budget_s : options.quick ? 8.0 : software ? 75.0 : 15.0;
    how_.longest_frame_s = software ? 0.5 : 0.05;
    if (options.quick) how_.least_rounds = 1, how_.frames = 1;
  }

  /// From now on.
  void use(NodeForm form) { form_ = form; }

  template <class Wanted>
  Result<Run> run(const char* strategy, std::uint32_t per_node, bool shadows, double share,
                  const Wanted& wanted) {
    RendererOptions o;
    o.shared_device = device_;
    o.size = options_.size;
    o.samples = options_.samples;
    o.strategy = strategy;
    o.how.objects_per_node = per_node;
    o.how.node_form = form_;
    o.shadows = shadows;
    MeasureOptions how = how_;
    how.budget_s = budget_s_ * share;
    how.settle = std::string_view(strategy).find("queries") != std::string_view::npos ? 3
                 : options_.quick                                                     ? 0
                                                                                      : 1;
    how.progress = [&](double part) {
      if (options_.progress) options_.progress(std::min(1.0, done_ + share * part));
    };
    auto results = calibration::measure(test_, o, how, wanted);
    done_ += share;
    if (options_.progress) options_.progress(std::min(1.0, done_));
    if (!results) return forward_error(results);
    return Run{&test_, std::move(*results)};
  }

 private:
  const CalibrationOptions& options_;
  std::shared_ptr<vkr::Device> device_;
  TestScene test_;
  MeasureOptions how_;
  NodeForm form_ = NodeForm::secondaries;
  double budget_s_ = 0;
  double done_ = 0;
};

/// Costs of queries and of what is kept, as differences to drawing without.
Result<void> measure_octrees(Runs& runs, const Run& flat, bool quick, Fit& fit) {
  const auto boxes = [](const Step& s) {
    return s.trial == Trial::empty || s.trial == Trial::boxes || s.trial == Trial::halved_boxes;
  };
  std::vector<std::pair<std::uint32_t, Run>> kept;
  constexpr std::uint32_t kAsked = 100;  // objects a node where queries are measured
  const std::vector<std::uint32_t> sizes =
      quick ? std::vector<std::uint32_t>{kAsked} : std::vector<std::uint32_t>{10, kAsked, 1000};
  for (const std::uint32_t n : sizes) {
    Result<Run> run = runs.run("octree", n, false, quick ? 0.2 : 0.09, [&](const Step& s) {
      return boxes(s) || (n == kAsked && s.trial == Trial::hidden_boxes);
    });
    if (!run) return forward_error(run);
    kept.emplace_back(n, std::move(*run));
  }
  fit.kept(flat, kept);
  Result<Run> each = runs.run("inline-queries", 0, false, quick ? 0.1 : 0.06, boxes);
  if (!each) return forward_error(each);
  Result<Run> asking = runs.run("queries-all", kAsked, false, quick ? 0.1 : 0.07, [](const Step& s) {
    return s.trial == Trial::empty || s.trial == Trial::hidden_boxes;
  });
  if (!asking) return forward_error(asking);
  fit.queries(flat, *each);
  const auto same = std::find_if(kept.begin(), kept.end(), [](const auto& k) { return k.first == kAsked; });
  fit.second_part(same->second, *asking);
  if (quick) return {};
  runs.use(NodeForm::indirect);
  Result<Run> fine = runs.run("octree", 10, false, 0.05, boxes);
  if (!fine) return forward_error(fine);
  Result<Run> coarse = runs.run("octree", 1000, false, 0.05, boxes);
  if (!coarse) return forward_error(coarse);
  fit.indirect(*fine, *coarse);
  Result<Run> recorded = runs.run("octree-record", kAsked, false, 0.04, boxes);
  if (!recorded) return forward_error(recorded);
  fit.listed(*recorded);
  return {};
}

}  // namespace

CalibrationKey calibration_key(const DeviceInfo& device, glm::uvec2 size, std::uint32_t samples,
                               bool shadows) {
  return {device.uuid, device.name, device.driver, size, samples, shadows};
}

Result<Calibration> calibrate(const CalibrationOptions& options) {
  Result<std::shared_ptr<vkr::Device>> device =
      options.shared_device ? options.shared_device : share_device(options.device);
  if (!device) return forward_error(device);
  const DeviceInfo& info = info_of(**device);
  const bool software = info.type == "CPU";
  Calibration out;
  out.key = calibration_key(info, options.size, options.samples, options.shadows);
  out.quick = options.quick;
  out.costs = model::rough_costs(software);
  Runs runs(options, *device, software);
  Fit fit(out, static_cast<double>(options.size.x) * options.size.y);

  const auto drawn = [](const Step& s) { return s.trial != Trial::hidden_boxes; };
  const auto boxes = [](const Step& s) { return s.trial == Trial::empty || s.trial == Trial::boxes; };
  const double flat_share = !options.shadows ? 0.0 : options.quick ? 0.1 : 0.11;
  const double first = (options.quick ? 0.6 : 0.46) - flat_share;
  Result<Run> with = runs.run("inline", 0, options.shadows, first, drawn);
  if (!with) return forward_error(with);
  // Differences to the other strategies are taken without shadows.
  Result<Run> flat = options.shadows ? runs.run("inline", 0, false, flat_share, boxes) : Result<Run>(*with);
  if (!flat) return forward_error(flat);
  out.costs.shadow_slot_s = out.costs.shadow_vertex_s = 0.0;
  if (options.shadows) fit.shadows(*with, *flat);
  fit.inline_run(*with);
  // Recording is what it is without the shadows' pass, which has a cost of its own.
  if (options.shadows) out.costs.record_s = std::max(0.0, out.costs.record_s - out.costs.shadow_slot_s);
  if (Result<void> done = measure_octrees(runs, *flat, options.quick, fit); !done) return forward_error(done);
  fit.finish();
  return out;
}

}  // namespace scenegen::render
