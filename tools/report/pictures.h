// Pictures inside a page.
#pragma once

#include <cstdint>
#include <string>

#include "scene/result.h"

namespace scenegen::tools {

struct EmbeddedPicture {
  std::string data_uri;
  std::uint32_t width = 0, height = 0;
};
/// A PNG or JPEG below `folder`, as it is when it is small; a large one is halved until no side is above 1600
/// pixels and written as JPEG, so that a page stays below a few MB. Errors: no such file, no picture, above
/// 64 MiB or 64 million pixels, outside of the folder (a symbolic link).
[[nodiscard]] Result<EmbeddedPicture> embed_picture(const std::string& folder, const std::string& file);

}  // namespace scenegen::tools
