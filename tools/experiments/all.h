// The experiments' functions, for the registry and for tests.
#pragma once

#include "tools/experiments/experiment.h"

namespace scenegen::tools {

[[nodiscard]] Result<DocumentSection> adaptive_animation(const ExperimentContext& context);
[[nodiscard]] Result<DocumentSection> invisible_objects(const ExperimentContext& context);
[[nodiscard]] Result<DocumentSection> merged_batch(const ExperimentContext& context);
[[nodiscard]] Result<DocumentSection> model_accuracy(const ExperimentContext& context);
[[nodiscard]] Result<DocumentSection> octree_or_bvh(const ExperimentContext& context);
[[nodiscard]] Result<DocumentSection> recording(const ExperimentContext& context);

}  // namespace scenegen::tools
