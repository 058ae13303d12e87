// The strategies there are, by name, without what is behind them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scenegen::render {

/// {"brute", "brute"}, …: for a command line option.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> strategy_choices();

/// What an option of a command line has to know of a strategy.
struct StrategyTraits {
  bool uses_costs = false;   ///< chooses by unit costs, so that a calibration matters
  bool keeps_nodes = false;  ///< has nodes of an octree to show
  bool can_be_late = false;  ///< RendererOptions: late_visibility changes what it draws
};
/// All false for a name that is none.
[[nodiscard]] StrategyTraits strategy_traits(std::string_view name);
/// Names of those that have a trait: strategies_that(&StrategyTraits::keeps_nodes).
[[nodiscard]] std::vector<std::string> strategies_that(bool StrategyTraits::*trait);

}  // namespace scenegen::render
