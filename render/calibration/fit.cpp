#include "render/calibration/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/calibration/unit_names.h"
#include "render/gpu_stage.h"
#include "render/model/prediction.h"

namespace scenegen::render::calibration {

using model::Curve;

namespace {

/// beside_s(x, fragments_s, overlap) == together_s.
double part_of(double together_s, double fragments_s, double overlap) {
  const double longer_s = together_s - (1.0 - overlap) * fragments_s;
  if (longer_s >= fragments_s || overlap >= 1.0) return longer_s;
  return (together_s - fragments_s) / (1.0 - overlap);
}

}  // namespace

double squared_log(double a, double b) {
  return std::pow(std::log(std::max(a, 1e-9) / std::max(b, 1e-9)), 2.0);
}

void rising(Curve& curve) {
  for (std::size_t i = 1; i < curve.y.size(); ++i) curve.y[i] = std::max(curve.y[i], curve.y[i - 1]);
}

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
  // All are in the frustum, and listed; of halved boxes half. (H200s' machines: 2.5 to 3 ns to test one, 1.3
  // to 3 to list it. Taken as one, the processor was predicted to take up to 1.8 ms instead of 0.8 for a view
  // away from 300 000 objects.)
  const double listed_s = slope(run, Trial::boxes, count, [&](std::size_t i) { return run.plan_s(i); });
  c_.list_draw_s = 0.0;
  for (const std::size_t i : run.of(Trial::halved_boxes)) {
    const double share = run.load(i).draws / count(i);
    const double list_s = (listed_s - run.plan_s(i) / count(i)) / std::max(0.25, 1.0 - share);
    set("listDrawS", c_.list_draw_s, std::clamp(list_s, 0.0, std::max(0.0, listed_s)));
  }
  set("cullSlotS", c_.cull_slot_s, listed_s - c_.list_draw_s);
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
      c_.speck_triangle_s = c_.triangle_s;  // unless measured
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

void Fit::finish() {
  for (const UnitName& unit : unit_names()) {
    const std::string name(unit.name);
    if (std::find(measured_.begin(), measured_.end(), name) == measured_.end())
      out_.not_measured.push_back(name);
  }
}

}  // namespace scenegen::render::calibration
