#include "render/node_overlay.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace scenegen::render {
namespace {

using Color = std::array<std::uint8_t, 3>;

struct Canvas {
  glm::uvec2 size;
  std::span<std::uint8_t> rgba;

  void blend(glm::ivec2 at, const Color& color) {
    if (at.x < 0 || at.y < 0 || at.x >= static_cast<int>(size.x) || at.y >= static_cast<int>(size.y)) return;
    const std::size_t first = 4 * (static_cast<std::size_t>(at.y) * size.x + static_cast<std::size_t>(at.x));
    for (std::size_t i = 0; i < 3; ++i)
      rgba[first + i] = static_cast<std::uint8_t>((2 * rgba[first + i] + 3 * color[i]) / 5);
  }

  /// Between two points in pixels, cut to the picture.
  void line(glm::vec2 a, glm::vec2 b, const Color& color) {
    float from = 0.0F;
    float to = 1.0F;
    const glm::vec2 along = b - a;
    for (int axis = 0; axis < 2; ++axis) {
      const auto end = static_cast<float>(size[axis]);
      if (along[axis] == 0.0F) {
        if (a[axis] < 0.0F || a[axis] > end) return;
        continue;
      }
      const float first = -a[axis] / along[axis];
      const float last = (end - a[axis]) / along[axis];
      from = std::max(from, std::min(first, last));
      to = std::min(to, std::max(first, last));
    }
    if (from > to) return;
    const glm::vec2 begin = a + from * along;
    const glm::vec2 rest = (to - from) * along;
    const int steps = std::max(1, static_cast<int>(std::ceil(std::max(std::abs(rest.x), std::abs(rest.y)))));
    for (int i = 0; i <= steps; ++i) {
      const glm::vec2 at = begin + rest * (static_cast<float>(i) / static_cast<float>(steps));
      blend(glm::ivec2(glm::floor(at)), color);
    }
  }
};

glm::vec4 corner(const Box& box, unsigned bits, const glm::mat4& clip_from_world) {
  return clip_from_world * glm::vec4((bits & 1U) != 0 ? box.hi.x : box.lo.x,
                                     (bits & 2U) != 0 ? box.hi.y : box.lo.y,
                                     (bits & 4U) != 0 ? box.hi.z : box.lo.z, 1.0F);
}

void draw_edge(glm::vec4 a, glm::vec4 b, const Color& color, Canvas& canvas) {
  // Depth is reversed: the near plane is z = w, and what is nearer has z > w.
  const float da = a.w - a.z;
  const float db = b.w - b.z;
  if (da < 0.0F && db < 0.0F) return;
  if (da < 0.0F) a += (b - a) * (da / (da - db));
  if (db < 0.0F) b += (a - b) * (db / (db - da));
  if (!(a.w > 0.0F) || !(b.w > 0.0F)) return;
  const auto pixel = [&](const glm::vec4& p) {
    return (glm::vec2(p.x, p.y) / p.w * 0.5F + 0.5F) * glm::vec2(canvas.size);
  };
  canvas.line(pixel(a), pixel(b), color);
}

}  // namespace

void draw_chunk_boxes(std::span<const ChunkBox> boxes, const View& view, glm::uvec2 size,
                      std::span<std::uint8_t> rgba) {
  assert(rgba.size() == std::size_t{4} * size.x * size.y);
  constexpr std::array<Color, 3> kColors{Color{150, 150, 150}, Color{40, 200, 60}, Color{225, 35, 35}};
  Canvas canvas{size, rgba};
  for (const ChunkVerdict verdict : {ChunkVerdict::not_asked, ChunkVerdict::visible, ChunkVerdict::hidden}) {
    for (const ChunkBox& chunk : boxes) {
      if (chunk.verdict != verdict || chunk.box_m.empty()) continue;
      for (unsigned bits = 0; bits < 8; ++bits) {
        for (const unsigned axis : {1U, 2U, 4U}) {
          if ((bits & axis) != 0) continue;
          draw_edge(corner(chunk.box_m, bits, view.clip_from_world),
                    corner(chunk.box_m, bits | axis, view.clip_from_world),
                    kColors[static_cast<std::size_t>(verdict)], canvas);
        }
      }
    }
  }
}

}  // namespace scenegen::render
