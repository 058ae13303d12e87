// What a frame would cost, drawn in each of the ways there are (D 2.5): (2.10)-(2.12) with calibrated units.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

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
  queries
};
constexpr std::size_t kMethods = 7;
[[nodiscard]] std::string_view name_of(Method method);

/// What the device has to draw.
struct Load {
  double draws = 0;
  double vertices = 0;
  double fragments = 0;       ///< (2.23), clamped to the screen each
  double textured_share = 0;  ///< of draws
  double screen_share = 0;    ///< of the screen's pixels that end up covered, at most 1
};

/// Counts of one frame. Those of the way that was taken are exact; the others are estimates (`exact` says
/// which part holds).
struct FrameFacts {
  double objects = 0;
  double visible_slots = 0;  ///< by timeline
  double changed = 0;        ///< entries of the ChangeSet
  double moved = 0;          ///< of them with another box
  double blended_draws = 0;  ///< drawn the same way by all
  double screen_pixels = 0;  ///< times samples where shading is by sample

  // Loads are of opaque and masked slots; blended ones are counted apart.
  Load visible;     ///< all that is visible by timeline
  Load in_frustum;  ///< by object

  // The octree, as built or by (3.1)-(3.3).
  double height = 0;
  double nodes_visited = 0;
  double boxes_tested = 0;  ///< of nodes and chunks
  double chunks = 0;        ///< in the frustum
  Load in_chunks;           ///< all that is in them
  double chunks_rerecorded = 0;
  double draws_rerecorded = 0;

  // Queries. `queries` asks x* chunks, `queries_all` all chunks, `inline_queries` every slot in the frustum.
  double asked = 0;
  double asked_fragments = 0;      ///< of the queried boxes
  double chunks_hidden = 0;        ///< found hidden by them
  Load hidden;                     ///< all that is in those
  double all_asked_fragments = 0;  ///< if all chunks were asked
  double all_chunks_hidden = 0;    ///< and what would be hidden then
  Load all_hidden;

  bool exact_inline = false, exact_octree = false, exact_queries = false;
};

/// Seconds, stage by stage.
struct Prediction {
  double update_s = 0;         ///< T_upd(S)
  double update_octree_s = 0;  ///< T_upd(H)
  double cull_s = 0;           ///< T_fc(S), or T_trav(H) + T_fc(H)
  double record_s = 0;         ///< T_buf
  double secondaries_s = 0;    ///< T_sec
  double queries_cpu_s = 0;    ///< T_buf(H_q) + T_recv(H_q)
  double draw_device_s = 0;    ///< max(T_state, T_vert, T_frag)(S_vis)
  double query_device_s = 0;   ///< max(..., T_exec)(H_q)
  double cpu_s = 0;            ///< (2.10) + T_0
  double gpu_s = 0;            ///< (2.11) + T_0
  double frame_s = 0;          ///< (2.12)
};

struct PredictionOptions {
  std::uint32_t frames_in_flight = 2;
  bool exact = true;            ///< queries: hidden chunks are recorded and executed under a predicate
  bool indirect_nodes = false;  ///< chunks as indirect draws with a count instead of secondaries
};

[[nodiscard]] Prediction predict(Method method, const FrameFacts& facts, const UnitCosts& costs,
                                 const PredictionOptions& options);

}  // namespace scenegen::render::model
