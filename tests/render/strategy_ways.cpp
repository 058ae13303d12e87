#include "tests/render/strategy_ways.h"

namespace scenegen::render::test {

RendererOptions path_options(const std::string& strategy) {
  RendererOptions o = test_options();
  o.strategy = strategy;
  o.how.objects_per_node = 10;  // many nodes, though the scenes are small
  return o;
}

std::string Way::name() const {
  return strategy + (form == NodeForm::indirect ? ", indirect" : ", secondaries");
}

RendererOptions Way::options() const {
  RendererOptions o = path_options(strategy);
  o.how.node_form = form;
  // On every device `queries` is to find that asking pays, though the scenes are small.
  o.costs = model::rough_costs(true);
  o.costs->query_s = 1e-6;
  o.costs->ask_s = 1e-7;
  o.costs->second_part_cpu_s = o.costs->second_part_device_s = 0;
  return o;
}

}  // namespace scenegen::render::test
