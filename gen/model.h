// Model files that stand in for buildings and extra objects.
#pragma once

#include <string>
#include <vector>

#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::gen {

/// A model file as a static scene with at least one box to show. Timelines are left out, with a note.
[[nodiscard]] Result<Scene> read_model(const std::string& path, const char* option,
                                       std::vector<std::string>& notes);

/// Box round all objects at rest.
[[nodiscard]] Box model_bounds(const Scene& scene);

}  // namespace scenegen::gen
