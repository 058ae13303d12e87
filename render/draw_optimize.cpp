#include "render/draw_optimize.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>

namespace scenegen::render {
namespace {

template <class T>
void remap(std::vector<T>& stream, const std::vector<unsigned>& table, std::size_t count) {
  std::vector<T> out(count);
  meshopt_remapVertexBuffer(out.data(), stream.data(), stream.size(), sizeof(T), table.data());
  stream = std::move(out);
}

void remap_all(DrawGeometry& g, const std::vector<unsigned>& table, std::size_t count) {
  remap(g.positions_m, table, count);
  remap(g.attributes, table, count);
  meshopt_remapIndexBuffer(g.indices.data(), g.indices.data(), g.indices.size(), table.data());
}

}  // namespace

void share_vertices(DrawGeometry& g, TriangleOrder order) {
  if (g.kind != PrimitiveKind::triangles || g.indices.empty()) return;
  std::vector<unsigned> table(g.positions_m.size());
  const std::array streams{
      meshopt_Stream{g.positions_m.data(), sizeof(g.positions_m[0]), sizeof(g.positions_m[0])},
      meshopt_Stream{g.attributes.data(), sizeof(g.attributes[0]), sizeof(g.attributes[0])}};
  std::size_t count = meshopt_generateVertexRemapMulti(table.data(), g.indices.data(), g.indices.size(),
                                                       g.positions_m.size(), streams.data(), streams.size());
  remap_all(g, table, count);
  if (order == TriangleOrder::free)
    meshopt_optimizeVertexCache(g.indices.data(), g.indices.data(), g.indices.size(), count);
  table.resize(count);
  count = meshopt_optimizeVertexFetchRemap(table.data(), g.indices.data(), g.indices.size(), count);
  remap_all(g, table, count);
}

DrawWork work_of(const DrawGeometry& g) {
  DrawWork out;
  out.vertices = static_cast<std::uint32_t>(g.positions_m.size());
  if (g.kind != PrimitiveKind::triangles) return out;
  out.triangles = static_cast<std::uint32_t>(g.indices.size() / 3);
  Box box;
  double surface_m2 = 0.0;
  glm::dvec3 unbalanced_m2(0.0);  // of a closed surface 0
  for (std::size_t i = 0; i + 2 < g.indices.size(); i += 3) {
    const glm::dvec3 a(g.positions_m[g.indices[i]]);
    const glm::dvec3 b(g.positions_m[g.indices[i + 1]]);
    const glm::dvec3 c(g.positions_m[g.indices[i + 2]]);
    const glm::dvec3 area = 0.5 * glm::cross(b - a, c - a);
    surface_m2 += glm::length(area);
    unbalanced_m2 += area;
    for (const glm::dvec3& p : {a, b, c}) box.add(glm::vec3(p));
  }
  if (box.empty()) return out;
  const glm::dvec3 s(box.size());
  const double box_m2 = 2.0 * (s.x * s.y + s.y * s.z + s.z * s.x);
  const double covered = (surface_m2 + glm::length(unbalanced_m2)) / box_m2;
  if (box_m2 > 0.0 && covered < 1.0) out.covered_share = static_cast<float>(covered);
  return out;
}

}  // namespace scenegen::render
