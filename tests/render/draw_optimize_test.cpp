#include "render/draw_optimize.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstring>
#include <vector>

#include "gen/primitives.h"

using namespace scenegen;
using namespace scenegen::render;

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes vertex_bytes(const DrawGeometry& g, std::uint32_t v) {
  Bytes out(sizeof(glm::vec3) + sizeof(VertexAttributes));
  std::memcpy(out.data(), &g.positions_m[v], sizeof(glm::vec3));
  std::memcpy(out.data() + sizeof(glm::vec3), &g.attributes[v], sizeof(VertexAttributes));
  return out;
}

/// What is drawn: the vertices of each triangle, beginning with the least of them.
std::vector<std::array<Bytes, 3>> triangles(const DrawGeometry& g) {
  std::vector<std::array<Bytes, 3>> out;
  for (std::size_t i = 0; i + 2 < g.indices.size(); i += 3) {
    std::array<Bytes, 3> t;
    for (std::size_t k = 0; k < 3; ++k) t[k] = vertex_bytes(g, g.indices[i + k]);
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    out.push_back(std::move(t));
  }
  return out;
}

DrawGeometry unshared_sphere() {
  return make_draw_geometry(gen::uv_sphere(24, 12));
}

}  // namespace

TEST_CASE("equal vertices are shared, and the triangles stay what they were") {
  const DrawGeometry before = unshared_sphere();
  REQUIRE(before.positions_m.size() == before.indices.size());
  for (const TriangleOrder order : {TriangleOrder::kept, TriangleOrder::free}) {
    DrawGeometry after = before;
    share_vertices(after, order);
    // Inner rings of 25 vertices, and a point for each triangle at a pole, whose texture places differ.
    CHECK(after.positions_m.size() <= 25 * 13);
    CHECK(after.attributes.size() == after.positions_m.size());
    auto is = triangles(after);
    auto was = triangles(before);
    if (order == TriangleOrder::free) {
      std::sort(is.begin(), is.end());
      std::sort(was.begin(), was.end());
    }
    CHECK(is == was);
  }
}

TEST_CASE("what is nearly equal is not shared, and what nothing uses goes") {
  DrawGeometry g;
  g.positions_m = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  g.attributes.resize(g.positions_m.size());
  g.attributes[4].normal.x = 1;  // same place as 1, another normal
  g.indices = {1, 2, 3, 4, 5, 6};
  share_vertices(g, TriangleOrder::kept);
  CHECK(g.positions_m.size() == 5);
  CHECK(g.indices == std::vector<std::uint32_t>{0, 1, 2, 3, 2, 4});
  DrawGeometry lines = g;
  lines.kind = PrimitiveKind::lines;
  share_vertices(lines, TriangleOrder::free);
  CHECK(lines.indices == g.indices);
  DrawGeometry none;
  share_vertices(none, TriangleOrder::free);
  CHECK(none.positions_m.empty());
}

TEST_CASE("the model is told of shaded vertices and of the share of a box that is covered") {
  DrawGeometry sphere = unshared_sphere();
  share_vertices(sphere, TriangleOrder::free);
  const DrawWork round = work_of(sphere);
  CHECK(round.vertices == sphere.positions_m.size());
  CHECK(round.triangles == 24 * 11 * 2);
  CHECK(round.covered_share == Approx(0.5236).epsilon(0.03));  // pi / 6 of the box's surface

  DrawGeometry box = make_draw_geometry(gen::unit_box_unindexed(false));
  share_vertices(box, TriangleOrder::free);
  CHECK(work_of(box).vertices == 24);
  CHECK(work_of(box).covered_share == 1.0F);

  DrawGeometry flat;  // open: seen from either side it covers all of its box
  flat.positions_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  flat.attributes.resize(4);
  flat.indices = {0, 1, 2, 0, 2, 3};
  CHECK(work_of(flat).covered_share == 1.0F);
}
