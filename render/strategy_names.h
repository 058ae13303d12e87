// The strategies there are, by name, without what is behind them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scenegen::render {

/// {"brute", "brute"}, …: for a command line option.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> strategy_choices();
/// Does it choose by unit costs, so that a calibration matters?
[[nodiscard]] bool strategy_uses_costs(std::string_view name);

}  // namespace scenegen::render
