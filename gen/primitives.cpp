#include "gen/primitives.h"

#include <array>

namespace scenegen::gen {
namespace {

struct Face {
  glm::vec3 normal, right;
  AtlasRegion region;
};

const std::array<Face, 6>& faces() {
  static const std::array<Face, 6> all{{
      {{1, 0, 0}, {0, 0, -1}, kEnd},
      {{-1, 0, 0}, {0, 0, 1}, kEnd},
      {{0, 1, 0}, {1, 0, 0}, kBed},
      {{0, -1, 0}, {1, 0, 0}, kBed},
      {{0, 0, 1}, {1, 0, 0}, kLongSide},
      {{0, 0, -1}, {-1, 0, 0}, kLongSide},
  }};
  return all;
}

/// Corner k of a face, counter-clockwise from the lower left one as seen from outside.
void add_corner(Geometry& g, const Face& face, int k, const AtlasRegion& region) {
  const bool right = k == 1 || k == 2;
  const bool upper = k >= 2;
  const glm::vec3 up = glm::cross(face.normal, face.right);
  g.positions_m.push_back(0.5F * (face.normal + (right ? face.right : -face.right) + (upper ? up : -up)));
  g.normals.push_back(face.normal);
  g.tangents.emplace_back(face.right, 1.0F);
  g.texcoords[0].emplace_back(right ? region.hi.x : region.lo.x, upper ? region.lo.y : region.hi.y);
}

}  // namespace

Geometry unit_box() {
  Geometry g;
  for (const Face& face : faces()) {
    const auto first = static_cast<std::uint32_t>(g.positions_m.size());
    for (int k = 0; k < 4; ++k) add_corner(g, face, k, face.region);
    for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) g.indices.push_back(first + k);
  }
  return g;
}

Geometry unit_box_unindexed(bool whole_faces) {
  Geometry g;
  for (const Face& face : faces()) {
    const AtlasRegion region = whole_faces ? AtlasRegion{{0, 0}, {1, 1}} : face.region;
    for (const int k : {0, 1, 2, 0, 2, 3}) add_corner(g, face, k, region);
  }
  return g;
}

Geometry tiled_unit_box(const glm::dvec3& size_m, double repeat_m) {
  Geometry g = unit_box();
  const glm::dvec3 repeats = size_m / repeat_m;
  for (std::size_t i = 0; i < g.positions_m.size(); ++i) {
    const glm::dvec3 right(g.tangents[i]);
    const glm::dvec3 up = glm::cross(glm::dvec3(g.normals[i]), right);
    const glm::dvec3 at = glm::dvec3(g.positions_m[i]) * repeats;
    g.texcoords[0][i] = glm::vec2(glm::dvec2(glm::dot(at, right), -glm::dot(at, up)));
  }
  return g;
}

SineCosine of_turn(std::uint64_t k, std::uint64_t n) {
  // Eighths of a turn exactly, then at most pi/4 by the series.
  k %= n;
  const std::uint64_t quarter = (4 * k + n / 2) / n;  // nearest quarter turn
  const double rest =
      (4.0 * static_cast<double>(k) - static_cast<double>(quarter * n)) / static_cast<double>(n);
  const double x = rest * 1.57079632679489661923;  // in [-pi/4, pi/4]
  const double x2 = x * x;
  double sine = 1, cosine = 1;
  for (int i = 9; i >= 1; --i) {
    sine = 1.0 - x2 / (2.0 * i * (2.0 * i + 1.0)) * sine;
    cosine = 1.0 - x2 / (2.0 * i * (2.0 * i - 1.0)) * cosine;
  }
  sine *= x;
  switch (quarter % 4) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

Geometry uv_sphere(std::uint32_t slices, std::uint32_t stacks) {
  std::vector<SineCosine> around(slices + 1), down(stacks + 1);
  for (std::uint32_t i = 0; i <= slices; ++i) around[i] = of_turn(i, slices);
  for (std::uint32_t j = 0; j <= stacks; ++j) down[j] = of_turn(j, 2ULL * stacks);
  down[stacks] = {0, -1};

  Geometry g;
  const std::size_t count = 6ULL * slices * (stacks - 1);
  g.positions_m.reserve(count);
  g.normals.reserve(count);
  g.texcoords[0].reserve(count);
  const auto add = [&](std::uint32_t i, std::uint32_t j) {
    const glm::vec3 n(
        glm::dvec3(down[j].sine * around[i].cosine, down[j].cosine, -down[j].sine * around[i].sine));
    g.positions_m.push_back(0.5F * n);
    g.normals.push_back(n);
    g.texcoords[0].emplace_back(static_cast<float>(i) / static_cast<float>(slices),
                                static_cast<float>(j) / static_cast<float>(stacks));
  };
  for (std::uint32_t j = 0; j < stacks; ++j) {
    for (std::uint32_t i = 0; i < slices; ++i) {
      if (j + 1 < stacks) add(i, j), add(i, j + 1), add(i + 1, j + 1);
      if (j > 0) add(i, j), add(i + 1, j + 1), add(i + 1, j);
    }
  }
  return g;
}

}  // namespace scenegen::gen
