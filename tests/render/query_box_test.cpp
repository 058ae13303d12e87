// Boxes of occlusion queries: what is inside covers no pixel that the grown box does not cover nearer.
#include "render/spatial/query_box.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "scene/random.h"

using namespace scenegen;
using namespace scenegen::render;

namespace {

constexpr glm::uvec2 kSize{320, 180};

std::vector<glm::vec3> corners(const Box& b) {
  std::vector<glm::vec3> out;
  for (const float x : {b.lo.x, b.hi.x})
    for (const float y : {b.lo.y, b.hi.y})
      for (const float z : {b.lo.z, b.hi.z}) out.emplace_back(x, y, z);
  return out;
}

/// Rectangle in pixels and the nearest depth of a box wholly in front of the near plane.
struct OnScreen {
  glm::vec2 lo{1e30F}, hi{-1e30F};
  float nearest = 0;
};
OnScreen on_screen(const View& view, const Box& box) {
  OnScreen out;
  for (const glm::vec3& p : corners(box)) {
    const glm::vec4 clip = view.clip_from_world * glm::vec4(p, 1.0F);
    REQUIRE(clip.w > 0.0F);
    const glm::vec2 pixel = (0.5F + 0.5F * glm::vec2(clip) / clip.w) * glm::vec2(kSize);
    out.lo = glm::min(out.lo, pixel);
    out.hi = glm::max(out.hi, pixel);
    out.nearest = std::max(out.nearest, clip.z / clip.w);
  }
  return out;
}

}  // namespace

TEST_CASE("a grown box is at least a pixel larger on every side, and nearer") {
  const Random random(3, "query boxes");
  for (const bool flat : {false, true}) {
    Lens lens;
    lens.yfov_rad = 0.9F;
    lens.orthographic = flat;
    lens.xmag_m = 32;
    lens.ymag_m = 18;
    lens.far_m = flat ? 500.0F : 0.0F;
    const View view = make_view(look_at({10, 5, 40}, {-5, 2, 0}), lens, 16.0F / 9);
    const QueryBoxes boxes(view, kSize);
    int checked = 0;
    for (std::uint64_t i = 0; i < 3000; ++i) {
      const auto unit = [&](std::uint64_t k) { return random.unit(8 * i + k); };
      const glm::vec3 at = glm::vec3(unit(0), unit(1), unit(2)) * 80.0F - 50.0F;
      const Box box{at, at + glm::vec3(unit(3), unit(4), unit(5)) * (i % 3 == 0 ? 0.01F : 6.0F)};
      const Box grown = boxes.grown(box);
      if (boxes.touches_eye(grown)) continue;
      const auto c = corners(grown);
      if (std::any_of(c.begin(), c.end(),
                      [&](const glm::vec3& p) { return glm::dot(p - view.eye_m(), view.forward()) < 1.0F; }))
        continue;
      ++checked;
      const OnScreen inner = on_screen(view, box);
      const OnScreen outer = on_screen(view, grown);
      REQUIRE(outer.nearest > inner.nearest);
      // Seen along a diagonal a box grows by more than a pixel, seen along an axis by one; 1 % for rounding.
      for (int a = 0; a < 2; ++a) {
        REQUIRE(outer.lo[a] <= inner.lo[a] - 0.99F);
        REQUIRE(outer.hi[a] >= inner.hi[a] + 0.99F);
      }
      // And not by much, where it is seen.
      const bool seen = inner.lo.x > 0 && inner.lo.y > 0 && inner.hi.x < 320 && inner.hi.y < 180;
      if (seen && i % 3 == 0) REQUIRE(outer.hi.x - outer.lo.x < inner.hi.x - inner.lo.x + 8.0F);
    }
    CHECK(checked > 500);
  }
}

TEST_CASE("a box at the eye or at the near plane's corners cannot be asked about") {
  Lens lens;
  lens.near_m = 0.5F;
  lens.yfov_rad = 1.0F;
  const View view = make_view(look_at({0, 0, 0}, {0, 0, -1}), lens, 2.0F);
  const QueryBoxes boxes(view, kSize);
  CHECK(boxes.touches_eye(Box{glm::vec3(-1), glm::vec3(1)}));
  CHECK(boxes.touches_eye(Box{{-0.1F, -0.1F, -3}, {0.1F, 0.1F, -0.49F}}));  // cut open by the near plane
  CHECK(boxes.touches_eye(Box{{0.5F, 0.2F, -3}, {2, 2, -0.4F}}));           // only at its corner
  CHECK_FALSE(boxes.touches_eye(Box{{-1, -1, -3}, {1, 1, -0.6F}}));
  CHECK_FALSE(boxes.touches_eye(Box{{3, -1, -3}, {4, 1, 3}}));
}
