// What a frame costs (D 2.5): each stage a count times a calibrated unit; seconds.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "scene/transform.h"

namespace scenegen::render::model {

/// Unit times, s, of one frame: UnitCosts at the sizes that the frame has (units_of). `secondary` is that of
/// the number of draws a kept command buffer holds here.
struct TimeUnits {
  double update = 0;                      ///< t_upd: writing an object's properties
  double intersect = 0;                   ///< t_intersect: one level of moving an object in the octree
  double refresh_chunk = 0;               ///< bringing a chunk of the octree, and the nodes above, up to date
  double refresh_slot = 0;                ///< making boxes and sums of one anew, from a slot
  double traverse = 0;                    ///< t_trav: visiting a node
  double cull_object = 0, cull_node = 0;  ///< t_fc: culling one
  double list = 0;                        ///< bringing a slot of a chunk in order, when nothing is kept
  double record = 0;                      ///< t_buf: recording and sending a command
  double record_kept = 0;                 ///< t_buf of a command that is kept: recording it
  double ask = 0;                         ///< t_buf of a query: its box, begin and end
  double secondary = 0;                   ///< t_sec: sending a kept command buffer
  double state = 0;                       ///< t_state: a change of material
  double query = 0;                       ///< t_exec: executing a query
  double receive = 0;                     ///< t_recv: reading a result
  double empty_frame =
      0;  ///< T_0: what a frame costs with nothing in it; not in D, whose own predictions end there
  double overlap = 1;  ///< share of the shorter of processor and device that is done beside the longer
};

/// What there is to do in a frame.
struct FrameCounts {
  double objects = 0;           ///< |obj|
  double changed_share = 0;     ///< d_anim
  double moved_share = 0;       ///< d'_anim
  double nodes = 0;             ///< |H| that are visited
  double boxes = 0;             ///< of nodes and chunks that are tested; D tests a box a node
  double height = 0;            ///< of the octree
  double refreshed_chunks = 0;  ///< in which something changed
  double refreshed_slots = 0;   ///< of those that something left or moved in: all that are left in them
  double drawn_objects = 0;     ///< |S_vis|
  double drawn_nodes = 0;       ///< |H_vis|
  double rerecorded_draws = 0;  ///< draws in H_upd
  double queried_nodes = 0;     ///< |H_q|
};

/// How a frame is drawn: h, g and q of (2.10), which sums what these say.
struct Way {
  bool octree = false, kept = false, queries = false;
};

[[nodiscard]] double update_scene_s(const FrameCounts& n, const TimeUnits& t);  ///< (2.13)
/// T_upd(H), below (2.13), d'_anim |obj| height t_intersect, and what D leaves out: each chunk that changed,
/// and the nodes above it, are brought up to date, + chunks t_chunk; boxes and sums of those that something
/// left or moved in are made anew from all that is left in them, + slots t_refresh.
[[nodiscard]] double update_octree_s(const FrameCounts& n, const TimeUnits& t);
[[nodiscard]] double traverse_s(const FrameCounts& n, const TimeUnits& t);         ///< (2.14)
[[nodiscard]] double cull_octree_s(const FrameCounts& n, const TimeUnits& t);      ///< (2.15)
[[nodiscard]] double cull_scene_s(const FrameCounts& n, const TimeUnits& t);       ///< (2.15), flat
[[nodiscard]] double record_s(double commands, const TimeUnits& t);                ///< (2.16)
[[nodiscard]] double record_kept_s(double commands, const TimeUnits& t);           ///< (2.16), of H_upd
[[nodiscard]] double ask_s(const FrameCounts& n, const TimeUnits& t);              ///< (2.16), of H_q
[[nodiscard]] double secondaries_s(const FrameCounts& n, const TimeUnits& t);      ///< (2.17)
[[nodiscard]] double state_s(double materials, const TimeUnits& t);                ///< (2.18)
[[nodiscard]] double execute_queries_s(const FrameCounts& n, const TimeUnits& t);  ///< (2.21)
[[nodiscard]] double receive_queries_s(const FrameCounts& n, const TimeUnits& t);  ///< (2.22)

/// So many elements (vertices, fragments) at a unit time that depends on their material, batch and number.
struct Work {
  double count = 0;
  double unit_s = 0;
};
/// (2.19) vertices, (2.20) fragments: sum of count * unit.
[[nodiscard]] double work_s(std::span<const Work> work);

struct GpuStages {
  double state_s = 0, vertices_s = 0, fragments_s = 0;
};
/// The longest of the stages, and what of the others is not done beside it: with overlap 1 D's maximum, with
/// 0 the sum of vertices (state included) and fragments.
[[nodiscard]] double beside_s(double a_s, double b_s, double overlap);
/// (2.11): the longest stage of drawing, and of querying.
[[nodiscard]] double gpu_s(const GpuStages& drawn, const GpuStages& queried, double execute_queries_s,
                           double overlap = 1.0);

/// (2.12) and T_0: one after the other with one primary command buffer, side by side with more.
[[nodiscard]] double frame_s(double cpu_s, double gpu_s, std::uint32_t frames_in_flight, const TimeUnits& t);

struct Screen {
  double width = 0, height = 0;  ///< pixels; times samples under supersampling
  double yfov_rad = 0;
  double near_m = 0;
  glm::dvec3 eye_m{0}, forward{0, 0, -1};
};
/// (2.23): pixels that a box covers, by the mean area of its faces; its distance is that of its nearest
/// corner along the view direction, not less than near; at most the screen. `occupied`: 1 for an object.
[[nodiscard]] double box_fragments(const Box& box, double occupied, const Screen& screen);
/// (3.4), mended: the share of a node's faces that its objects' faces could fill. D leaves out the node's own
/// area.
[[nodiscard]] double occupied_share(double sum_of_object_areas_m2, const Box& node);

}  // namespace scenegen::render::model
