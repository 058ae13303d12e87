// The strategies there are, by name, without what is behind them.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace scenegen::render {

/// {"brute", "brute"}, …: for a command line option.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> strategy_choices();

}  // namespace scenegen::render
