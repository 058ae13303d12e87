// Boxes over a picture.
#include "render/node_overlay.h"

#include <catch2/catch.hpp>
#include <map>

using namespace scenegen;
using namespace scenegen::render;

namespace {

constexpr glm::uvec2 kSize{200, 200};

View view_at(const glm::vec3& eye, const glm::vec3& target) {
  Lens lens;
  lens.yfov_rad = 1.5707963F;  // 100 pixels are the distance
  return make_view(look_at(eye, target), lens, 1.0F);
}

/// Where pixels are not black, by colour: 'r', 'g', 'w'.
std::map<char, std::size_t> colors(const std::vector<std::uint8_t>& rgba) {
  std::map<char, std::size_t> out;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    if (rgba[i] + rgba[i + 1] + rgba[i + 2] == 0) continue;
    ++out[rgba[i] > 2 * rgba[i + 1] ? 'r' : rgba[i + 1] > 2 * rgba[i] ? 'g' : 'w'];
  }
  return out;
}

}  // namespace

TEST_CASE("edges of a box stand where its corners are seen") {
  std::vector<std::uint8_t> rgba(4 * 200 * 200, 0);
  // The front face is 10 m away and 10 m wide: 100 pixels, from 50 to 150.
  const ChunkBox box{{{-5, -5, -30}, {5, 5, -10}}, ChunkVerdict::hidden};
  draw_chunk_boxes(std::array{box}, view_at({0, 0, 0}, {0, 0, -1}), kSize, rgba);
  const auto lit = [&](std::size_t x, std::size_t y) { return rgba[4 * (y * 200 + x)] > 0; };
  for (const std::size_t at : {60U, 100U, 140U}) {
    CHECK((lit(at, 49) || lit(at, 50)));
    CHECK((lit(at, 149) || lit(at, 150)));
    CHECK((lit(49, at) || lit(50, at)));
    CHECK((lit(149, at) || lit(150, at)));
    CHECK_FALSE(lit(at, 20));
  }
  CHECK(lit(75, 75));  // an edge that runs away from the eye
  CHECK(colors(rgba).size() == 1);
  CHECK(colors(rgba)['r'] > 400);
}

TEST_CASE(
    "colours tell verdicts apart; what is behind the eye is not drawn, what crosses the near plane is cut") {
  const auto draw = [](const ChunkBox& box) {
    std::vector<std::uint8_t> rgba(4 * 200 * 200, 0);
    draw_chunk_boxes(std::array{box}, view_at({0, 0, 0}, {0, 0, -1}), kSize, rgba);
    return colors(rgba);
  };
  const Box ahead{{-5, -5, -30}, {5, 5, -10}};
  CHECK(draw({ahead, ChunkVerdict::visible})['g'] > 400);
  CHECK(draw({ahead, ChunkVerdict::not_asked})['w'] > 400);
  CHECK(draw({{{-5, -5, 10}, {5, 5, 30}}, ChunkVerdict::hidden}).empty());
  CHECK(draw({{}, ChunkVerdict::hidden}).empty());
  const std::size_t across = draw({{{-5, -5, -30}, {5, 5, 30}}, ChunkVerdict::hidden})['r'];
  CHECK(across > 100);
  CHECK(across < 1000);
}
