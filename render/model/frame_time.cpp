#include "render/model/frame_time.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace scenegen::render::model {
namespace {

double area_m2(const Box& box) {
  const glm::dvec3 s(box.size());
  return 2.0 * (s.x * s.y + s.y * s.z + s.z * s.x);
}

double together(const GpuStages& stages, double overlap) {
  return beside_s(std::max(stages.state_s, stages.vertices_s), stages.fragments_s, overlap);
}

}  // namespace

double update_scene_s(const FrameCounts& n, const TimeUnits& t) {
  return n.changed_share * n.objects * t.update;
}
double update_octree_s(const FrameCounts& n, const TimeUnits& t) {
  return n.moved_share * n.objects * n.height * t.intersect + n.refreshed_chunks * t.refresh_chunk +
         n.refreshed_slots * t.refresh_slot;
}
double traverse_s(const FrameCounts& n, const TimeUnits& t) {
  return n.nodes * t.traverse;
}
double cull_octree_s(const FrameCounts& n, const TimeUnits& t) {
  return n.boxes * t.cull_node;
}
double cull_scene_s(const FrameCounts& n, const TimeUnits& t) {
  return n.objects * t.cull_object;
}
double record_s(double commands, const TimeUnits& t) {
  return commands * t.record;
}
double record_kept_s(double commands, const TimeUnits& t) {
  return commands * t.record_kept;
}
double ask_s(const FrameCounts& n, const TimeUnits& t) {
  return n.queried_nodes * t.ask;
}
double secondaries_s(const FrameCounts& n, const TimeUnits& t) {
  return n.drawn_nodes * t.secondary;
}
double state_s(double materials, const TimeUnits& t) {
  return materials * t.state;
}
double execute_queries_s(const FrameCounts& n, const TimeUnits& t) {
  return n.queried_nodes * t.query;
}
double receive_queries_s(const FrameCounts& n, const TimeUnits& t) {
  return n.queried_nodes * t.receive;
}

double work_s(std::span<const Work> work) {
  return std::accumulate(work.begin(), work.end(), 0.0,
                         [](double sum, const Work& w) { return sum + w.count * w.unit_s; });
}

double beside_s(double a_s, double b_s, double overlap) {
  return std::max(a_s, b_s) + (1.0 - overlap) * std::min(a_s, b_s);
}

double gpu_s(const GpuStages& drawn, const GpuStages& queried, double execute_queries_s, double overlap) {
  return together(drawn, overlap) + std::max(together(queried, overlap), execute_queries_s);
}

double frame_s(double cpu_s, double gpu_s, std::uint32_t frames_in_flight, const TimeUnits& t) {
  return t.empty_frame + beside_s(cpu_s, gpu_s, frames_in_flight <= 1 ? 0.0 : t.overlap);
}

double box_fragments(const Box& box, double occupied, const Screen& screen) {
  if (box.empty()) return 0.0;
  const double side = 1.0 / (std::sqrt(screen.width / screen.height) * 2.0 * std::tan(0.5 * screen.yfov_rad));
  const glm::dvec3 half = 0.5 * glm::dvec3(box.size());
  const double nearest = glm::dot(glm::dvec3(box.centre()) - screen.eye_m, screen.forward) -
                         glm::dot(half, glm::abs(screen.forward));
  const double d = std::max(nearest, screen.near_m);
  const double pixels = screen.width * screen.height;
  return std::min(pixels, pixels * side * side * (area_m2(box) / 6.0) / (d * d) * occupied);
}

double occupied_share(double sum_of_object_areas_m2, const Box& node) {
  const double own = area_m2(node);
  return own > 0.0 ? std::min(1.0, sum_of_object_areas_m2 / own) : 1.0;
}

}  // namespace scenegen::render::model
