#include "render/calibration/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/calibration/unit_names.h"
#include "render/gpu_stage.h"
#include "render/model/octree_size.h"
#include "render/model/prediction.h"

namespace scenegen::render::calibration {

using model::Curve;
using model::Shading;

namespace {

constexpr auto kPlain = static_cast<std::size_t>(Shading::plain);
constexpr auto kTextured = static_cast<std::size_t>(Shading::textured);

/// Cost of one more unit, by how a time grows with its number, from none on.
template <class X, class Y>
double slope(const Run& run, Trial trial, const X& x, const Y& y) {
  std::vector<double> xs{0.0};
  std::vector<double> ys{0.0};
  for (const std::size_t i : run.of(trial)) xs.push_back(x(i)), ys.push_back(y(i));
  return fit_line(xs, ys).slope;
}

/// More of it never costs less: what noise says otherwise is lifted.
void rising(Curve& curve) {
  for (std::size_t i = 1; i < curve.y.size(); ++i) curve.y[i] = std::max(curve.y[i], curve.y[i - 1]);
}

double queries_of(const Run& run, std::size_t i) {
  return static_cast<double>(run.results[i].report.queries);
}

double squared_log(double a, double b) {
  return std::pow(std::log(std::max(a, 1e-9) / std::max(b, 1e-9)), 2.0);
}

/// beside_s(x, fragments_s, overlap) == together_s.
double part_of(double together_s, double fragments_s, double overlap) {
  const double longer_s = together_s - (1.0 - overlap) * fragments_s;
  if (longer_s >= fragments_s || overlap >= 1.0) return longer_s;
  return (together_s - fragments_s) / (1.0 - overlap);
}

}  // namespace

std::vector<std::size_t> Run::of(Trial trial) const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (test->steps[i].trial == trial && results[i].samples > 0) out.push_back(i);
  }
  return out;
}

double Fit::positive(const char* name, double value) {
  if (value >= 0.0 && std::isfinite(value)) return value;
  if (std::find(out_.clamped.begin(), out_.clamped.end(), name) == out_.clamped.end())
    out_.clamped.emplace_back(name);
  return 0.0;
}
void Fit::set(const char* name, double& unit, double value) {
  unit = positive(name, value);
  measured_.emplace_back(name);
}
void Fit::set(const char* name, Curve& curve, Curve value) {
  if (value.x.empty()) return;  // all its steps were left out, as they took too long: it stays rough
  for (double& y : value.y) y = positive(name, y);
  curve = std::move(value);
  measured_.emplace_back(name);
}

void Fit::empty_frame(const Run& run) {
  const Measured& empty = run.empty();
  set("emptyCpuS", c_.empty_cpu_s, empty.steady.cpu_s());
  set("readbackCpuS", c_.readback_cpu_s, empty.steady.readback_s);
  const double device_s = Run::device_of(empty.steady);
  set("emptyDeviceS", c_.empty_device_s, device_s);
  const double copy_ms = empty.report.gpu_stages_ms[static_cast<std::size_t>(GpuStage::readback)];
  if (copy_ms >= 0.0) set("readbackDeviceS", c_.readback_device_s, std::min(copy_ms * 1e-3, device_s));
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

  const auto boxes = run.of(Trial::boxes);
  if (boxes.empty()) return;
  const model::Load& box = run.load(boxes.back());
  const double vertices = box.vertices / box.draws;
  box_s_ = slope(run, Trial::boxes, count, [&](std::size_t i) { return run.device_s(i); });
  const auto specks = run.of(Trial::speck_boxes);
  const double speck_s = specks.empty() ? box_s_ : run.device_s(specks.front()) / count(specks.front());
  Curve bulk;
  for (const std::size_t i : specks) {
    bulk.x.push_back(run.load(i).triangles);
    // More never take longer each; what seems so is noise.
    const double most = bulk.y.empty() ? 1.0 : bulk.y.back();
    bulk.y.push_back(std::clamp(run.device_s(i) / count(i) / std::max(1e-12, speck_s), 0.25, most));
  }
  if (bulk.x.size() > 1) set("bulk", c_.bulk, bulk);
  set("drawS", c_.draw_s[kPlain], Curve{{vertices}, {speck_s - vertices * c_.shadow_vertex_s}});
}

/// Time of vertices and triangles: without what their fragments and outlines cost, as far as that is not done
/// beside, and with the sky that they cover.
double Fit::geometry_s(const Run& run, std::size_t i) const {
  const model::Load& load = run.load(i);
  const double fragments_s =
      run.step(i).share > 0.0 ? model::device_stages(load, pixels_, c_).fragments_s : 0.0;
  const double together_s = run.device_s(i) + load.screen_share * pixels_ * c_.background_s;
  const double vertices_s = part_of(together_s, fragments_s, c_.stage_overlap);
  return vertices_s / model::bulk_factor(load.triangles, c_) - load.vertices * c_.shadow_vertex_s;
}

/// Spheres whose triangles share vertices have far fewer of these than ones whose triangles share none. A
/// triangle between all samples is dropped early (lavapipe: 140 ns instead of 200; of test sets 18 to 22 they
/// are most).
void Fit::triangles(const Run& run) {
  measured_.emplace_back("triangleOverlap");
  for (const std::size_t unshared : run.of(Trial::unshared_meshes)) {
    for (const std::size_t shared : run.of(Trial::meshes)) {
      if (run.step(shared).vertices != run.step(unshared).vertices) continue;
      const model::Load& more = run.load(unshared);
      const model::Load& less = run.load(shared);
      double vertices_s = 0.0;
      if (c_.triangle_overlap < 0.5) {
        const double vertex_s =
            (geometry_s(run, unshared) - geometry_s(run, shared)) / (more.vertices - less.vertices);
        vertices_s = std::max(0.0, vertex_s) * less.vertices;
      }
      set("triangleS", c_.triangle_s, (geometry_s(run, shared) - vertices_s) / less.triangles);
      for (const std::size_t speck : run.of(Trial::speck_meshes)) {
        const model::Load& many = run.load(speck);
        const double speck_s =
            (geometry_s(run, speck) - vertices_s * many.draws / less.draws) / many.triangles;
        set("speckTriangleS", c_.speck_triangle_s, std::min(speck_s, c_.triangle_s));
      }
    }
  }
}

void Fit::meshes(const Run& run) {
  const auto each_s = [&](std::size_t i) {
    const model::Load& load = run.load(i);
    return part_of(geometry_s(run, i), model::triangles_s(load, c_), c_.triangle_overlap) / load.draws;
  };
  const auto vertices = [&](std::size_t i) { return run.load(i).vertices / run.load(i).draws; };
  Curve plain = c_.draw_s[kPlain];
  const auto boxes = run.of(Trial::boxes);
  if (plain.x.empty() || boxes.empty()) return;
  const model::Load& box = run.load(boxes.back());
  std::vector<std::pair<double, double>> points{
      {plain.x.front(),
       part_of(plain.y.front(), box.triangles / box.draws * c_.speck_triangle_s, c_.triangle_overlap)}};
  for (const std::size_t i : run.of(Trial::unshared_meshes)) points.emplace_back(vertices(i), each_s(i));
  std::sort(points.begin(), points.end());
  plain = {};
  for (const auto& [x, s] : points) plain.x.push_back(x), plain.y.push_back(positive("drawS", s));
  rising(plain);
  // The textured ones are measured at two sizes: between them the ratio is interpolated.
  Curve ratio;
  for (const Trial trial : {Trial::textured_boxes, Trial::textured_meshes}) {
    for (const std::size_t i : run.of(trial)) {
      // Textures never save anything; above 10 it is noise.
      const double plain_s = plain.line_at(vertices(i));
      ratio.x.push_back(vertices(i));
      ratio.y.push_back(plain_s > 0.0 ? std::clamp(each_s(i) / plain_s, 1.0, 10.0) : 1.0);
    }
  }
  Curve textured = plain;
  for (std::size_t k = 0; k < plain.x.size() && !ratio.x.empty(); ++k) textured.y[k] *= ratio.at(plain.x[k]);
  set("drawS", c_.draw_s[kPlain], plain);
  set("drawS", c_.draw_s[kTextured], textured);
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
  set("fragmentS", c_.fragment_s[kPlain], plain);
  set("fragmentS", c_.fragment_s[kTextured], layers(run, Trial::textured_layers));
  // A layer over the whole sky costs its fragments less the sky's.
  for (const std::size_t i : run.of(Trial::layers)) {
    if (run.step(i).layers == 1 && run.step(i).share == 1.0 && !plain.y.empty())
      set("backgroundS", c_.background_s, plain.y.back() - run.device_s(i) / pixels_);
  }
}

/// Boxes that lie anywhere, before and behind each other, have vertices, outlines, and fragments of which
/// many are hidden: what outlines and hidden fragments cost, and how far all that is done side by side, are
/// the three numbers that explain their times, and those of boxes of less than a pixel, best.
void Fit::piles(const Run& run) {
  std::vector<std::size_t> steps = run.of(Trial::piles);
  const std::size_t piles = steps.size();
  const auto boxes = run.of(Trial::boxes);
  steps.insert(steps.end(), boxes.size() > 2 ? boxes.end() - 2 : boxes.begin(), boxes.end());
  const double shade_s = c_.fragment_s[kPlain].at(1.0);
  if (piles < 3 || shade_s <= 0.0) return;
  model::UnitCosts c = c_;
  // Most of their time is fragments and outlines, of which large frames save nothing: with it textured
  // outlines of lavapipe took 0.25 us instead of 0.14, and test sets 45 and 48 were predicted 40 % too long.
  c.bulk = {};
  double best = std::numeric_limits<double>::max();
  constexpr int kSteps = 24;
  for (int e = 0; e <= kSteps; ++e) {
    for (int h = 0; h <= kSteps; ++h) {
      c.edge_s = shade_s * 6.0 * std::pow(static_cast<double>(e) / kSteps, 2.0);
      c.hidden_fragment_s = shade_s * std::pow(static_cast<double>(h) / kSteps, 2.0);
      std::array<double, 11> errors{};
      for (const std::size_t i : steps) {
        const model::GpuStages s = model::device_stages(run.load(i), pixels_, c);
        const double vertices_s =
            std::max(s.state_s, s.vertices_s) + run.load(i).vertices * c.shadow_vertex_s;
        for (std::size_t o = 0; o < errors.size(); ++o)
          errors[o] += squared_log(model::beside_s(vertices_s, s.fragments_s, 0.1 * static_cast<double>(o)),
                                   pile_s(run, i));
      }
      for (std::size_t o = 0; o < errors.size(); ++o) {
        if (errors[o] >= best) continue;
        best = errors[o];
        c_.edge_s = c.edge_s;
        c_.hidden_fragment_s = c.hidden_fragment_s;
        c_.stage_overlap = 0.1 * static_cast<double>(o);
      }
    }
  }
  for (const char* name : {"edgeS", "hiddenFragmentS", "stageOverlap"}) measured_.emplace_back(name);
}

double Fit::pile_s(const Run& run, std::size_t i) const {
  return run.device_s(i) + run.load(i).screen_share * pixels_ * c_.background_s;
}

/// Large quads hide what textures cost where writing the picture takes longer (H200, 4 samples: 0.57 ns a
/// fragment, with and without); along outlines, where whole quads of pixels are shaded for a part, they show.
void Fit::textured_piles(const Run& run) {
  const auto steps = run.of(Trial::textured_piles);
  const double shade_s = c_.fragment_s[kTextured].at(1.0);
  c_.textured_edge_s = c_.edge_s;
  if (steps.empty() || shade_s <= 0.0) return;
  model::UnitCosts c = c_;
  c.bulk = {};
  double best = std::numeric_limits<double>::max();
  constexpr int kSteps = 48;
  for (int e = 0; e <= kSteps; ++e) {
    c.textured_edge_s = shade_s * 24.0 * std::pow(static_cast<double>(e) / kSteps, 2.0);
    double error = 0.0;
    for (const std::size_t i : steps) {
      const model::GpuStages s = model::device_stages(run.load(i), pixels_, c);
      const double vertices_s = std::max(s.state_s, s.vertices_s) + run.load(i).vertices * c.shadow_vertex_s;
      error += squared_log(model::beside_s(vertices_s, s.fragments_s, c.stage_overlap), pile_s(run, i));
    }
    if (error >= best) continue;
    best = error;
    c_.textured_edge_s = c.textured_edge_s;
  }
  measured_.emplace_back("texturedEdgeS");
}

void Fit::overlaps(const Run& run) {
  const auto boxes = run.of(Trial::boxes);
  if (boxes.empty() || run.results[boxes.back()].period_s <= 0.0) return;
  const Measured& m = run.results[boxes.back()];
  const double cpu_s = m.steady.cpu_s();
  const double gpu_s = Run::device_of(m.steady);
  set("frameOverlap", c_.frame_overlap,
      std::clamp((cpu_s + gpu_s - m.period_s) / std::min(cpu_s, gpu_s), 0.0, 1.0));
}

void Fit::inline_run(const Run& run) {
  empty_frame(run);
  fragments(run);
  const double rough_s = c_.triangle_s;
  c_.triangle_s = c_.speck_triangle_s = 0.0;  // in draws of boxes, until they are known
  draws(run);
  piles(run);
  triangles(run);
  if (c_.triangle_s <= 0.0) c_.triangle_s = c_.speck_triangle_s = rough_s;  // no spheres fit the picture
  meshes(run);
  piles(run);  // with triangles that cover something beside those of the smallest boxes
  textured_piles(run);
  overlaps(run);
}

void Fit::shadows(const Run& with, const Run& without) {
  const auto count = [&](std::size_t i) { return static_cast<double>(with.step(i).draws); };
  const auto grown = [&](auto stage) {
    return slope(with, Trial::boxes, count, [&](std::size_t i) { return (with.*stage)(i); }) -
           slope(without, Trial::boxes, count, [&](std::size_t i) { return (without.*stage)(i); });
  };
  set("shadowSlotS", c_.shadow_slot_s, grown(&Run::record_s));
  set("shadowVertexS", c_.shadow_vertex_s, grown(&Run::device_s) / 24.0);
}

/// What keeping commands costs the processor.
void Fit::kept(const Run& flat, const std::vector<Octrees>& runs) {
  std::vector<std::pair<double, double>> sending;
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
  }
  std::sort(sending.begin(), sending.end());
  Curve curve;
  for (const auto& [draws, each_s] : sending) curve.x.push_back(draws), curve.y.push_back(each_s);
  rising(curve);
  set("secondaryS", c_.secondary_s, curve);
  executing(flat, runs);
  walking(runs);
}

/// Executing what is kept: so much a command buffer, as far as the device does not prepare it while it works
/// on the draws before. And with one frame in flight the device begins before all is sent.
void Fit::executing(const Run& flat, const std::vector<Octrees>& runs) {
  struct Point {
    double chunks, draws_s, measured_s;
  };
  std::vector<Point> points;
  double most_s = 0.0;
  double sent_s = 0.0;
  double beside_s = 0.0;
  for (const auto& one : runs) {
    const Run& run = one.second;
    for (const std::size_t i : run.of(Trial::boxes)) {
      const Measured& m = run.results[i];
      const double chunks = static_cast<double>(m.report.secondaries);
      if (chunks < 10.0 || flat.results[i].samples == 0) continue;
      points.push_back({chunks, flat.device_s(i), run.device_s(i)});
      most_s = std::max(most_s, points.back().measured_s / chunks);
      sent_s += run.record_s(i);
      beside_s += Run::device_of(m.steady) + c_.latency_s - m.steady.device_s;
    }
    // The first frames of a program wait longer than any later.
    c_.latency_s = std::min(
        c_.latency_s, positive("latencyS", run.empty().steady.device_s - Run::device_of(run.empty().steady)));
  }
  if (sent_s > 0.0) set("sendOverlap", c_.send_overlap, std::clamp(beside_s / sent_s, 0.0, 1.0));
  double best = std::numeric_limits<double>::max();
  constexpr int kSteps = 100;
  for (int k = 0; k <= kSteps && points.size() > 1; ++k) {
    for (int o = 0; o <= 10; ++o) {
      const double each_s = most_s * k / kSteps;
      double error = 0.0;
      for (const Point& p : points)
        error += p.chunks * squared_log(model::beside_s(p.chunks * each_s, p.draws_s, 0.1 * o), p.measured_s);
      if (error >= best) continue;
      best = error;
      c_.secondary_device_s = each_s;
      c_.node_overlap = 0.1 * o;
    }
  }
  measured_.emplace_back("secondaryDeviceS");
  measured_.emplace_back("nodeOverlap");
}

void Fit::walking(const std::vector<Octrees>& runs) {
  // The fewest command buffers: their own cost shows least. And the smallest nodes, for walking.
  const Run& coarse = runs.back().second;
  const auto drawn = [&](std::size_t i) {
    return static_cast<double>(coarse.results[i].first_report.recorded_draws);
  };
  set("recordKeptS", c_.record_kept_s, slope(coarse, Trial::boxes, drawn, [&](std::size_t i) {
        return coarse.results[i].first.keep_s - coarse.results[i].steady.keep_s;
      }));
  const Run& fine = runs.front().second;
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

/// T_upd(H): putting boxes into an empty tree is mostly moving them down it, taking away one here and there
/// mostly making sums of what is left, putting these back mostly bringing chunks up to date. Each is a little
/// of the others too.
void Fit::octree_updates(const Octrees& fine, const Octrees& spread) {
  using Units = std::array<double, 3>;  // a level, a chunk, a slot
  const auto sum = [](const Octrees& run, std::size_t i, const Units& each) {
    const FrameReport& r = run.second.results[i].first_report;
    const double height = std::max(1.0, model::octree_height(run.second.step(i).draws, run.first));
    return static_cast<double>(r.changed) * height * each[0] +
           static_cast<double>(r.refreshed_chunks) * each[1] +
           static_cast<double>(r.refreshed_slots) * each[2];
  };
  // What one unit of a kind takes, when the others take so much.
  const auto rest = [&](const Octrees& run, Trial trial, const Units& one, const Units& others) {
    return slope(
        run.second, trial, [&](std::size_t i) { return sum(run, i, one); },
        [&](std::size_t i) { return run.second.results[i].first.update_octree_s - sum(run, i, others); });
  };
  Units units{};
  const auto cost = [&](std::size_t i) { return std::max(0.0, units[i]); };
  constexpr int kTurns = 16;  // each takes off what is left of the others' shares, which are small
  for (int turn = 0; turn < kTurns; ++turn) {
    units[0] = rest(fine, Trial::boxes, {1, 0, 0}, {0, cost(1), cost(2)});
    units[1] = rest(spread, Trial::refilled_boxes, {0, 1, 0}, {cost(0), 0, cost(2)});
    units[2] = rest(spread, Trial::thinned_boxes, {0, 0, 1}, {cost(0), cost(1), 0});
  }
  set("intersectS", c_.intersect_s, units[0]);
  if (spread.second.of(Trial::refilled_boxes).empty()) return;  // so slow a device
  set("refreshChunkS", c_.refresh_chunk_s, units[1]);
  set("refreshSlotS", c_.refresh_slot_s, units[2]);
}

/// M_sec and M_cmd: what the driver took for buffers with few and with many draws. With one size of them only
/// (quick), M_sec stays rough. Where only the growth of the process is known, so few tell nothing.
void Fit::command_memory(const std::vector<Octrees>& runs) {
  double bb = 0.0, bd = 0.0, dd = 0.0, bm = 0.0, dm = 0.0;  // least squares of m = b M_sec + d M_cmd
  std::size_t known = 0;
  for (const auto& one : runs) {
    const CommandMemoryReport& m = one.second.results.front().commands;
    if (m.draws == 0 || m.measured == 0 || m.measured != m.driver) continue;
    // Relative deviations count, not those of the largest run.
    const double b = static_cast<double>(m.buffers) / static_cast<double>(m.measured);
    const double d = static_cast<double>(m.draws) / static_cast<double>(m.measured);
    bb += b * b, bd += b * d, dd += d * d, bm += b, dm += d;
    ++known;
  }
  if (known == 0) return;
  const double determinant = bb * dd - bd * bd;
  if (known >= 2 && determinant > 1e-9 * bb * dd) {
    set("secondaryBytes", c_.secondary_bytes, (dd * bm - bd * dm) / determinant);
    set("commandBytes", c_.command_bytes, (bb * dm - bd * bm) / determinant);
  } else {
    set("commandBytes", c_.command_bytes, (dm - bd * c_.secondary_bytes) / dd);
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

void Fit::queries(const Run& flat, const Run& each, const Run& walls) {
  // A query for each of many boxes that are hardly seen: beyond drawing them.
  const auto asked = [&](std::size_t i) { return queries_of(each, i); };
  const double both_s = positive("askS", slope(each, Trial::boxes, asked, [&](std::size_t i) {
                                   return each.record_s(i) - flat.record_s(i);
                                 }));
  // Asking and reading happen in one frame; what is read alone shows in the empty frame that follows.
  const double read_s = slope(each, Trial::boxes, asked, [&](std::size_t i) {
    return each.results[i].leave_record_s - each.empty().steady.record_s;
  });
  set("receiveS", c_.receive_s, std::min(positive("receiveS", read_s), both_s));
  set("askS", c_.ask_s, both_s - c_.receive_s);
  // Behind a wall, which is asked about too and is seen.
  std::vector<double> count;
  std::vector<double> wall_s;
  for (const std::size_t i : each.of(Trial::hidden_boxes))
    count.push_back(asked(i)), wall_s.push_back(each.device_s(i));
  const Line hidden = fit_line(count, wall_s);
  for (const std::size_t i : walls.of(Trial::layers)) {
    if (walls.step(i).layers == 1 && walls.step(i).share == 1.0)
      set("askedFragmentS", c_.asked_fragment_s, (hidden.offset - walls.device_s(i)) / pixels_);
  }
  const double seen_s =
      slope(each, Trial::boxes, asked, [&](std::size_t i) { return each.device_s(i) - flat.device_s(i); });
  // One that is seen does all that a hidden one does, so where it seems to take less they cannot be told
  // apart.
  const double hidden_s = seen_s < hidden.slope ? 0.5 * (seen_s + hidden.slope) : hidden.slope;
  set("queryS", c_.query_s, hidden_s);
  set("seenQueryS", c_.seen_query_s, std::max(seen_s, hidden_s) - hidden_s);
}

/// Boxes behind a wall, asked about and skipped, against the same drawn from the same kept commands: the wall
/// and all that a frame costs besides are in both.
void Fit::second_part(const Run& kept, const Run& asking) {
  const double draw_s = box_s_;
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
    device_s.push_back(timed ? second_part_ms * 1e-3 -
                                   static_cast<double>(r.believed_hidden) * c_.secondary_device_s
                             : asking.device_s(i) - kept.device_s(i) + draws * draw_s - queries * c_.query_s -
                                   pixels_ * c_.asked_fragment_s);
    cpu_s.push_back(asking.record_s(i) - kept.record_s(i) - queries * (c_.ask_s + c_.receive_s));
  }
  if (skipped.size() < 2) return;
  const Line device = fit_line(skipped, device_s);
  set("skippedDrawS", c_.skipped_draw_s, device.slope);
  set("secondPartDeviceS", c_.second_part_device_s, device.offset);
  set("secondPartCpuS", c_.second_part_cpu_s, *std::min_element(cpu_s.begin(), cpu_s.end()));
}

/// An empty frame of few blocks has all that does not depend on their number; one of many adds them; boxes
/// behind a wall are tested and not drawn. Both parts of an empty frame have a command a block.
void Fit::hi_z(const Run& flat, const Run& all, const Run& few) {
  const auto blocks = [](const Run& run) { return static_cast<double>(run.empty().report.draws) / 2.0; };
  if (blocks(all) <= blocks(few)) return;  // the device cannot
  const double few_s = Run::device_of(few.empty().steady);
  set("hiZDeviceS", c_.hi_z_device_s, few_s - Run::device_of(flat.empty().steady));
  set("hiZBlockS", c_.hi_z_block_s,
      (Run::device_of(all.empty().steady) - few_s) / (blocks(all) - blocks(few)));
  std::vector<double> draws, device_s;
  for (const std::size_t i : all.of(Trial::hidden_boxes)) {
    draws.push_back(all.step(i).draws);
    device_s.push_back(all.device_s(i));
  }
  if (draws.size() >= 2) set("hiZSlotS", c_.hi_z_slot_s, fit_line(draws, device_s).slope);
  set("hiZCpuS", c_.hi_z_cpu_s, all.empty().steady.record_s - flat.empty().steady.record_s);
  instances(flat, all);
}

/// Boxes of a block are instances of one command: what that saves against a command each. A GPU may take as
/// long for an instance of few vertices as for a draw of them: 0 is usual there, and no sign of noise.
void Fit::instances(const Run& flat, const Run& all) {
  const auto count = [](const Run& run) {
    return [&run](std::size_t i) { return static_cast<double>(run.step(i).draws); };
  };
  const auto boxes = all.of(Trial::boxes);
  if (boxes.size() < 2) return;
  const double each_s = slope(all, Trial::boxes, count(all), [&](std::size_t i) { return all.device_s(i); });
  const double alone_s =
      slope(flat, Trial::boxes, count(flat), [&](std::size_t i) { return flat.device_s(i); });
  set("instanceSavesS", c_.instance_saves_s,
      std::clamp(alone_s - (each_s - c_.hi_z_slot_s), 0.0, c_.draw_s[kPlain].line_at(0.0)));
}

void Fit::indirect(const Run& flat, const Run& fine, const Run& coarse) {
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
          [&](std::size_t i) { return coarse.results[i].first.keep_s - coarse.results[i].steady.keep_s; }));
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
  set("nodeCommandDeviceS", c_.node_command_device_s, (dd * nt - nd * dt) / determinant);
  // Where a draw recorded one by one costs so much.
  const double recorded_s = slope(
      flat, Trial::boxes, [&](std::size_t i) { return static_cast<double>(flat.step(i).draws); },
      [&](std::size_t i) { return flat.device_s(i); });
  set("indirectDrawS", c_.indirect_draw_s, draw_s - recorded_s + c_.draw_s[kPlain].line_at(0.0));
}

void Fit::finish() {
  for (const UnitName& unit : unit_names()) {
    const std::string name(unit.name);
    if (std::find(measured_.begin(), measured_.end(), name) == measured_.end())
      out_.not_measured.push_back(name);
  }
}

}  // namespace scenegen::render::calibration
