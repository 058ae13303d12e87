// What a frame would cost, drawn in each of the ways there are (D 2.5): (2.10)-(2.12) with calibrated units.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "render/model/frame_time.h"
#include "render/model/unit_costs.h"

namespace scenegen::render::model {

/// The ways that the model knows, by the names of their strategies.
enum class Method : std::uint8_t {
  brute,
  inline_frustum,
  inline_queries,
  octree_record,
  octree,
  queries_all,
  queries,
  hi_z  ///< culled on the device: not one of the dissertation's
};
constexpr std::size_t kMethods = 8;
[[nodiscard]] std::string_view name_of(Method method);

/// What the device has to draw.
struct Load {
  double draws = 0;
  double vertices = 0;        ///< that are shaded
  double fragments = 0;       ///< (2.23), clamped to the screen each
  double textured_share = 0;  ///< of draws
  double screen_share = 0;    ///< of the screen's pixels that end up covered, at most 1; 0: not known
  double triangles = 0;
  double commands = 0;                  ///< that draw them, several being instances of one; 0: one each
  double textured_fragment_share = -1;  ///< of fragments; below 0: as of draws
};

/// Counts of one frame. Those of the way that was taken are exact; the others are estimates (`exact` says
/// which part holds).
struct FrameFacts {
  double visible_slots = 0;  ///< by timeline
  double changed = 0;        ///< entries of the ChangeSet
  double screen_pixels = 0;  ///< times samples where shading is by sample
  double shadow_slots = 0;   ///< drawn into the shadow map, in runs; the same for all ways
  double shadow_vertices = 0;

  // Loads are of opaque and masked slots; blended ones are counted apart and drawn the same way by all.
  Load blended;
  Load visible;     ///< all that is visible by timeline
  Load in_frustum;  ///< by object

  // The octree, as built or by (3.1)-(3.3).
  double height = 0;
  double chunks_refreshed = 0;  ///< of the whole scene, in which something changed
  double slots_refreshed = 0;   ///< in those of them that something left or moved in
  double nodes_visited = 0;
  double boxes_tested = 0;  ///< of nodes and chunks
  double chunks = 0;        ///< in the frustum
  Load in_chunks;           ///< all that is in them
  double chunks_rerecorded = 0;
  double draws_rerecorded = 0;
  // Indirect draws: 0: not known.
  double commands_per_draw = 0;  ///< slots that are instances of one command share it
  double runs_per_chunk = 0;     ///< of one pipeline state: each is a command of the processor

  // Queries. `queries` asks x* chunks, `queries_all` all chunks; `inline_queries` asks about every slot in
  // the frustum by its own box.
  double asked = 0;
  double asked_fragments = 0;      ///< of the queried boxes
  double chunks_hidden = 0;        ///< found hidden by them
  Load hidden;                     ///< all that is in those
  double all_asked_fragments = 0;  ///< if all chunks were asked
  double all_chunks_hidden = 0;    ///< and what would be hidden then
  Load all_hidden;
  Load slots_hidden;  ///< slots that `inline_queries` found hidden, or would

  // Culling on the device.
  double hi_z_blocks = 0;  ///< of slots, each culled by a workgroup and drawn by one command a part
  Load seen;               ///< what it finds not hidden, and draws

  bool exact_inline = false, exact_octree = false, exact_queries = false, exact_seen = false;
};

/// Seconds, stage by stage.
struct Prediction {
  double update_s = 0;         ///< T_upd(S)
  double update_octree_s = 0;  ///< T_upd(H)
  double cull_s = 0;           ///< T_fc(S), or T_trav(H) + T_fc(H)
  double record_s = 0;         ///< T_buf
  double secondaries_s = 0;    ///< T_sec
  double queries_cpu_s = 0;    ///< T_buf(H_q) + T_recv(H_q)
  double shadows_cpu_s = 0;    ///< walking and recording what casts shadows
  double shadows_device_s = 0;
  double draw_device_s = 0;   ///< max(T_state, T_vert, T_frag)(S_vis)
  double query_device_s = 0;  ///< max(..., T_exec)(H_q); of hi_z: pyramid and culling
  double cpu_s = 0;           ///< (2.10) + T_0
  double gpu_s = 0;           ///< (2.11) + T_0
  double frame_s = 0;         ///< (2.12)
};

struct PredictionOptions {
  std::uint32_t frames_in_flight = 2;
  bool exact = true;            ///< queries: hidden chunks are recorded and executed under a predicate
  bool indirect_nodes = false;  ///< chunks as indirect draws with a count instead of secondaries
  bool readback = true;         ///< the picture is copied out
};

/// How many of `load`'s fragments are shaded when they come in random order: of k layers over a pixel the
/// i-th is in front of those before it with chance 1/i, so 1 + 1/2 + ... + 1/k. An unknown screen_share is
/// taken from fragments that fall anywhere, 1 - exp(-fragments / pixels).
struct Shaded {
  double covered_share = 0;  ///< of the screen
  double shaded = 0, hidden = 0;
};
[[nodiscard]] Shaded shaded_fragments(const Load& load, double screen_pixels);

/// Sum over the triangles that are seen of the root of their area in fragments, in proportion to the length
/// of their outlines: a pixel that an outline cuts through is shaded for the triangles on both sides of it.
/// Half of the triangles face the viewer; of those smaller than a fragment, only as many as fragments count.
[[nodiscard]] double outlines(const Load& load);

/// What triangles cost beside their vertices: of those smaller than a fragment, many cover no sample.
[[nodiscard]] double triangles_s(const Load& load, const UnitCosts& costs);
/// On that and on vertices, when so many are drawn in a frame.
[[nodiscard]] double bulk_factor(double triangles, const UnitCosts& costs);

/// (2.18) to (2.20) of a load. The cost of a draw's commands is part of T_vert too.
[[nodiscard]] GpuStages device_stages(const Load& load, double screen_pixels, const UnitCosts& costs);

/// (2.19) to (2.21) of queries: `asked`, of which `hidden` find nothing, and the fragments of their boxes.
/// What is seen of those is no more than the `covered` fragments of the picture; the rest, and the faces that
/// look away, fail the depth test.
[[nodiscard]] double queries_device_s(double asked, double hidden, double fragments, double covered,
                                      const UnitCosts& costs);

/// What (2.10) to (2.12) give for a way of drawing; stages that it does not have are 0. Mended: T_0 is added
/// (D's own predictions end there), sky that is covered is taken off it, and (2.11), (2.12) take as much of
/// the shorter side as the device was seen not to do side by side (UnitCosts::stage_overlap, frame_overlap).
[[nodiscard]] Prediction predict(Method method, const FrameFacts& facts, const UnitCosts& costs,
                                 const PredictionOptions& options);

}  // namespace scenegen::render::model
