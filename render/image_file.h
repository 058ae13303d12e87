// Pictures as files: encoded in memory, so that a file is written whole or not at all.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>

#include "scene/result.h"

namespace scenegen::render {

enum class PictureFormat : std::uint8_t { png, jpg, bmp };
[[nodiscard]] std::string_view extension(PictureFormat format);

/// RGBA8 (rows from the top) as PNG, or as JPEG (quality 95) or BMP without alpha.
[[nodiscard]] std::string encode_picture(PictureFormat format, glm::uvec2 size,
                                         std::span<const std::uint8_t> rgba);
/// 32-bit numbers as RGBA PNG, number = R + 2^8 G + 2^16 B + 2^24 A.
[[nodiscard]] std::string encode_ids(glm::uvec2 size, std::span<const std::uint32_t> ids);
/// Portable float map, one channel, little-endian; its rows run from the bottom.
[[nodiscard]] std::string encode_pfm(glm::uvec2 size, std::span<const float> values);

}  // namespace scenegen::render
