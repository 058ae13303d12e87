#include "render/strategy/octree_choice.h"

#include "render/vk/device.h"

namespace scenegen::render {

bool can_draw_indirect(const StrategyContext& context) {
  return context.device.indirect_nodes && !context.options.no_indirect_draws;
}

bool indirect_nodes(const StrategyContext& context) {
  const StrategyOptions& o = context.options;
  if (o.node_form == NodeForm::secondaries || !can_draw_indirect(context)) return false;
  if (o.node_form == NodeForm::indirect) return true;
  if (!context.device.conditional_rendering || o.no_conditional_rendering) return true;
  const model::UnitCosts& c = context.costs;
  const double draws = o.objects_per_node != 0 ? o.objects_per_node : kObjectsPerNode;
  // A draw in a secondary costs what a tiny one costs otherwise.
  const double tiny_draw_s = c.draw_s[static_cast<std::size_t>(model::Shading::plain)].at(0);
  const double secondary_s = c.secondary_s.line_at(draws) + c.secondary_device_s + draws * tiny_draw_s;
  return c.node_command_s + c.node_command_device_s + draws * c.indirect_draw_s < secondary_s;
}

}  // namespace scenegen::render
