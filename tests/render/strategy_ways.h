// How paths are drawn by a strategy: what tests of strategies have in common.
#pragma once

#include <string>

#include "render/strategy/strategy.h"
#include "tests/render/strategy_paths.h"

namespace scenegen::render::test {

[[nodiscard]] RendererOptions path_options(const std::string& strategy);

/// A strategy, with one of the forms in which chunks are kept.
struct Way {
  std::string strategy;
  NodeForm form = NodeForm::secondaries;
  [[nodiscard]] bool asks() const { return strategy.starts_with("queries"); }
  [[nodiscard]] std::string name() const;
  [[nodiscard]] RendererOptions options() const;
};

}  // namespace scenegen::render::test
