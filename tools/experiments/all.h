// The experiments' functions, for the registry and for tests.
#pragma once

#include "tools/experiments/experiment.h"

namespace scenegen::tools {

[[nodiscard]] Result<DocumentSection> adaptive_animation(const ExperimentContext& context);
[[nodiscard]] Result<DocumentSection> octree_or_bvh(const ExperimentContext& context);

}  // namespace scenegen::tools
