#include "gen/textures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "gen/primitives.h"
#include "scene/random.h"

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace scenegen::gen {
namespace {

constexpr int kAtlasWidth = 512, kAtlasHeight = 256;
constexpr std::uint64_t kTextureSeed = 1;  // the look of a brick does not change with the scene's seed

void append_bytes(void* context, void* data, int size) {
  auto& out = *static_cast<std::vector<std::uint8_t>*>(context);
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  out.insert(out.end(), bytes, bytes + size);
}

Image png(const char* name, const std::vector<std::uint8_t>& rgb, int width, int height) {
  Image image{name, "image/png", {}};
  stbi_write_png_to_func(append_bytes, &image.bytes, width, height, 3, rgb.data(), width * 3);
  return image;
}

std::uint8_t byte_of(double v) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(v), 0L, 255L));
}

/// Value noise in [0, 1] with `cells` lattice cells over `size` pixels, repeating.
double value_noise(const Random& random, int x, int y, int size, int cells) {
  const double fx = static_cast<double>(x) * cells / size, fy = static_cast<double>(y) * cells / size;
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
  const double tx = smooth(fx - ix), ty = smooth(fy - iy);
  const auto at = [&](int i, int j) {
    return static_cast<double>(
        random.unit(static_cast<std::uint64_t>((j % cells) * 4096 + i % cells + cells * 16'777'216LL)));
  };
  const double top = at(ix, iy) * (1 - tx) + at(ix + 1, iy) * tx;
  const double bottom = at(ix, iy + 1) * (1 - tx) + at(ix + 1, iy + 1) * tx;
  return top * (1 - ty) + bottom * ty;
}

/// One face of a brick in the atlas: pixels, and the size of what they show.
struct FacePixels {
  int x0, y0, width, height;
  double width_mm, height_mm;
};

FacePixels face_pixels(const AtlasRegion& region, double width_mm, double height_mm) {
  const auto px = [](float v, int size) { return static_cast<int>(v * static_cast<float>(size)); };
  FacePixels f{px(region.lo.x, kAtlasWidth), px(region.lo.y, kAtlasHeight), 0, 0, width_mm, height_mm};
  f.width = px(region.hi.x, kAtlasWidth) - f.x0;
  f.height = px(region.hi.y, kAtlasHeight) - f.y0;
  return f;
}

/// Height of the surface in [0, 1]: 0 in the mortar, 1 on the brick, with a rounded arris of `arris_mm`.
double surface(const FacePixels& f, int x, int y, double joint_mm, double arris_mm, const Random& random) {
  const double u = (x + 0.5) * f.width_mm / f.width, v = (y + 0.5) * f.height_mm / f.height;
  // The joint wavers a little, as laid by hand.
  const double waver = 0.5 + value_noise(random, f.x0 + x, f.y0 + y, kAtlasWidth, 64);
  const double inside = std::min({u, f.width_mm - u, v, f.height_mm - v}) - joint_mm * waver;
  return std::clamp(inside / arris_mm + 0.5, 0.0, 1.0);
}

}  // namespace

BrickImages brick_images(const glm::ivec3& size_mm) {
  const Random random(kTextureSeed, "brick texture");
  const double length = size_mm.x, width = size_mm.y, height = size_mm.z;
  const double joint_mm = std::min({0.035 * height, 0.1 * width, 7.0});
  const double arris_mm = joint_mm;
  std::vector<double> relief(std::size_t{kAtlasWidth} * kAtlasHeight, 0.0);
  std::vector<std::uint8_t> color(relief.size() * 3, 150), normal(relief.size() * 3);
  // The materials tint all of it red; the mortar is bluish here so that it comes out grey.
  const glm::dvec3 brick(206, 138, 108), mortar(214, 242, 244);

  for (const FacePixels& f : {face_pixels(kLongSide, length, height), face_pixels(kEnd, width, height),
                              face_pixels(kBed, length, width)}) {
    for (int y = 0; y < f.height; ++y) {
      for (int x = 0; x < f.width; ++x) {
        const int ax = f.x0 + x, ay = f.y0 + y;
        const std::size_t at = static_cast<std::size_t>(ay) * kAtlasWidth + ax;
        const double high = surface(f, x, y, joint_mm, arris_mm, random);
        const double cloud = value_noise(random, ax, ay, kAtlasWidth, 32);
        const double grain = value_noise(random, ax, ay, kAtlasWidth, 128);
        // Sixteen levels of grain: it need not cost a byte a pixel in the PNG.
        const double shade = std::floor(16 * (0.6 * cloud + 0.4 * grain)) / 16;
        relief[at] = high * (0.85 + 0.15 * grain);
        const glm::dvec3 c = glm::mix(mortar * (0.9 + 0.1 * shade), brick * (0.78 + 0.4 * shade), high);
        for (int k = 0; k < 3; ++k) color[at * 3 + k] = byte_of(c[k]);
      }
    }
  }
  for (int y = 0; y < kAtlasHeight; ++y) {
    for (int x = 0; x < kAtlasWidth; ++x) {
      const auto at = [&](int i, int j) {
        return relief[static_cast<std::size_t>(std::clamp(j, 0, kAtlasHeight - 1)) * kAtlasWidth +
                      std::clamp(i, 0, kAtlasWidth - 1)];
      };
      const glm::dvec3 n =
          glm::normalize(glm::dvec3(at(x - 1, y) - at(x + 1, y), at(x, y + 1) - at(x, y - 1), 1.4));
      for (int k = 0; k < 3; ++k) {
        // 32 levels are enough for so small a relief.
        const double level = std::floor((n[k] * 0.5 + 0.5) * 32 + 0.5) / 32;
        normal[(static_cast<std::size_t>(y) * kAtlasWidth + x) * 3 + k] = byte_of(level * 255);
      }
    }
  }
  return {png("brick_color", color, kAtlasWidth, kAtlasHeight),
          png("brick_normal", normal, kAtlasWidth, kAtlasHeight)};
}

Image noise_image() {
  constexpr int kSize = 128;
  const Random random(kTextureSeed, "ground texture");
  std::vector<std::uint8_t> rgb(std::size_t{kSize} * kSize * 3);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double v = 0.4 * value_noise(random, x, y, kSize, 8) +
                       0.3 * value_noise(random, x, y, kSize, 32) +
                       0.3 * value_noise(random, x, y, kSize, 64);
      const double level = std::floor(24 * v) / 24;
      for (std::size_t k = 0; k < 3; ++k)
        rgb[(static_cast<std::size_t>(y) * kSize + x) * 3 + k] = byte_of(175 + 80 * level);
    }
  }
  return png("noise", rgb, kSize, kSize);
}

}  // namespace scenegen::gen
