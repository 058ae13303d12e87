#include <algorithm>
#include <array>

#include "render/strategy/strategy.h"
#include "render/strategy_names.h"

namespace scenegen::render {

std::unique_ptr<Strategy> make_brute(const StrategyContext& context);
std::unique_ptr<Strategy> make_inline(const StrategyContext& context);
std::unique_ptr<Strategy> make_inline_queries(const StrategyContext& context);
std::unique_ptr<Strategy> make_instanced(const StrategyContext& context);
std::unique_ptr<Strategy> make_hi_z(const StrategyContext& context);
std::unique_ptr<Strategy> make_octree_record(const StrategyContext& context);
std::unique_ptr<Strategy> make_octree(const StrategyContext& context);
std::unique_ptr<Strategy> make_queries(const StrategyContext& context);
std::unique_ptr<Strategy> make_queries_all(const StrategyContext& context);
std::unique_ptr<Strategy> make_adaptive(const StrategyContext& context);

std::span<const StrategyEntry> strategies() {
  static constexpr std::array kEntries{
      StrategyEntry{"brute", "every object that is visible by timeline; the reference", &make_brute},
      StrategyEntry{"inline", "frustum culling of every object, commands recorded each frame", &make_inline},
      StrategyEntry{"inline-queries",
                    "the same, with an occlusion query for every object; may draw it some frames too late",
                    &make_inline_queries},
      StrategyEntry{"instanced", "the same, with one instanced draw for all that are equal", &make_instanced},
      StrategyEntry{"octree-record", "octree culling, commands recorded each frame", &make_octree_record},
      StrategyEntry{
          "octree", "octree culling, commands of each node kept", &make_octree, {.keeps_nodes = true}},
      StrategyEntry{"queries-all",
                    "the same, with an occlusion query for every node",
                    &make_queries_all,
                    {.keeps_nodes = true, .can_be_late = true}},
      StrategyEntry{"queries",
                    "the same, with as many occlusion queries as pay",
                    &make_queries,
                    {.uses_costs = true, .keeps_nodes = true, .can_be_late = true}},
      StrategyEntry{"hi-z",
                    "frustum and occlusion culling of every object on the device",
                    &make_hi_z,
                    {.can_be_late = true}},
      StrategyEntry{
          "adaptive",
          "the cheapest of inline, octree, queries and hi-z by a model of what they cost, each frame",
          &make_adaptive,
          {.uses_costs = true, .keeps_nodes = true, .can_be_late = true}},
  };
  return kEntries;
}

const StrategyEntry* find_strategy(std::string_view name) {
  const auto all = strategies();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const StrategyEntry& e) { return e.name == name; });
  return found == all.end() ? nullptr : &*found;
}

StrategyTraits strategy_traits(std::string_view name) {
  const StrategyEntry* found = find_strategy(name);
  return found == nullptr ? StrategyTraits{} : found->traits;
}

std::vector<std::string> strategies_that(bool StrategyTraits::*trait) {
  std::vector<std::string> out;
  for (const StrategyEntry& entry : strategies()) {
    if (entry.traits.*trait) out.emplace_back(entry.name);
  }
  return out;
}

std::vector<std::pair<std::string, std::string>> strategy_choices() {
  std::vector<std::pair<std::string, std::string>> out;
  for (const StrategyEntry& entry : strategies()) out.emplace_back(entry.name, entry.name);
  return out;
}

}  // namespace scenegen::render
