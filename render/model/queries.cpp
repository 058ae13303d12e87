#include "render/model/queries.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace scenegen::render::model {
namespace {

double hidden(const LogFit& fit, double x, double all) {
  return x > 0.0 ? std::clamp(fit.at(x), 0.0, all) : 0.0;
}

/// Numbers of queries to compare: this is asked in every frame, so no memory is.
class Candidates {
 public:
  void add(double x) { values_[count_++] = x; }
  [[nodiscard]] const double* begin() const { return values_.data(); }
  [[nodiscard]] const double* end() const { return values_.data() + count_; }

 private:
  std::array<double, 6> values_{};
  std::size_t count_ = 0;
};

/// A root of cpu - gpu in [a, b] if the difference changes its sign there.
void add_crossing(const QueryProblem& p, double a, double b, Candidates& out) {
  const auto difference = [&](double x) { return query_cpu_s(p, x) - query_gpu_s(p, x); };
  if (!(a < b)) return;
  const bool first = difference(a) > 0.0;
  if (first == (difference(b) > 0.0)) return;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (a + b);
    ((difference(middle) > 0.0) == first ? a : b) = middle;
  }
  out.add(0.5 * (a + b));
}

double over(double numerator, double denominator) {
  // Nothing to win: no queries. Asking costs nothing: all of them.
  if (numerator <= 0.0) return 0.0;
  return denominator > 0.0 ? numerator / denominator - 1.0 : 1e300;
}

double saved_on_cpu(const QueryProblem& p) {
  return p.exact ? 0.0 : p.rerecorded_share * p.objects.c2 * p.record_s + p.nodes.c2 * p.secondary_s;
}

double saved_on_gpu(const QueryProblem& p) {
  return p.elements.c2 * p.element_s - (p.exact ? p.objects.c2 * p.skip_s : 0.0);
}

}  // namespace

bool heavy(const NodeCosts& node, const QueryCosts& query, double factor, bool side_by_side) {
  const double gpu = std::max({node.state_s, node.vertices_s, node.fragments_s});
  const double asking = query.record_s + query.receive_s;
  if (side_by_side) return std::max(node.secondary_s, gpu) >= factor * std::max(asking, query.execute_s);
  return node.secondary_s + gpu >= factor * (asking + query.execute_s);
}

double LogFit::at(double x) const {
  return c1 + c2 * std::log1p(x);
}

LogFit fit_log(std::span<const Observation> observations) {
  const auto n = static_cast<double>(observations.size());
  if (observations.empty()) return {};
  double mean_l = 0.0;
  double mean_h = 0.0;
  for (const Observation& o : observations) {
    mean_l += std::log1p(o.queries) / n;
    mean_h += o.hidden / n;
  }
  double ll = 0.0;
  double lh = 0.0;
  for (const Observation& o : observations) {
    const double l = std::log1p(o.queries) - mean_l;
    ll += l * l;
    lh += l * (o.hidden - mean_h);
  }
  const double c2 = ll > 0.0 ? lh / ll : 0.0;
  return {mean_h - c2 * mean_l, c2};
}

double query_cpu_s(const QueryProblem& p, double x) {
  if (p.exact)
    return p.other_cpu_s + p.rerecorded_share * p.all_objects * p.record_s +
           (p.all_nodes + 1.0) * p.secondary_s + x * p.ask_s;
  return p.other_cpu_s +
         p.rerecorded_share * (p.all_objects - hidden(p.objects, x, p.all_objects)) * p.record_s +
         (p.all_nodes + 1.0 - hidden(p.nodes, x, p.all_nodes)) * p.secondary_s + x * p.ask_s;
}

double query_gpu_s(const QueryProblem& p, double x) {
  double sum =
      p.other_gpu_s + (p.all_elements - hidden(p.elements, x, p.all_elements)) * p.element_s + x * p.query_s;
  if (p.exact && x > 0.0) sum += hidden(p.objects, x, p.all_objects) * p.skip_s + p.second_part_s;
  return sum;
}

double query_time_s(const QueryProblem& p, double x, bool side_by_side) {
  const double cpu = query_cpu_s(p, x);
  const double gpu = query_gpu_s(p, x);
  return side_by_side ? std::max(cpu, gpu) : cpu + gpu;
}

double stationary_queries(const QueryProblem& p) {
  return over(saved_on_cpu(p) + saved_on_gpu(p), p.ask_s + p.query_s);
}

double best_queries(const QueryProblem& p, bool side_by_side) {
  Candidates candidates;
  const auto add = [&](double x) { candidates.add(std::clamp(x, 0.0, p.all_nodes)); };
  add(0.0);
  add(p.all_nodes);
  if (side_by_side) {
    add(over(saved_on_cpu(p), p.ask_s));
    add(over(saved_on_gpu(p), p.query_s));
    // Where cpu - gpu turns; outside the range it is monotone in it.
    const double slope = p.query_s - p.ask_s;
    const double turn = slope != 0.0 ? (saved_on_gpu(p) - saved_on_cpu(p)) / slope - 1.0 : -1.0;
    const double middle = std::clamp(turn, 0.0, p.all_nodes);
    add_crossing(p, 0.0, middle, candidates);
    add_crossing(p, middle, p.all_nodes, candidates);
  } else {
    add(stationary_queries(p));
  }
  return *std::min_element(candidates.begin(), candidates.end(), [&](double a, double b) {
    return query_time_s(p, a, side_by_side) < query_time_s(p, b, side_by_side);
  });
}

double octree_recording_s(double nodes, double per_node, double rerecorded_share, const TimeUnits& t) {
  return rerecorded_share * nodes * record_kept_s(per_node, t) + nodes * t.secondary;
}

InlineOrOctree inline_or_octree(const FrameCounts& n, const TimeUnits& t) {
  return {record_s(n.drawn_objects, t) + cull_scene_s(n, t), update_octree_s(n, t) +
                                                                 record_kept_s(n.rerecorded_draws, t) +
                                                                 secondaries_s(n, t) + cull_octree_s(n, t)};
}

}  // namespace scenegen::render::model
