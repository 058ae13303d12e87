#include "scene/gltf/restructure_parts.h"

#include <algorithm>
#include <numeric>

namespace scenegen::gltf {

namespace {

/// Union-find with path halving; the smaller root wins, so that roots do not depend on the order of unions.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// By vertex of all primitives, one after the other: the first vertex at the same position.
std::vector<std::uint32_t> welded(const std::vector<glm::vec3>& positions) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const glm::vec3& p = positions[a];
    const glm::vec3& q = positions[b];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return a < b;
  };
  std::sort(order.begin(), order.end(), before);
  std::vector<std::uint32_t> out(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && positions[order[i]] == positions[order[i - 1]];  // 0 and -0 are equal
    out[order[i]] = same ? out[order[i - 1]] : order[i];
  }
  return out;
}

}  // namespace

std::uint32_t element_size(Topology topology) {
  switch (topology) {
    case Topology::triangles:
    case Topology::triangle_strip:
    case Topology::triangle_fan:
      return 3;
    case Topology::lines:
      return 2;
    default:
      return 0;
  }
}

std::vector<std::uint32_t> element_corners(const Geometry& geometry) {
  std::vector<std::uint32_t> corners = geometry.indices;
  const std::uint32_t size = element_size(geometry.topology);
  if (size == 0) return {};
  if (corners.empty()) {
    corners.resize(geometry.vertex_count());
    std::iota(corners.begin(), corners.end(), 0U);
  }
  if (geometry.topology == Topology::triangles || geometry.topology == Topology::lines) {
    corners.resize(corners.size() / size * size);
    return corners;
  }
  std::vector<std::uint32_t> out;
  for (std::size_t i = 2; i < corners.size(); ++i) {  // glTF 2.0, 3.7.2.1
    if (geometry.topology == Topology::triangle_fan) {
      out.insert(out.end(), {corners[i - 1], corners[i], corners[0]});
    } else {
      const std::size_t odd = i % 2;
      out.insert(out.end(), {corners[i - 2], corners[i - 1 + odd], corners[i - odd]});
    }
  }
  return out;
}

std::vector<MeshPart> connected_parts(const Scene& scene, const Mesh& mesh) {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> first;  // vertex of each primitive among `positions`
  for (const Primitive& primitive : mesh.primitives) {
    const auto& own = scene.geometries[primitive.geometry.value].positions_m;
    first.push_back(static_cast<std::uint32_t>(positions.size()));
    positions.insert(positions.end(), own.begin(), own.end());
  }
  const std::vector<std::uint32_t> weld = welded(positions);
  Sets sets(positions.size());
  std::vector<std::vector<std::uint32_t>> corners;
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const Geometry& geometry = scene.geometries[mesh.primitives[p].geometry.value];
    corners.push_back(element_corners(geometry));
    const std::uint32_t size = element_size(geometry.topology);
    for (std::size_t v = 1; size == 0 && v < geometry.vertex_count(); ++v)
      sets.join(weld[first[p]], weld[first[p] + v]);
    for (std::size_t c = 0; c < corners[p].size(); ++c) {
      if (c % size != 0) sets.join(weld[first[p] + corners[p][c - 1]], weld[first[p] + corners[p][c]]);
    }
  }
  std::vector<MeshPart> parts;
  constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  std::vector<std::uint32_t> part_of_root(positions.size(), kNone);
  const auto piece_at = [&](std::uint32_t primitive, std::uint32_t vertex) -> PartPiece& {
    std::uint32_t& part = part_of_root[sets.root(weld[first[primitive] + vertex])];
    if (part == kNone) {
      part = static_cast<std::uint32_t>(parts.size());
      parts.emplace_back();
    }
    auto& pieces = parts[part].pieces;
    if (pieces.empty() || pieces.back().primitive != primitive) pieces.push_back({primitive, {}});
    return pieces.back();
  };
  for (std::uint32_t p = 0; p < mesh.primitives.size(); ++p) {
    const Geometry& geometry = scene.geometries[mesh.primitives[p].geometry.value];
    const std::uint32_t size = element_size(geometry.topology);
    if (size == 0) (void)piece_at(p, 0);
    for (std::size_t c = 0; size != 0 && c < corners[p].size(); c += size) {
      auto& to = piece_at(p, corners[p][c]).corners;
      to.insert(to.end(), corners[p].begin() + static_cast<std::ptrdiff_t>(c),
                corners[p].begin() + static_cast<std::ptrdiff_t>(c + size));
    }
  }
  return parts;
}

}  // namespace scenegen::gltf
