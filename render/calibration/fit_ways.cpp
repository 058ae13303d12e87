// Unit costs of octrees, queries and culling on the device, by what they take beyond drawing one by one.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/calibration/fit.h"
#include "render/gpu_stage.h"
#include "render/model/octree_size.h"
#include "render/model/prediction.h"

namespace scenegen::render::calibration {

using model::Curve;

namespace {

double queries_of(const Run& run, std::size_t i) {
  return static_cast<double>(run.results[i].report.queries);
}

}  // namespace

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

}  // namespace scenegen::render::calibration
