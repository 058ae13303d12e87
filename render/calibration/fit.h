// Unit costs from what test scenes took: how times grow with what is drawn.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "render/calibration/calibration.h"
#include "render/calibration/measure.h"
#include "render/calibration/test_scene.h"

namespace scenegen::render::calibration {

/// What one renderer measured, by trial.
struct Run {
  const TestScene* test = nullptr;
  std::vector<Measured> results;

  [[nodiscard]] const Measured& empty() const { return results.front(); }
  /// Steps of a trial that were measured, in order.
  [[nodiscard]] std::vector<std::size_t> of(Trial trial) const;
  [[nodiscard]] const Step& step(std::size_t i) const { return test->steps[i]; }
  /// Device time beyond an empty frame: by its own clock where it has one.
  [[nodiscard]] double device_s(std::size_t i) const {
    return device_of(results[i].steady) - device_of(empty().steady);
  }
  [[nodiscard]] double record_s(std::size_t i) const {
    return results[i].steady.record_s - empty().steady.record_s;
  }
  [[nodiscard]] double plan_s(std::size_t i) const {
    return results[i].steady.plan_s - empty().steady.plan_s;
  }
  /// As the model is told of it; only of runs with predictions.
  [[nodiscard]] const model::Load& load(std::size_t i) const { return results[i].report.facts.in_frustum; }
  [[nodiscard]] static double device_of(const Stages& stages) {
    return stages.gpu_s >= 0.0 ? stages.gpu_s : stages.device_s;
  }
};

constexpr auto kPlain = static_cast<std::size_t>(model::Shading::plain);
constexpr auto kTextured = static_cast<std::size_t>(model::Shading::textured);

/// Cost of one more unit, by how a time grows with its number, from none on.
template <class X, class Y>
double slope(const Run& run, Trial trial, const X& x, const Y& y) {
  std::vector<double> xs{0.0};
  std::vector<double> ys{0.0};
  for (const std::size_t i : run.of(trial)) xs.push_back(x(i)), ys.push_back(y(i));
  return fit_line(xs, ys).slope;
}

/// More of it never costs less: what noise says otherwise is lifted.
void rising(model::Curve& curve);
/// How far two times are apart, the same above and below.
[[nodiscard]] double squared_log(double a, double b);

/// A run of `octree`, with objects a node.
using Octrees = std::pair<std::uint32_t, Run>;

/// Takes costs from runs; remembers which came out negative.
class Fit {
 public:
  explicit Fit(Calibration& out, double pixels) : out_(out), c_(out.costs), pixels_(pixels) {}

  void inline_run(const Run& run);
  void shadows(const Run& with, const Run& without);
  /// Runs of `octree` by objects a node, ascending.
  void kept(const Run& flat, const std::vector<Octrees>& runs);
  /// `fine`: of small nodes; `spread`: where few changed, in many nodes.
  void octree_updates(const Octrees& fine, const Octrees& spread);
  void command_memory(const std::vector<Octrees>& runs);
  void listed(const Run& run);
  void queries(const Run& flat, const Run& each, const Run& walls);
  void second_part(const Run& kept, const Run& asking);
  void indirect(const Run& flat, const Run& fine, const Run& coarse);
  /// Runs of `hi-z`: of the scene that `flat` drew, and of one of a few objects.
  void hi_z(const Run& flat, const Run& all, const Run& few);
  void finish();

 private:
  double positive(const char* name, double value);
  void set(const char* name, double& unit, double value);
  void set(const char* name, model::Curve& curve, model::Curve value);
  void empty_frame(const Run& run);
  void draws(const Run& run);
  void fragments(const Run& run);
  void triangles(const Run& run);
  void piles(const Run& run);
  void textured_piles(const Run& run);
  void instances(const Run& flat, const Run& all);
  /// Device time of a pile, with the sky that it covers.
  [[nodiscard]] double pile_s(const Run& run, std::size_t i) const;
  void overlaps(const Run& run);
  void meshes(const Run& run);
  void walking(const std::vector<Octrees>& runs);
  void executing(const Run& flat, const std::vector<Octrees>& runs);
  [[nodiscard]] double geometry_s(const Run& run, std::size_t i) const;
  model::Curve layers(const Run& run, Trial trial) const;

  Calibration& out_;
  model::UnitCosts& c_;
  double pixels_;
  double box_s_ = 0;  // drawing a box of less than a pixel
  std::vector<std::string> measured_;
};

}  // namespace scenegen::render::calibration
