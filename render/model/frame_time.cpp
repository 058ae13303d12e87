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

double longest(const GpuStages& stages) {
  return std::max({stages.state_s, stages.vertices_s, stages.fragments_s});
}

}  // namespace

double update_scene_s(const FrameCounts& n, const TimeUnits& t) {
  return n.changed_share * n.objects * t.update;
}
double update_octree_s(const FrameCounts& n, const TimeUnits& t) {
  return n.moved_share * n.objects * n.height * t.intersect;
}
double traverse_s(const FrameCounts& n, const TimeUnits& t) {
  return n.nodes * t.traverse;
}
double cull_octree_s(const FrameCounts& n, const TimeUnits& t) {
  return n.nodes * t.cull_node;
}
double cull_scene_s(const FrameCounts& n, const TimeUnits& t) {
  return n.objects * t.cull_object;
}
double record_s(double commands, const TimeUnits& t) {
  return commands * t.record;
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

double cpu_s(const Way& way, const FrameCounts& n, const TimeUnits& t) {
  double sum = update_scene_s(n, t);
  sum += way.octree ? update_octree_s(n, t) + traverse_s(n, t) + cull_octree_s(n, t) : cull_scene_s(n, t);
  sum += way.kept ? record_s(n.rerecorded_draws, t) + secondaries_s(n, t) : record_s(n.drawn_objects, t);
  if (way.queries) sum += record_s(n.queried_nodes, t) + receive_queries_s(n, t);
  return sum;
}

double gpu_s(const GpuStages& drawn, const GpuStages& queried, double execute_queries_s) {
  return longest(drawn) + std::max(longest(queried), execute_queries_s);
}

double frame_s(double cpu_s, double gpu_s, std::uint32_t frames_in_flight, const TimeUnits& t) {
  return t.empty_frame + (frames_in_flight <= 1 ? cpu_s + gpu_s : std::max(cpu_s, gpu_s));
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
