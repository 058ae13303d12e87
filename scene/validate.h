// The numbered rules that every scene obeys; docs/FORMAT.md lists them. Readers and generators end with a
// check.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace scenegen {

struct Finding {
  int rule = 0;       ///< number of the rule in docs/FORMAT.md
  std::string where;  ///< "objects[17] building_01_01/floor_0/brick_0003"
  std::string what;
};

/// Checks every rule; at most `most` findings. Never crashes on any content of `scene`.
[[nodiscard]] std::vector<Finding> validate(const Scene& scene, std::size_t most = 20);

}  // namespace scenegen
