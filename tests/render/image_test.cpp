#include <catch2/catch.hpp>
#include <cstring>

#include "render/image_decode.h"
#include "render/image_file.h"

using namespace scenegen;
using namespace scenegen::render;

namespace {

std::vector<std::uint8_t> gradient(glm::uvec2 size) {
  std::vector<std::uint8_t> out;
  for (std::uint32_t y = 0; y < size.y; ++y)
    for (std::uint32_t x = 0; x < size.x; ++x)
      for (const std::uint32_t v : {10 * x, 20 * y, x + y, 255U}) out.push_back(static_cast<std::uint8_t>(v));
  return out;
}

std::span<const std::uint8_t> bytes_of(const std::string& s) {
  return {reinterpret_cast<const std::uint8_t*>(s.data()), s.size()};
}

}  // namespace

TEST_CASE("PNG and BMP come back exactly, JPEG nearly") {
  const glm::uvec2 size(13, 7);
  const auto rgba = gradient(size);
  for (const PictureFormat format : {PictureFormat::png, PictureFormat::bmp, PictureFormat::jpg}) {
    const auto decoded = decode_image(bytes_of(encode_picture(format, size, rgba)), "x");
    REQUIRE(decoded);
    CHECK(decoded->width == 13);
    CHECK(decoded->height == 7);
    int worst = 0;
    for (std::size_t i = 0; i < rgba.size(); ++i)
      worst = std::max(worst, std::abs(int{rgba[i]} - int{decoded->rgba[i]}));
    CHECK(worst <= (format == PictureFormat::jpg ? 24 : 0));
  }
}

TEST_CASE("ids survive as RGBA") {
  const std::vector<std::uint32_t> ids{0, 1, 0x01020304, 0xFFFFFFFF, 0x00FF0000, 0x7F000001};
  const auto decoded = decode_image(bytes_of(encode_ids({3, 2}, ids)), "x");
  REQUIRE(decoded);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::uint8_t* p = &decoded->rgba[4 * i];
    CHECK(p[0] + 256U * p[1] + 65536U * p[2] + 16777216U * p[3] == ids[i]);
  }
}

TEST_CASE("a float map is little-endian and runs from the bottom row") {
  const std::vector<float> values{1, 2, 3, 4, 5, 6};
  const std::string pfm = encode_pfm({3, 2}, values);
  REQUIRE(pfm.starts_with("Pf\n3 2\n-1.0\n"));
  std::array<float, 6> raw{};
  std::memcpy(raw.data(), pfm.data() + pfm.size() - sizeof(raw), sizeof(raw));
  CHECK(raw == std::array<float, 6>{4, 5, 6, 1, 2, 3});
}

TEST_CASE("broken and oversized images are refused before they cost anything") {
  CHECK_FALSE(decode_image({}, "x"));
  const std::string junk = "no image at all";
  CHECK_FALSE(decode_image(bytes_of(junk), "x"));
  const glm::uvec2 size(13, 7);
  std::string png = encode_picture(PictureFormat::png, size, gradient(size));
  CHECK_FALSE(decode_image(bytes_of(png.substr(0, 50)), "x"));
  png[18] = 0x01;  // width 65549
  const std::string three = encode_picture(PictureFormat::png, {3, 1}, std::vector<std::uint8_t>(12, 255));
  CHECK(decode_image(bytes_of(three), "x", 3));
  CHECK_FALSE(decode_image(bytes_of(three), "x", 2));
  const auto huge = decode_image(bytes_of(png), "x");
  REQUIRE_FALSE(huge);
  CHECK(huge.error().where == "x");
}

TEST_CASE("halving averages and never falls below one texel") {
  DecodedImage image;
  image.width = 4;
  image.height = 1;
  image.rgba = {0, 0, 0, 255, 100, 0, 0, 255, 200, 0, 0, 255, 40, 0, 0, 255};
  const DecodedImage half = halved(image);
  CHECK(half.width == 2);
  CHECK(half.height == 1);
  CHECK(half.rgba == std::vector<std::uint8_t>{50, 0, 0, 255, 120, 0, 0, 255});
}
