#include "render/model/prediction.h"

#include <algorithm>
#include <cmath>

namespace scenegen::render::model {
namespace {

/// Which parts of the facts a way of drawing makes use of.
struct Taken {
  Way way;
  FrameCounts counts;
  Load drawn;             // solid objects that the device really draws
  double skipped = 0;     // draws under a predicate that is 0
  double executed = 0;    // kept command buffers or node commands, hidden ones included
  double listed = 0;      // slots of chunks that are brought in order
  double hidden = 0;      // chunks drawn in a second part of the pass
  double found = 0;       // queries that find nothing
  double asked_area = 0;  // fragments of the boxes asked about
};

double mixed(const std::array<Curve, kShadings>& curves, double textured,
             double (Curve::*value)(double) const, double x) {
  const auto of = [&](Shading s) { return (curves[static_cast<std::size_t>(s)].*value)(x); };
  return (1.0 - textured) * of(Shading::plain) + textured * of(Shading::textured);
}

double commands_of(const Load& load) {
  return load.commands > 0.0 ? std::min(load.commands, load.draws) : load.draws;
}

/// The part of a draw that does not depend on its vertices.
double command_s(const Load& load, const UnitCosts& c) {
  return mixed(c.draw_s, load.textured_share, &Curve::line_at, 0.0);
}

Load without(Load load, const Load& part) {
  const double each = load.draws > 0.0 ? load.commands / load.draws : 0.0;
  load.draws = std::max(0.0, load.draws - part.draws);
  load.commands = each * load.draws;
  load.vertices = std::max(0.0, load.vertices - part.vertices);
  load.triangles = std::max(0.0, load.triangles - part.triangles);
  load.fragments = std::max(0.0, load.fragments - part.fragments);
  return load;
}

double textured_fragments(const Load& load) {
  return load.textured_fragment_share < 0.0 ? load.textured_share : load.textured_fragment_share;
}

Load together(const Load& a, const Load& b) {
  Load sum = a;
  sum.draws += b.draws;
  if (a.commands > 0.0 || b.commands > 0.0) sum.commands = commands_of(a) + commands_of(b);
  sum.vertices += b.vertices;
  sum.triangles += b.triangles;
  sum.fragments += b.fragments;
  if (sum.draws > 0.0)
    sum.textured_share = (a.draws * a.textured_share + b.draws * b.textured_share) / sum.draws;
  if (sum.fragments > 0.0)
    sum.textured_fragment_share =
        (a.fragments * textured_fragments(a) + b.fragments * textured_fragments(b)) / sum.fragments;
  if (a.screen_share > 0.0 && b.screen_share > 0.0)
    sum.screen_share = 1.0 - (1.0 - a.screen_share) * (1.0 - b.screen_share);
  return sum;
}

/// `part` is everything that queries of this way hide.
void take_queries(Taken& t, double asked, double chunks_hidden, const Load& part, bool exact) {
  t.way.queries = true;
  t.counts.queried_nodes = asked;
  t.found = chunks_hidden;
  t.drawn = without(t.drawn, part);
  if (exact) {
    t.hidden = chunks_hidden;
    t.skipped = part.draws;
  } else {
    t.executed -= chunks_hidden;
  }
}

Taken take(Method method, const FrameFacts& f, const PredictionOptions& options) {
  Taken t;
  t.counts.objects = f.visible_slots;
  t.counts.nodes = f.nodes_visited;
  t.counts.boxes = f.boxes_tested;
  t.counts.height = std::max(1.0, f.height);
  t.counts.refreshed_chunks = f.chunks_refreshed;
  t.counts.refreshed_slots = f.slots_refreshed;
  if (f.visible_slots > 0.0) t.counts.changed_share = f.changed / f.visible_slots;
  // The octree holds what is visible, so whatever changes is put in, taken out or moved.
  t.counts.moved_share = t.counts.changed_share;
  switch (method) {
    case Method::brute:
      t.drawn = f.visible;
      break;
    case Method::inline_frustum:
      t.drawn = f.in_frustum;
      break;
    case Method::inline_queries:
      t.drawn = without(f.in_frustum, f.slots_hidden);
      t.way.queries = true;
      t.counts.queried_nodes = f.in_frustum.draws;
      t.asked_area = f.in_frustum.fragments;
      t.found = f.slots_hidden.draws;
      break;
    case Method::octree_record:
      t.way.octree = true;
      t.drawn = f.in_chunks;
      t.listed = f.in_chunks.draws;
      break;
    case Method::octree:
    case Method::queries_all:
    case Method::queries:
      t.way = {true, true, false};
      t.drawn = f.in_chunks;
      t.executed = f.chunks;
      if (options.indirect_nodes) {
        t.drawn.commands = f.commands_per_draw * t.drawn.draws;
        if (f.runs_per_chunk > 0.0) t.executed *= f.runs_per_chunk;
      }
      t.counts.rerecorded_draws = f.draws_rerecorded;
      if (method == Method::queries_all) {
        take_queries(t, f.chunks, f.all_chunks_hidden, f.all_hidden, options.exact);
        t.asked_area = f.all_asked_fragments;
      } else if (method == Method::queries) {
        take_queries(t, f.asked, f.chunks_hidden, f.hidden, options.exact);
        t.asked_area = f.asked_fragments;
      }
      break;
    case Method::hi_z:
      t.drawn = f.seen;
      t.drawn.commands = std::min(f.seen.draws, f.hi_z_blocks);
      break;
  }
  t.counts.drawn_nodes = t.executed;
  t.counts.drawn_objects = t.drawn.draws;
  return t;
}

TimeUnits units_of(const UnitCosts& c, const FrameFacts& f, const PredictionOptions& options) {
  TimeUnits t;
  t.update = c.update_object_s;
  t.intersect = c.intersect_s;
  t.refresh_chunk = c.refresh_chunk_s;
  t.refresh_slot = c.refresh_slot_s;
  t.traverse = c.visit_node_s;
  t.cull_object = c.cull_slot_s;
  t.cull_node = c.cull_node_s;
  t.list = c.list_slot_s;
  t.record = c.record_s;
  t.record_kept = options.indirect_nodes ? c.write_indirect_s : c.record_kept_s;
  const double per_chunk = f.chunks > 0.0 ? f.in_chunks.draws / f.chunks : 0.0;
  t.secondary = options.indirect_nodes ? c.node_command_s : c.secondary_s.line_at(per_chunk);
  t.ask = c.ask_s;
  t.query = c.query_s;
  t.receive = c.receive_s;
  t.empty_frame = options.frames_in_flight <= 1 ? c.latency_s : 0.0;
  t.overlap = c.frame_overlap;
  return t;
}

/// T_state of kept command buffers: the device prepares one while it works on the draws before. Those of the
/// second part have nothing to be beside.
double nodes_state_s(const Taken& t, const UnitCosts& c, bool indirect) {
  return indirect ? 0.0 : (t.executed - t.hidden) * c.secondary_device_s;
}
double nodes_device_s(const Taken& t, const UnitCosts& c, bool indirect) {
  if (!indirect) return t.hidden * c.secondary_device_s + t.skipped * c.skipped_draw_s;
  // Its draws are commands of another kind; hidden ones are none at all. What a kind costs more is measured
  // with plain objects; what textured ones take beyond their vertices is not saved (a town on an H200: 10 ns
  // each of 52 000, a tenth of the frame).
  const double plain_s = c.draw_s[static_cast<std::size_t>(Shading::plain)].line_at(0.0);
  return t.executed * c.node_command_device_s + commands_of(t.drawn) * (c.indirect_draw_s - plain_s);
}

}  // namespace

std::string_view name_of(Method method) {
  static constexpr std::array<std::string_view, kMethods> kNames{
      "brute", "inline", "inline-queries", "octree-record", "octree", "queries-all", "queries", "hi-z"};
  return kNames[static_cast<std::size_t>(method)];
}

Shaded shaded_fragments(const Load& load, double screen_pixels) {
  if (load.fragments <= 0.0 || screen_pixels <= 0.0) return {};
  Shaded out;
  out.covered_share = load.screen_share > 0.0 ? std::min(1.0, load.screen_share)
                                              : 1.0 - std::exp(-load.fragments / screen_pixels);
  const double covered = out.covered_share * screen_pixels;
  const double layers = std::max(1.0, load.fragments / covered);
  // 1 + 1/2 + ... + 1/k as a smooth function of k, 1 at k = 1 (Euler's constant; error below 2 %).
  constexpr double kEuler = 0.57721566;
  const double harmonic = std::max(1.0, std::log(layers + 0.5) + kEuler);
  out.shaded = std::min(load.fragments, covered * harmonic);
  out.hidden = load.fragments - out.shaded;
  return out;
}

double outlines(const Load& load) {
  if (load.draws <= 0.0 || load.fragments <= 0.0) return 0.0;
  const double each = load.fragments / load.draws;
  const double facing = std::max(1.0, 0.5 * load.triangles / load.draws);
  const double seen = facing * (1.0 - std::exp(-each / facing));
  return load.draws * std::sqrt(seen * each);
}

double triangles_s(const Load& load, const UnitCosts& c) {
  if (load.triangles <= 0.0) return 0.0;
  // Of those that face the viewer, this share covers a sample (of four a fragment), against as many where
  // each covers a quarter of a fragment.
  const double each = 2.0 * load.fragments / load.triangles;
  const double covering = std::min(1.0, std::expm1(-4.0 * each) / std::expm1(-1.0));
  return load.triangles * (c.speck_triangle_s + covering * (c.triangle_s - c.speck_triangle_s));
}

double bulk_factor(double triangles, const UnitCosts& c) {
  return c.bulk.x.empty() ? 1.0 : c.bulk.at(triangles);
}

GpuStages device_stages(const Load& load, double screen_pixels, const UnitCosts& c) {
  if (load.draws <= 0.0) return {};
  GpuStages out;
  const double commands = commands_of(load);
  out.state_s = state_s(commands, {.state = command_s(load, c)});
  const double per_draw = load.vertices / load.draws;
  const std::array vertices{
      Work{load.draws, mixed(c.draw_s, load.textured_share, &Curve::line_at, per_draw)}};
  const double instances_save_s = (load.draws - commands) * std::min(c.instance_saves_s, command_s(load, c));
  out.vertices_s = bulk_factor(load.triangles, c) *
                   beside_s(work_s(vertices) - instances_save_s, triangles_s(load, c), c.triangle_overlap);
  const Shaded s = shaded_fragments(load, screen_pixels);
  const double shade_s = mixed(c.fragment_s, textured_fragments(load), &Curve::at, s.covered_share);
  const std::array fragments{Work{s.shaded, shade_s}, Work{s.hidden, c.hidden_fragment_s}};
  out.fragments_s = work_s(fragments);
  // Costs in proportion to what the fragments themselves do: hidden ones are not shaded.
  const double plain_s = c.fragment_s[static_cast<std::size_t>(Shading::plain)].at(s.covered_share);
  const double textured = textured_fragments(load);
  const double edge_s = (1.0 - textured) * c.edge_s + textured * c.textured_edge_s;
  if (plain_s > 0.0 && load.fragments > 0.0)
    out.fragments_s += edge_s * outlines(load) * out.fragments_s / (plain_s * load.fragments);
  return out;
}

double queries_device_s(double asked, double hidden, double fragments, double covered, const UnitCosts& c) {
  if (asked <= 0.0) return 0.0;
  const double passing = hidden < asked ? std::min(fragments, covered) : 0.0;
  const double failing = 2.0 * fragments - passing;
  return asked * c.query_s + std::max(0.0, asked - hidden) * c.seen_query_s + passing * c.asked_fragment_s +
         failing * c.hidden_fragment_s;
}

Prediction predict(Method method, const FrameFacts& f, const UnitCosts& c, const PredictionOptions& options) {
  const Taken taken = take(method, f, options);
  const TimeUnits t = units_of(c, f, options);
  const FrameCounts& n = taken.counts;
  const Way& way = taken.way;
  const bool asks = way.queries && n.queried_nodes > 0.0;

  Prediction p;
  p.update_s = update_scene_s(n, t);
  if (way.octree) {
    p.update_octree_s = update_octree_s(n, t);
    p.cull_s = traverse_s(n, t) + cull_octree_s(n, t) + taken.listed * t.list;
  } else if (method != Method::brute && method != Method::hi_z) {
    p.cull_s = cull_scene_s(n, t) + f.in_frustum.draws * c.list_draw_s;
  }
  p.record_s = record_s(f.blended.draws, t);
  if (method == Method::hi_z) {
    p.record_s += c.hi_z_cpu_s;
  } else {
    p.record_s += way.kept ? record_kept_s(n.rerecorded_draws, t) : record_s(taken.drawn.draws, t);
  }
  if (way.kept) p.secondaries_s = secondaries_s(n, t);
  if (asks) {
    p.queries_cpu_s = ask_s(n, t) + receive_queries_s(n, t);
    if (taken.hidden > 0.0) p.queries_cpu_s += c.second_part_cpu_s;
  }
  p.shadows_cpu_s = f.shadow_slots * c.shadow_slot_s;
  const double empty_cpu_s =
      c.empty_cpu_s - (options.readback ? 0.0 : std::min(c.readback_cpu_s, c.empty_cpu_s));
  const double empty_device_s =
      c.empty_device_s - (options.readback ? 0.0 : std::min(c.readback_device_s, c.empty_device_s));
  p.cpu_s = empty_cpu_s + p.update_s + p.update_octree_s + p.cull_s + p.record_s + p.secondaries_s +
            p.queries_cpu_s + p.shadows_cpu_s;

  const Load all = together(taken.drawn, f.blended);
  p.shadows_device_s = f.shadow_vertices * c.shadow_vertex_s;
  GpuStages stages = device_stages(all, f.screen_pixels, c);
  if (way.kept)
    stages.vertices_s = beside_s(nodes_state_s(taken, c, options.indirect_nodes),
                                 std::max(stages.state_s, stages.vertices_s), c.node_overlap);
  p.draw_device_s = gpu_s(stages, {}, 0.0, c.stage_overlap) +
                    (way.kept ? nodes_device_s(taken, c, options.indirect_nodes) : 0.0);
  if (asks) {
    const double covered = shaded_fragments(all, f.screen_pixels).covered_share * f.screen_pixels;
    p.query_device_s = queries_device_s(n.queried_nodes, taken.found, taken.asked_area, covered, c);
    if (taken.hidden > 0.0) p.query_device_s += c.second_part_device_s;
  }
  if (method == Method::hi_z)
    p.query_device_s = c.hi_z_device_s + f.hi_z_blocks * c.hi_z_block_s + f.visible_slots * c.hi_z_slot_s;
  const double sky_s =
      shaded_fragments(all, f.screen_pixels).covered_share * f.screen_pixels * c.background_s;
  p.gpu_s = std::max(0.0, empty_device_s - sky_s) + p.shadows_device_s + p.draw_device_s + p.query_device_s;
  p.frame_s = frame_s(p.cpu_s, p.gpu_s, options.frames_in_flight, t);
  if (options.frames_in_flight <= 1) p.frame_s -= c.send_overlap * std::min(p.secondaries_s, p.gpu_s);
  return p;
}

}  // namespace scenegen::render::model
