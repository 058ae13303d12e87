// What one unit of each stage costs on a device (D 2.5.4, 4.2): measured by calibration, read by the model.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "scene/result.h"

namespace scenegen::render::model {

/// Measured points, ascending in x > 0. Between them linear in log x (D takes the nearest test scene),
/// outside them the first or last value.
struct Curve {
  std::vector<double> x;
  std::vector<double> y;
  [[nodiscard]] double at(double value) const;
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
  double visit_node_s = 0;       ///< t_trav
  double cull_slot_s = 0;        ///< t_fc: one box of many, in a row (inline)
  double cull_node_s = 0;        ///< t_fc: one box of a node or chunk
  double list_slot_s = 0;        ///< octree-record: bringing a slot of a chunk in order
  double record_s = 0;           ///< t_buf: a draw recorded in this frame, and sent
  double record_kept_s = 0;      ///< t_buf: a draw recorded into a kept command buffer, not sent
  Curve secondary_s;             ///< t_sec: sending a kept command buffer, by draws in it
  double node_command_s = 0;     ///< the other form of a node: sending one indirect draw with a count
  double write_indirect_s = 0;   ///< and writing one draw of it
  double ask_s = 0;              ///< t_buf: recording one query with its box, and sending it
  double receive_s = 0;          ///< t_recv: reading one result
  double second_part_cpu_s = 0;  ///< exact queries: what a pass in two parts costs more
  double empty_cpu_s = 0;        ///< T_0: a frame with nothing in it

  // Device.
  std::array<Curve, kShadings> draw_s;  ///< t_state, t_vert: one draw, by vertices in it, hardly a fragment
  std::array<Curve, kShadings> fragment_s;  ///< t_frag: one fragment, by the share of the screen covered
  double hidden_fragment_s = 0;             ///< one that fails the depth test
  double secondary_device_s = 0;            ///< executing a kept command buffer
  double node_command_device_s = 0;         ///< executing an indirect draw with a count, whatever is in it
  double indirect_draw_s = 0;               ///< one draw of it (instead of draw_s' part that is commands)
  double skipped_draw_s = 0;                ///< t_skip: a draw under a predicate that is 0
  double query_s = 0;                       ///< t_exec: one query beyond its box
  double second_part_device_s = 0;  ///< T_2: exact queries: copy, scatter, barriers, the pass's second part
  double empty_device_s = 0;        ///< T_0
};

/// Costs of a machine that was not calibrated: lavapipe's on two cores, or those of a large GPU. Only the
/// order of magnitude is right; who uses them says so.
[[nodiscard]] UnitCosts rough_costs(bool software_device);

}  // namespace scenegen::render::model
