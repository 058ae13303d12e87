// What one unit of each stage costs on a device (D 2.5.4, 4.2): measured by calibration, read by the model.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "scene/result.h"

namespace scenegen::render::model {

/// Measured points, ascending in x > 0; 0 everywhere without points. D takes the nearest test scene.
struct Curve {
  std::vector<double> x;
  std::vector<double> y;
  /// Between points linear in log x, outside them the first or last value: for a cost of one element that
  /// depends on how many there are.
  [[nodiscard]] double at(double value) const;
  /// Between points linear in x, before them the first value, behind them along the last two: for what a
  /// thing of size x costs.
  [[nodiscard]] double line_at(double value) const;
};

/// What shading depends on: one curve each is measured (D: t_vert, t_frag per material).
enum class Shading : std::size_t { plain, textured };
constexpr std::size_t kShadings = 2;

/// Seconds, unless said. `processor` costs are those of the thread that draws, what vkQueueSubmit takes for
/// it included; `device` costs are of the whole GPU (or of lavapipe's threads).
struct UnitCosts {
  // Processor.
  double update_object_s = 0;    ///< t_upd: an entry of the ChangeSet: visible set, box, record, upload
  double intersect_s = 0;        ///< t_intersect: one level of moving an object in the octree
  double refresh_chunk_s = 0;    ///< bringing a chunk that changed, and the nodes above, up to date
  double refresh_slot_s = 0;     ///< making boxes and sums of one anew, from a slot of it
  double visit_node_s = 0;       ///< t_trav
  double cull_slot_s = 0;        ///< t_fc: one box of many, in a row (inline)
  double list_draw_s = 0;        ///< and listing it when it is in the frustum
  double cull_node_s = 0;        ///< t_fc: one box of a node or chunk
  double list_slot_s = 0;        ///< octree-record: bringing a slot of a chunk in order
  double record_s = 0;           ///< t_buf: a draw recorded in this frame, and sent
  double record_kept_s = 0;      ///< t_buf: a draw recorded into a kept command buffer, not sent
  Curve secondary_s;             ///< t_sec: sending a kept command buffer, by draws in it (line_at)
  double node_command_s = 0;     ///< the other form of a node: sending one indirect draw with a count
  double write_indirect_s = 0;   ///< and writing one draw of it
  double ask_s = 0;              ///< t_buf: recording one query with its box, and sending it
  double receive_s = 0;          ///< t_recv: reading one result
  double second_part_cpu_s = 0;  ///< exact queries: what a pass in two parts costs more
  double hi_z_cpu_s = 0;         ///< culling on the device: recording it, all draws included
  double shadow_slot_s = 0;      ///< walking and drawing one slot that casts a shadow
  double empty_cpu_s = 0;        ///< T_0: a frame with nothing in it, copying its picture out included
  double readback_cpu_s = 0;     ///< of it, that copying

  // Device.
  std::array<Curve, kShadings>
      draw_s;  ///< t_state, t_vert: one draw, by vertices shaded in it (line_at), without fragments
  Curve bulk;  ///< factor on vertices and triangles, by triangles of the frame (at): lavapipe sets up the
               ///< next batch while one is rasterized, so many take less each
  double instance_saves_s = 0;  ///< against a draw of its own, one of several instances of a command
  double triangle_s = 0;  ///< and each triangle of it, beside its vertices as far as triangle_overlap says
  double speck_triangle_s = 0;  ///< one so small that it covers nothing: dropped before it is rasterized
  std::array<Curve, kShadings> fragment_s;  ///< t_frag: one fragment, by the share of the screen covered (at)
  double edge_s = 0;                        ///< what outlines of triangles add to t_frag, by outlines()
  double textured_edge_s = 0;               ///< and those of textured ones
  double hidden_fragment_s = 0;             ///< one that fails the depth test, of things among others
  double background_s = 0;                  ///< one of the sky: part of T_0 that whatever covers it saves
  double secondary_device_s = 0;            ///< t_state: executing a kept command buffer, beside its draws
  double node_command_device_s = 0;         ///< executing an indirect draw with a count, whatever is in it
  double indirect_draw_s = 0;               ///< one draw of it (instead of draw_s' part that is commands)
  double skipped_draw_s = 0;                ///< t_skip: a draw under a predicate that is 0
  double query_s = 0;                       ///< t_exec: one query whose box is hidden, hardly a fragment
  double seen_query_s = 0;                  ///< what one whose box is seen takes beyond that
  double asked_fragment_s = 0;              ///< a fragment of a query's box that is seen
  double second_part_device_s = 0;  ///< T_2: exact queries: copy, scatter, barriers, the pass's second part
  double hi_z_device_s = 0;         ///< culling on the device: the depth pyramid, the pass's second part
  double hi_z_block_s = 0;          ///< a block of slots: its workgroups, and commands that draw nothing
  double hi_z_slot_s = 0;           ///< a slot that is visible by timeline: its tests
  double shadow_vertex_s = 0;       ///< one vertex in the shadow map's pass
  double empty_device_s = 0;        ///< T_0, copying the picture to where it is read included
  double readback_device_s = 0;     ///< of it, that copying

  // What the driver holds, bytes.
  double secondary_bytes = 0;  ///< M_sec: a kept command buffer by itself
  double command_bytes = 0;    ///< M_cmd: a draw in it

  // How far work is done side by side: 1 all of the shorter part, as (2.11) and (2.12) have it; 0 none.
  double stage_overlap = 1;     ///< vertices with fragments
  double triangle_overlap = 1;  ///< vertices with triangles: GPUs have units for each, processors not
  double node_overlap = 1;      ///< executing kept command buffers with their vertices
  double frame_overlap = 1;     ///< processor with device, several frames in flight
  double send_overlap = 0;      ///< sending kept command buffers with the device, one frame in flight
  double latency_s = 0;  ///< T_0: from submitting to being told of the end, beyond the work; one in flight
};

/// Costs of a machine that was not calibrated: lavapipe's on two cores, or those of a large GPU. Only the
/// order of magnitude is right; who uses them says so.
[[nodiscard]] UnitCosts rough_costs(bool software_device);

}  // namespace scenegen::render::model
