// What to draw and to ask in a pass.
#pragma once

#include <cstdint>
#include <vector>

#include "render/passes/occlusion.h"

namespace scenegen::render {

struct QueryPlan {
  std::vector<std::uint32_t> first;   ///< chunks to draw whatever the answers are
  std::vector<std::uint32_t> second;  ///< chunks believed hidden, each governed by one of `asked`
  std::vector<Asked> asked;
  std::vector<Governed> governed;  ///< as `second`, with the query
  void clear() {
    first.clear();
    second.clear();
    asked.clear();
    governed.clear();
  }
};

}  // namespace scenegen::render
