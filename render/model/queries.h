// How many occlusion queries pay (D 3.2), and which way of drawing is cheaper (D 3.3); seconds.
#pragma once

#include <cstdint>
#include <span>

#include "render/model/frame_time.h"

namespace scenegen::render::model {

/// A node is heavy when drawing it costs `factor` (> 1) times what asking about it does (3.5). With frames
/// side by side the longer of processor and device counts on both sides.
struct NodeCosts {
  double secondary_s = 0, state_s = 0, vertices_s = 0, fragments_s = 0;
};
struct QueryCosts {
  double record_s = 0, execute_s = 0, receive_s = 0;
};
[[nodiscard]] bool heavy(const NodeCosts& node, const QueryCosts& query, double factor, bool side_by_side);

/// What x queries hide: c1 + c2 ln(1 + x).
struct LogFit {
  double c1 = 0, c2 = 0;
  [[nodiscard]] double at(double x) const;
};
struct Observation {
  double queries = 0, hidden = 0;
};
/// Least squares; c2 = 0 when all observations have one number of queries.
[[nodiscard]] LogFit fit_log(std::span<const Observation> observations);

/// Everything that T(x) of (3.6)-(3.12) depends on. Mended: a query costs more than its box. On the processor
/// it is `ask_s` (recording and receiving), on the device `query_s` (the longer of its box and the query
/// itself). D has ask_s = t_c and query_s = p t_e.
struct QueryProblem {
  LogFit objects, nodes, elements;                          ///< hidden by x queries: o, s, e
  double all_objects = 0, all_nodes = 0, all_elements = 0;  ///< o0, n0, e0
  double rerecorded_share = 0;                              ///< alpha_n
  double record_s = 0, secondary_s = 0, element_s = 0;      ///< t_c, t_s, t_e
  double ask_s = 0, query_s = 0;
  /// Exact queries: what is hidden is recorded and executed all the same, and costs `skip_s` a draw on the
  /// device; asking at all costs `second_part_s`.
  bool exact = false;
  double skip_s = 0, second_part_s = 0;
  /// What the frame costs beyond nodes and queries: side by side, it decides which waits for which.
  double other_cpu_s = 0, other_gpu_s = 0;
};

/// (3.11), (3.12). Without queries nothing is hidden; what is hidden is never more than there is.
[[nodiscard]] double query_cpu_s(const QueryProblem& problem, double x);
[[nodiscard]] double query_gpu_s(const QueryProblem& problem, double x);
/// (3.6), or the maximum of the two side by side.
[[nodiscard]] double query_time_s(const QueryProblem& problem, double x, bool side_by_side);

/// The stationary point x1* of (3.10), not clamped.
[[nodiscard]] double stationary_queries(const QueryProblem& problem);
/// x in [0, n0] with the least time. One after the other: of 0, n0 and x1* (3.10). Side by side: of 0, n0,
/// x2*, x3* and the crossings of (3.11) and (3.12), found by bisection on both sides of x4*.
[[nodiscard]] double best_queries(const QueryProblem& problem, bool side_by_side);

/// (3.14) of an octree that is not built yet: alpha_n |H| c_n t_buf + |H| t_sec(c_n).
[[nodiscard]] double octree_recording_s(double nodes, double per_node, double rerecorded_share,
                                        const TimeUnits& t);
/// (3.13): `inline` pays as long as its side is the smaller.
struct InlineOrOctree {
  double inline_s = 0, octree_s = 0;
  [[nodiscard]] bool inline_pays() const { return inline_s < octree_s; }
};
[[nodiscard]] InlineOrOctree inline_or_octree(const FrameCounts& n, const TimeUnits& t);

}  // namespace scenegen::render::model
