// Textures that lie in the model or beside it. Private to scene/import.
#pragma once

#include <optional>

#include "scene/import/convert.h"

namespace scenegen::import {

/// The image that `path` of a material names: "*0" is embedded, others are files at or below the model's
/// folder. PNG and JPEG pass as they are, other formats become PNG; none with a note when there is nothing to
/// be had.
[[nodiscard]] std::optional<std::size_t> add_image(Conversion& c, const aiString& path);

}  // namespace scenegen::import
