#include "render/draw_geometry.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace scenegen::render {
namespace {

std::int16_t snorm16(float x) {
  return static_cast<std::int16_t>(std::lround(std::clamp(std::isnan(x) ? 0.0F : x, -1.0F, 1.0F) * 32767.0F));
}

std::uint16_t unorm16(float x) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(std::isnan(x) ? 0.0F : x, 0.0F, 1.0F) * 65535.0F));
}

glm::i16vec4 snorm16(const glm::vec3& v, float w) {
  return {snorm16(v.x), snorm16(v.y), snorm16(v.z), snorm16(w)};
}

std::vector<std::uint32_t> fetched_indices(const Geometry& geometry) {
  if (!geometry.indices.empty()) return geometry.indices;
  std::vector<std::uint32_t> out(geometry.vertex_count());
  std::iota(out.begin(), out.end(), 0U);
  return out;
}

/// Lists from strips, fans and loops; winding as in the glTF 2.0 specification, 3.7.2.1.
std::vector<std::uint32_t> list_indices(const Geometry& geometry) {
  std::vector<std::uint32_t> in = fetched_indices(geometry);
  const std::size_t n = in.size();
  std::vector<std::uint32_t> out;
  switch (geometry.topology) {
    case Topology::points:
      return in;
    case Topology::lines:
      in.resize(n - n % 2);
      return in;
    case Topology::triangles:
      in.resize(n - n % 3);
      return in;
    case Topology::line_loop:
    case Topology::line_strip:
      for (std::size_t i = 0; i + 1 < n; ++i) out.insert(out.end(), {in[i], in[i + 1]});
      if (geometry.topology == Topology::line_loop && n > 1) out.insert(out.end(), {in[n - 1], in[0]});
      return out;
    case Topology::triangle_strip:
      for (std::size_t i = 0; i + 2 < n; ++i)
        out.insert(out.end(), {in[i], in[i + 1 + i % 2], in[i + 2 - i % 2]});
      return out;
    case Topology::triangle_fan:
      for (std::size_t i = 0; i + 2 < n; ++i) out.insert(out.end(), {in[i + 1], in[i + 2], in[0]});
      return out;
  }
  return out;
}

PrimitiveKind kind_of(Topology topology) {
  switch (topology) {
    case Topology::points:
      return PrimitiveKind::points;
    case Topology::lines:
    case Topology::line_loop:
    case Topology::line_strip:
      return PrimitiveKind::lines;
    default:
      return PrimitiveKind::triangles;
  }
}

VertexAttributes attributes_at(const Geometry& geometry, std::uint32_t v) {
  VertexAttributes a;
  if (!geometry.normals.empty()) a.normal = snorm16(geometry.normals[v], 0.0F);
  if (!geometry.tangents.empty())
    a.tangent = snorm16(glm::vec3(geometry.tangents[v]), geometry.tangents[v].w);
  if (!geometry.texcoords[0].empty()) a.texcoord0 = geometry.texcoords[0][v];
  if (!geometry.texcoords[1].empty()) a.texcoord1 = geometry.texcoords[1][v];
  if (!geometry.colors.empty()) {
    const glm::vec4& c = geometry.colors[v];
    a.color = {unorm16(c.x), unorm16(c.y), unorm16(c.z), unorm16(c.w)};
  }
  return a;
}

/// Every triangle gets vertices of its own with its face's normal (glTF 2.0, 3.7.2.1: "flat normals").
void add_flat_triangles(const Geometry& geometry, const std::vector<std::uint32_t>& indices,
                        DrawGeometry& out) {
  out.positions_m.reserve(indices.size());
  out.attributes.reserve(indices.size());
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const glm::vec3& a = geometry.positions_m[indices[i]];
    const glm::vec3& b = geometry.positions_m[indices[i + 1]];
    const glm::vec3& c = geometry.positions_m[indices[i + 2]];
    const glm::vec3 cross = glm::cross(b - a, c - a);
    const float length = glm::length(cross);
    const glm::vec3 normal = length > 0.0F ? cross / length : glm::vec3(0.0F);
    for (std::size_t k = 0; k < 3; ++k) {
      out.positions_m.push_back(geometry.positions_m[indices[i + k]]);
      VertexAttributes attributes = attributes_at(geometry, indices[i + k]);
      attributes.normal = snorm16(normal, 0.0F);
      attributes.tangent = glm::i16vec4(0);  // glTF: tangents without normals are to be ignored
      out.attributes.push_back(attributes);
    }
  }
  out.indices.resize(out.positions_m.size());
  std::iota(out.indices.begin(), out.indices.end(), 0U);
}

}  // namespace

DrawGeometry make_draw_geometry(const Geometry& geometry) {
  DrawGeometry out;
  out.kind = kind_of(geometry.topology);
  std::vector<std::uint32_t> indices = list_indices(geometry);
  if (out.kind == PrimitiveKind::triangles && geometry.normals.empty()) {
    add_flat_triangles(geometry, indices, out);
    return out;
  }
  out.positions_m = geometry.positions_m;
  out.attributes.reserve(geometry.vertex_count());
  for (std::uint32_t v = 0; v < geometry.vertex_count(); ++v)
    out.attributes.push_back(attributes_at(geometry, v));
  out.indices = std::move(indices);
  return out;
}

}  // namespace scenegen::render
