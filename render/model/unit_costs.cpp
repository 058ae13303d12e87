#include "render/model/unit_costs.h"

#include <algorithm>
#include <cmath>

namespace scenegen::render::model {

double Curve::at(double value) const {
  if (x.empty()) return 0;
  if (value <= x.front()) return y.front();
  if (value >= x.back()) return y.back();
  const auto above = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), value) - x.begin());
  const double lower = x[above - 1];
  const double share = std::log(value / lower) / std::log(x[above] / lower);
  return y[above - 1] + share * (y[above] - y[above - 1]);
}

double Curve::line_at(double value) const {
  if (x.empty()) return 0;
  if (value <= x.front() || x.size() == 1) return y.front();
  const auto found = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), value) - x.begin());
  const std::size_t above = std::min(found, x.size() - 1);
  const double share = (value - x[above - 1]) / (x[above] - x[above - 1]);
  return std::max(0.0, y[above - 1] + share * (y[above] - y[above - 1]));
}

UnitCosts rough_costs(bool software_device) {
  UnitCosts c;
  c.update_object_s = 100e-9;
  c.intersect_s = 40e-9;
  c.refresh_chunk_s = 300e-9;
  c.refresh_slot_s = 10e-9;
  c.visit_node_s = 20e-9;
  c.cull_slot_s = 1e-9;
  c.list_draw_s = 3e-9;
  c.cull_node_s = 10e-9;
  c.list_slot_s = 3e-9;
  c.record_s = software_device ? 90e-9 : 25e-9;
  c.record_kept_s = software_device ? 120e-9 : 30e-9;
  c.secondary_s =
      software_device ? Curve{{1, 1000}, {0.3e-6, 0.5e-6}} : Curve{{1, 200, 1000}, {0.8e-6, 1e-6, 1.8e-6}};
  c.node_command_s = software_device ? 100e-9 : 40e-9;
  c.write_indirect_s = 3e-9;
  c.ask_s = software_device ? 500e-9 : 120e-9;
  c.receive_s = 10e-9;
  c.second_part_cpu_s = 20e-6;
  c.empty_cpu_s = 100e-6;
  // lavapipe: 1.3 us a draw and 30 ns a vertex; H100: 14 ns a tiny draw, then some 0.6 ns a vertex.
  c.draw_s.fill(software_device ? Curve{{3, 36, 3600}, {1.4e-6, 2.4e-6, 110e-6}}
                                : Curve{{3, 36, 3600}, {14e-9, 30e-9, 2e-6}});
  c.triangle_s = software_device ? 40e-9 : 1e-9;
  c.speck_triangle_s = c.triangle_s;
  c.bulk = {{20e3}, {1}};
  c.fragment_s.fill(software_device ? Curve{{0.01, 1}, {15e-9, 10e-9}} : Curve{{0.01, 1}, {50e-12, 20e-12}});
  c.hidden_fragment_s = software_device ? 1e-9 : 5e-12;
  c.secondary_device_s = software_device ? 5e-6 : 1.5e-6;
  c.node_command_device_s = software_device ? 2e-6 : 0.3e-6;
  c.indirect_draw_s = software_device ? 1.3e-6 : 14e-9;
  c.skipped_draw_s = software_device ? 110e-9 : 10e-9;
  c.edge_s = c.textured_edge_s = software_device ? 1e-6 : 0.0;
  c.instance_saves_s = software_device ? 1.3e-6 : 0.0;
  c.background_s = software_device ? 5e-9 : 10e-12;
  c.query_s = software_device ? 10e-6 : 0.05e-6;
  c.seen_query_s = software_device ? 0.0 : 0.15e-6;
  c.asked_fragment_s = software_device ? 1e-9 : 0.5e-9;
  c.second_part_device_s = software_device ? 100e-6 : 30e-6;
  c.hi_z_cpu_s = 60e-6;
  c.hi_z_device_s = software_device ? 5e-3 : 100e-6;
  c.hi_z_block_s = software_device ? 2e-6 : 40e-9;
  c.hi_z_slot_s = software_device ? 50e-9 : 0.1e-9;
  c.shadow_slot_s = 3e-9;
  c.shadow_vertex_s = software_device ? 20e-9 : 0.5e-9;
  // lavapipe; NVIDIA H200 (driver 580), by the growth of the process (docs/BENCHMARKS.md).
  c.secondary_bytes = software_device ? 7600 : 24500;
  c.command_bytes = software_device ? 150 : 61;
  c.stage_overlap = software_device ? 0.5 : 1.0;
  c.triangle_overlap = software_device ? 0.0 : 1.0;
  c.node_overlap = software_device ? 0.0 : 0.6;
  c.frame_overlap = software_device ? 0.5 : 1.0;
  c.latency_s = 40e-6;
  c.empty_device_s = software_device ? 2e-3 : 100e-6;
  return c;
}

}  // namespace scenegen::render::model
