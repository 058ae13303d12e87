#include "render/image_file.h"

#include <bit>
#include <cstring>
#include <new>
#include <vector>

#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace scenegen::render {
namespace {

void append(void* out, void* bytes, int size) {
  static_cast<std::string*>(out)->append(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
}

/// The picture is opaque; three channels are a quarter smaller.
std::vector<std::uint8_t> without_alpha(std::span<const std::uint8_t> rgba) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i < rgba.size(); i += 4) rgb.insert(rgb.end(), &rgba[i], &rgba[i] + 3);
  return rgb;
}

/// stb gives 0 only when it gets no memory.
void check(int written) {
  if (written == 0) throw std::bad_alloc();
}

}  // namespace

std::string_view extension(PictureFormat format) {
  switch (format) {
    case PictureFormat::jpg:
      return "jpg";
    case PictureFormat::bmp:
      return "bmp";
    default:
      return "png";
  }
}

std::string encode_picture(PictureFormat format, glm::uvec2 size, std::span<const std::uint8_t> rgba) {
  std::string out;
  const int w = static_cast<int>(size.x);
  const int h = static_cast<int>(size.y);
  switch (format) {
    case PictureFormat::png:
      check(stbi_write_png_to_func(append, &out, w, h, 3, without_alpha(rgba).data(), 3 * w));
      break;
    case PictureFormat::jpg:
      check(stbi_write_jpg_to_func(append, &out, w, h, 4, rgba.data(), 95));
      break;
    case PictureFormat::bmp:
      check(stbi_write_bmp_to_func(append, &out, w, h, 3, without_alpha(rgba).data()));
      break;
  }
  return out;
}

std::string encode_ids(glm::uvec2 size, std::span<const std::uint32_t> ids) {
  std::vector<std::uint8_t> rgba;
  rgba.reserve(ids.size() * 4);
  for (const std::uint32_t id : ids) {
    for (unsigned shift = 0; shift < 32; shift += 8) rgba.push_back(static_cast<std::uint8_t>(id >> shift));
  }
  std::string out;
  check(stbi_write_png_to_func(append, &out, static_cast<int>(size.x), static_cast<int>(size.y), 4,
                               rgba.data(), static_cast<int>(4 * size.x)));
  return out;
}

std::string encode_pfm(glm::uvec2 size, std::span<const float> values) {
  static_assert(std::endian::native == std::endian::little);
  std::string out = "Pf\n" + std::to_string(size.x) + " " + std::to_string(size.y) + "\n-1.0\n";
  for (std::uint32_t y = size.y; y-- > 0;)
    out.append(reinterpret_cast<const char*>(&values[std::size_t{y} * size.x]), sizeof(float) * size.x);
  return out;
}

}  // namespace scenegen::render
