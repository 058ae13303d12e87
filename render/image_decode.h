// Encoded image -> RGBA8, bounded.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "scene/result.h"

namespace scenegen::render {

struct DecodedImage {
  std::uint32_t width = 1, height = 1;
  std::vector<std::uint8_t> rgba{255, 255, 255, 255};  ///< rows from the top
};

/// PNG, JPEG and what else stb_image reads. Sides above limits::kMaxImageSide and more than `most_texels` are
/// an error, found before anything is allocated.
[[nodiscard]] Result<DecodedImage> decode_image(
    std::span<const std::uint8_t> bytes, const std::string& where,
    std::uint64_t most_texels = std::numeric_limits<std::uint64_t>::max());

/// Half the size, by averaging 2 x 2 texels of encoded values: for images above a device's limit.
[[nodiscard]] DecodedImage halved(const DecodedImage& image);

}  // namespace scenegen::render
