#include "render/image_decode.h"

#include <algorithm>
#include <memory>

#include "scene/limits.h"

#define STBI_FAILURE_USERMSG
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace scenegen::render {

Result<DecodedImage> decode_image(std::span<const std::uint8_t> bytes, const std::string& where,
                                  std::uint64_t most_texels) {
  constexpr std::size_t kMostBytes = 0x7FFFFFFF;
  if (bytes.empty() || bytes.size() > kMostBytes)
    return fail(ErrorKind::bad_input, where, "no image of a size that can be decoded");
  const int size = static_cast<int>(bytes.size());
  int width = 0;
  int height = 0;
  int channels = 0;
  if (stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) == 0)
    return fail(ErrorKind::bad_input, where, std::string("cannot be decoded: ") + stbi_failure_reason());
  constexpr auto kMost = static_cast<int>(limits::kMaxImageSide);
  if (width <= 0 || height <= 0 || width > kMost || height > kMost)
    return fail(ErrorKind::bad_input, where,
                std::to_string(width) + "x" + std::to_string(height) + " texels; at most " +
                    std::to_string(kMost) + " a side");
  if (static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) > most_texels)
    return fail(ErrorKind::bad_input, where,
                std::to_string(width) + "x" + std::to_string(height) + " texels; at most " +
                    std::to_string(most_texels) + " in all");
  const std::unique_ptr<stbi_uc, void (*)(void*)> texels(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 4), stbi_image_free);
  if (!texels)
    return fail(ErrorKind::bad_input, where, std::string("cannot be decoded: ") + stbi_failure_reason());
  DecodedImage out;
  out.width = static_cast<std::uint32_t>(width);
  out.height = static_cast<std::uint32_t>(height);
  out.rgba.assign(texels.get(), texels.get() + std::size_t{4} * out.width * out.height);
  return out;
}

DecodedImage halved(const DecodedImage& image) {
  DecodedImage out;
  out.width = std::max(1U, image.width / 2);
  out.height = std::max(1U, image.height / 2);
  out.rgba.resize(std::size_t{4} * out.width * out.height);
  for (std::uint32_t y = 0; y < out.height; ++y) {
    for (std::uint32_t x = 0; x < out.width; ++x) {
      for (std::uint32_t c = 0; c < 4; ++c) {
        unsigned sum = 0;
        for (std::uint32_t k = 0; k < 4; ++k) {
          const std::uint32_t sx = std::min(2 * x + k % 2, image.width - 1);
          const std::uint32_t sy = std::min(2 * y + k / 2, image.height - 1);
          sum += image.rgba[4 * (std::size_t{sy} * image.width + sx) + c];
        }
        out.rgba[4 * (std::size_t{y} * out.width + x) + c] = static_cast<std::uint8_t>((sum + 2) / 4);
      }
    }
  }
  return out;
}

}  // namespace scenegen::render
