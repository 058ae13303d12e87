// Formulas of memory, frame time and queries against values computed by hand.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "render/model/frame_time.h"
#include "render/model/memory.h"
#include "render/model/queries.h"
#include "render/model/unit_costs.h"

using namespace scenegen;
using namespace scenegen::render::model;

TEST_CASE("a cost curve is linear in log x and flat outside", "[model]") {
  const Curve curve{{1, 100}, {2, 4}};
  CHECK(curve.at(0.5) == 2);
  CHECK(curve.at(1) == 2);
  CHECK(curve.at(10) == Approx(3));
  CHECK(curve.at(100) == 4);
  CHECK(curve.at(1e9) == 4);
  CHECK(Curve{}.at(3) == 0);
}

TEST_CASE("(2.2) to (2.9) memory") {
  CHECK(geometry_bytes({100, 300, 100, 50}, {12, 4, 8, 6}) == 1200 + 1200 + 800 + 300);
  CHECK(texture_bytes(std::array{TextureSize{256, 128, 4}, TextureSize{10, 10, 1}}) == 131'072 + 100);
  const std::array objects{Share{10, 64}, Share{5, 100}};
  CHECK(uniform_bytes(objects) == 1140);
  CHECK(command_bytes(objects) == 1140);
  CHECK(grouped_command_bytes(std::array<std::uint64_t, 3>{100, 6900, 20'000}, 6900) == 6900 + 6900 + 20'000);
  CHECK(pipeline_bytes(std::array{Share{3, 1000}}) == 3000);
  CHECK(instance_bytes({7, 90}, {2, 224}) == 630 + 448);
  CHECK(hierarchy_bytes({9, 150}) == 1350);
  CHECK(texture_bytes({}) == 0);
}

TEST_CASE("a cost line goes on behind its last point", "[model]") {
  const Curve line{{10, 20, 120}, {5, 7, 27}};
  CHECK(line.line_at(0) == 5);
  CHECK(line.line_at(10) == 5);
  CHECK(line.line_at(15) == Approx(6));
  CHECK(line.line_at(70) == Approx(17));
  CHECK(line.line_at(620) == Approx(127));
  CHECK(Curve{{10, 20}, {5, 4}}.line_at(1000) == 0);  // falling: never below nothing
  CHECK(Curve{{10}, {5}}.line_at(99) == 5);
  CHECK(Curve{}.line_at(3) == 0);
}

TEST_CASE("(2.13) to (2.22) stages on the processor and the device") {
  const FrameCounts n{.objects = 1000,
                      .changed_share = 0.1,
                      .moved_share = 0.02,
                      .nodes = 50,
                      .boxes = 40,
                      .height = 3,
                      .refreshed_chunks = 5,
                      .refreshed_slots = 90,
                      .drawn_objects = 400,
                      .drawn_nodes = 30,
                      .rerecorded_draws = 60,
                      .queried_nodes = 20};
  const TimeUnits t{.update = 1,
                    .intersect = 2,
                    .refresh_chunk = 1.5,
                    .refresh_slot = 0.25,
                    .traverse = 3,
                    .cull_object = 0.5,
                    .cull_node = 4,
                    .record = 5,
                    .record_kept = 6,
                    .ask = 8,
                    .secondary = 7,
                    .state = 11,
                    .query = 13,
                    .receive = 17};
  CHECK(update_scene_s(n, t) == Approx(100));
  CHECK(update_octree_s(n, t) == Approx(0.02 * 1000 * 3 * 2 + 5 * 1.5 + 90 * 0.25));
  CHECK(traverse_s(n, t) == Approx(150));
  CHECK(cull_octree_s(n, t) == Approx(160));
  CHECK(cull_scene_s(n, t) == Approx(500));
  CHECK(record_s(400, t) == Approx(2000));
  CHECK(record_kept_s(60, t) == Approx(360));
  CHECK(ask_s(n, t) == Approx(160));
  CHECK(secondaries_s(n, t) == Approx(210));
  CHECK(state_s(3, t) == Approx(33));
  CHECK(execute_queries_s(n, t) == Approx(260));
  CHECK(receive_queries_s(n, t) == Approx(340));
}

TEST_CASE("(2.11), (2.12) time on the device, and of the frame") {
  CHECK(work_s(std::array{Work{10, 2}, Work{3, 5}}) == Approx(35));
  CHECK(gpu_s({1, 5, 3}, {0.5, 1, 2}, 1.5) == Approx(7));
  CHECK(gpu_s({1, 5, 3}, {0.5, 1, 1}, 1.5) == Approx(6.5));
  CHECK(gpu_s({1, 5, 3}, {}, 0) == Approx(5));
  CHECK(gpu_s({1, 5, 3}, {}, 0, 0.5) == Approx(6.5));  // half of the fragments waits for the vertices
  CHECK(gpu_s({6, 5, 3}, {0, 1, 2}, 2.5, 0.0) == Approx(9 + 3));
  TimeUnits t;
  t.empty_frame = 0.25;
  CHECK(frame_s(3, 4, 1, t) == Approx(7.25));
  CHECK(frame_s(3, 4, 2, t) == Approx(4.25));
  CHECK(frame_s(5, 4, 3, t) == Approx(5.25));
  t.overlap = 0.75;
  CHECK(frame_s(5, 4, 3, t) == Approx(6.25));
  CHECK(frame_s(5, 4, 1, t) == Approx(9.25));
}

TEST_CASE("(2.23) pixels that a box covers") {
  Screen screen{1000, 1000, 1.5707963267948966, 0.1, {0, 0, 0}, {0, 0, -1}};
  // At 10 m a picture of 90 degrees is 20 m high: a metre is 50 pixels.
  const Box cube{{-0.5F, -0.5F, -11}, {0.5F, 0.5F, -10}};
  CHECK(box_fragments(cube, 1.0, screen) == Approx(2500));
  CHECK(box_fragments(cube, 0.25, screen) == Approx(625));
  screen.width = 2000;  // wider, the same height: a metre stays 50 pixels
  CHECK(box_fragments(cube, 1.0, screen) == Approx(2500));
  CHECK(box_fragments({{-50, -50, -60}, {50, 50, 5}}, 1.0, screen) ==
        Approx(2e6));  // round the eye: all of it
  CHECK(box_fragments(Box{}, 1.0, screen) == 0);
  CHECK(occupied_share(3.0, {{0, 0, 0}, {1, 1, 1}}) == Approx(0.5));
  CHECK(occupied_share(30.0, {{0, 0, 0}, {1, 1, 1}}) == 1.0);
}

TEST_CASE("(3.5) heavy nodes") {
  CHECK(heavy({1, 2, 5, 3}, {1, 1, 1}, 2.0, false));
  CHECK_FALSE(heavy({1, 2, 4.9, 3}, {1, 1, 1}, 2.0, false));
  CHECK(heavy({1, 2, 4, 3}, {1, 0.5, 1}, 2.0, true));  // 4 >= 2 max(2, 0.5)
  CHECK_FALSE(heavy({1, 2, 3.9, 3}, {1, 0.5, 1}, 2.0, true));
}

TEST_CASE("a logarithm is found again, and fits what the dissertation measured") {
  std::vector<Observation> made;
  for (const double x : {1.0, 5.0, 20.0, 100.0}) made.push_back({x, 3.0 + 7.0 * std::log1p(x)});
  CHECK(fit_log(made).c1 == Approx(3));
  CHECK(fit_log(made).c2 == Approx(7));
  CHECK(fit_log({}).c2 == 0);
  CHECK(fit_log(std::array{Observation{4, 9}, Observation{4, 11}}).at(4) == Approx(10));
  // Queries and hidden objects of D 5.3.
  const std::array<Observation, 11> measured{{{10, 497},
                                              {20, 497},
                                              {30, 9731},
                                              {100, 45276},
                                              {200, 54644},
                                              {300, 77209},
                                              {1000, 121419},
                                              {2000, 127399},
                                              {3000, 142498},
                                              {10000, 148955},
                                              {50000, 163287}}};
  const LogFit fit = fit_log(measured);
  double mean = 0, residual = 0, total = 0;
  for (const Observation& o : measured) mean += o.hidden / 11;
  for (const Observation& o : measured) {
    residual += (fit.at(o.queries) - o.hidden) * (fit.at(o.queries) - o.hidden);
    total += (o.hidden - mean) * (o.hidden - mean);
  }
  CHECK(fit.c2 == Approx(22'738).epsilon(1e-4));
  CHECK(1.0 - residual / total == Approx(0.9501).epsilon(1e-3));  // R^2: that is why a logarithm
}

namespace {

/// A problem with round numbers; e2 t_e = 4, o2 t_c alpha = 1, s2 t_s = 3.
QueryProblem problem() {
  QueryProblem p;
  p.objects = {0, 50};
  p.nodes = {0, 10};
  p.elements = {0, 400};
  p.all_objects = 1000;
  p.all_nodes = 100;
  p.all_elements = 8000;
  p.rerecorded_share = 0.1;
  p.record_s = 0.2;
  p.secondary_s = 0.3;
  p.element_s = 0.01;
  p.ask_s = 0.3;
  p.query_s = 0.1;
  return p;
}

/// Least time over a fine grid.
double searched(const QueryProblem& p, bool side_by_side) {
  double best = query_time_s(p, 0, side_by_side);
  for (double x = 0.005; x <= p.all_nodes; x += 0.005)
    best = std::min(best, query_time_s(p, x, side_by_side));
  return best;
}

}  // namespace

TEST_CASE("(3.10) the best number of queries") {
  QueryProblem p = problem();
  CHECK(stationary_queries(p) == Approx((1 + 3 + 4) / (0.3 + 0.1) - 1));
  CHECK(query_cpu_s(p, 0) == Approx(0.1 * 1000 * 0.2 + 101 * 0.3));
  CHECK(query_gpu_s(p, 0) == Approx(80));
  const double l = std::log1p(19.0);
  CHECK(query_cpu_s(p, 19) == Approx(0.1 * (1000 - 50 * l) * 0.2 + (101 - 10 * l) * 0.3 + 19 * 0.3));
  CHECK(query_gpu_s(p, 19) == Approx((8000 - 400 * l) * 0.01 + 1.9));
  CHECK(best_queries(p, false) == Approx(19));
  p.ask_s = 100;
  CHECK(best_queries(p, false) == 0);
  p.ask_s = p.query_s = 0;
  CHECK(best_queries(p, false) == Approx(100));
}

TEST_CASE("the best number of queries is that of a search, in every regime") {
  for (const bool exact : {false, true}) {
    for (const double ask : {0.0, 0.05, 0.3, 2.0}) {
      for (const double query : {0.0, 0.02, 0.1, 0.3, 1.5}) {
        for (const double element : {0.001, 0.006, 0.01, 0.05}) {
          QueryProblem p = problem();
          p.exact = exact;
          p.ask_s = ask;
          p.query_s = query;
          p.element_s = element;
          p.skip_s = 0.01;
          p.second_part_s = 0.5;
          for (const bool side_by_side : {false, true}) {
            INFO(exact << " " << ask << " " << query << " " << element << " " << side_by_side);
            const double x = best_queries(p, side_by_side);
            CHECK((x >= 0 && x <= p.all_nodes));
            const double found = query_time_s(p, x, side_by_side);
            CHECK(found <= searched(p, side_by_side) + 1e-2);
          }
        }
      }
    }
  }
}

TEST_CASE("exact queries save on the device only") {
  QueryProblem p = problem();
  p.exact = true;
  p.skip_s = 0.02;  // o2 t_skip = 1
  CHECK(stationary_queries(p) == Approx((4 - 1) / (0.3 + 0.1) - 1));
  CHECK(query_cpu_s(p, 10) - query_cpu_s(p, 0) == Approx(3));
  p.skip_s = 1;  // skipping costs more than drawing
  CHECK(stationary_queries(p) == 0);
  CHECK(best_queries(p, false) == 0);
}

TEST_CASE("(3.13), (3.14) inline or octree") {
  TimeUnits t;
  t.record = t.record_kept = 2;
  t.secondary = 10;
  t.cull_object = 0.1;
  t.cull_node = 1;
  t.intersect = 0.5;
  FrameCounts n;
  n.objects = 1000;
  n.drawn_objects = 300;
  n.nodes = n.boxes = 20;
  n.drawn_nodes = 8;
  n.rerecorded_draws = 100;
  n.moved_share = 0.01;
  n.height = 2;
  const InlineOrOctree both = inline_or_octree(n, t);
  CHECK(both.inline_s == Approx(600 + 100));
  CHECK(both.octree_s == Approx(10 + 200 + 80 + 20));
  CHECK_FALSE(both.inline_pays());
  n.rerecorded_draws = 300;
  CHECK(inline_or_octree(n, t).octree_s == Approx(710));
  CHECK(inline_or_octree(n, t).inline_pays());
  CHECK(octree_recording_s(50, 20, 0.1, t) == Approx(0.1 * 50 * 20 * 2 + 50 * 10));
}
