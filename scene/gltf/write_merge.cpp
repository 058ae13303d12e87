#include "scene/gltf/write_merge.h"

#include <cmath>
#include <map>
#include <tuple>

#include "scene/limits.h"

namespace scenegen::gltf {

namespace {

constexpr std::uint8_t bit(VertexStream stream) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(stream));
}

std::uint8_t streams_of(const Geometry& g) {
  const auto if_any = [](const auto& data, VertexStream stream) {
    return data.empty() ? std::uint8_t{0} : bit(stream);
  };
  return static_cast<std::uint8_t>(
      bit(VertexStream::position) | bit(VertexStream::object_id) | if_any(g.normals, VertexStream::normal) |
      if_any(g.tangents, VertexStream::tangent) | if_any(g.texcoords[0], VertexStream::texcoord_0) |
      if_any(g.texcoords[1], VertexStream::texcoord_1) | if_any(g.colors, VertexStream::color));
}

Topology list_topology(Topology topology) {
  switch (topology) {
    case Topology::points:
      return Topology::points;
    case Topology::lines:
    case Topology::line_loop:
    case Topology::line_strip:
      return Topology::lines;
    default:
      return Topology::triangles;
  }
}

/// Corners of the lists that a geometry becomes.
std::uint64_t list_corners(const Geometry& g) {
  const std::uint64_t n = g.drawn_vertex_count();
  switch (g.topology) {
    case Topology::line_strip:
      return n < 2 ? 0 : 2 * (n - 1);
    case Topology::line_loop:
      return n < 2 ? 0 : 2 * n;
    case Topology::triangle_strip:
    case Topology::triangle_fan:
      return n < 3 ? 0 : 3 * (n - 2);
    case Topology::triangles:
      return n - n % 3;
    case Topology::lines:
      return n - n % 2;
    default:
      return n;
  }
}

/// Can be part of a list without indices.
bool is_plain_list(const Geometry& g) {
  return g.indices.empty() && list_topology(g.topology) == g.topology && list_corners(g) == g.vertex_count();
}

/// A mirrored object turns its triangles over: other corners come first, as a player of the node would do.
bool is_mirrored(const Transform& t) {
  return (t.scale.x < 0) != ((t.scale.y < 0) != (t.scale.z < 0)) && t.scale.x != 0 && t.scale.y != 0 &&
         t.scale.z != 0;
}

/// put(vertex) for the corners of the lists, in order. glTF 2.0, 3.7.2.1 (strips alternate their winding).
template <class Put>
void for_each_corner(const Geometry& g, bool mirrored, const Put& put) {
  const std::uint64_t n = g.drawn_vertex_count();
  const auto vertex = [&](std::uint64_t k) {
    return g.indices.empty() ? static_cast<std::uint32_t>(k) : g.indices[k];
  };
  const auto triangle = [&](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    put(vertex(a));
    put(vertex(mirrored ? c : b));
    put(vertex(mirrored ? b : c));
  };
  const auto line = [&](std::uint64_t a, std::uint64_t b) {
    put(vertex(a));
    put(vertex(b));
  };
  switch (g.topology) {
    case Topology::line_strip:
    case Topology::line_loop:
      for (std::uint64_t k = 0; k + 1 < n; ++k) line(k, k + 1);
      if (g.topology == Topology::line_loop && n >= 2) line(n - 1, 0);
      break;
    case Topology::triangle_strip:
      for (std::uint64_t k = 0; k + 2 < n; ++k) triangle(k, k + 1 + k % 2, k + 2 - k % 2);
      break;
    case Topology::triangle_fan:
      for (std::uint64_t k = 0; k + 2 < n; ++k) triangle(k + 1, k + 2, 0);
      break;
    case Topology::triangles:
      for (std::uint64_t k = 0; k + 2 < n; k += 3) triangle(k, k + 1, k + 2);
      break;
    default:
      for (std::uint64_t k = 0; k < list_corners(g); ++k) put(vertex(k));
  }
}

/// Takes positions, normals and tangents of an object into its frame. In double, rounded once.
class Placement {
 public:
  explicit Placement(const Transform& t)
      : scale_(t.scale), translation_(t.translation_m), mirrored_(is_mirrored(t)) {
    neutral_ = t.rotation == glm::quat(1.0F, 0.0F, 0.0F, 0.0F) && t.scale == glm::vec3(1.0F);
    rotation_ = glm::mat3_cast(glm::dquat(t.rotation));
    const double sign = mirrored_ ? -1.0 : 1.0;
    // The cofactors of the scale: its inverse transpose but for a factor, also where it has none.
    cofactors_ = sign * glm::dvec3(scale_.y * scale_.z, scale_.x * scale_.z, scale_.x * scale_.y);
  }
  [[nodiscard]] glm::vec3 position(const glm::vec3& p) const {
    if (neutral_) return p + glm::vec3(translation_);
    return glm::vec3(rotation_ * (scale_ * glm::dvec3(p)) + translation_);
  }
  [[nodiscard]] glm::vec3 normal(const glm::vec3& n) const { return direction(n, cofactors_); }
  [[nodiscard]] glm::vec4 tangent(const glm::vec4& t) const {
    return {direction(glm::vec3(t), scale_), mirrored_ ? -t.w : t.w};
  }
  [[nodiscard]] bool mirrored() const { return mirrored_; }

 private:
  /// Of unit length; what a flat scale leaves nothing of is only turned.
  [[nodiscard]] glm::vec3 direction(const glm::vec3& d, const glm::dvec3& factors) const {
    if (neutral_) return d;
    glm::dvec3 out = rotation_ * (factors * glm::dvec3(d));
    double length = std::sqrt(glm::dot(out, out));
    if (!(length > 0.0)) {
      out = rotation_ * glm::dvec3(d);
      length = std::sqrt(glm::dot(out, out));
    }
    return length > 0.0 ? glm::vec3(out / length) : d;
  }

  glm::dvec3 scale_, translation_, cofactors_;
  glm::dmat3 rotation_{1.0};
  bool mirrored_ = false, neutral_ = false;
};

/// put(geometry, placement, vertex, object) for every vertex of the primitive as written.
template <class Put>
void for_each_vertex(const Scene& scene, const MergePlan& plan, const MergedPrimitive& primitive,
                     const Put& put) {
  for (std::uint64_t p = primitive.first_part; p < primitive.first_part + primitive.part_count; ++p) {
    const MergedPart& part = plan.parts[p];
    const Geometry& geometry = scene.geometries[part.geometry.value];
    const Placement placement(scene.objects.frame_from_object[part.object]);
    const auto one = [&](std::uint32_t vertex) { put(geometry, placement, vertex, part.object); };
    if (primitive.indexed) {
      for (std::uint32_t v = 0; v < geometry.vertex_count(); ++v) one(v);
    } else {
      for_each_corner(geometry, placement.mirrored(), one);
    }
  }
}

using Key = std::tuple<MaterialId, Topology, std::uint8_t>;

/// Primitives and parts of one group node.
void merge_node(const Scene& scene, const NodePlan& nodes, const GroupNode& node, MergePlan& plan) {
  const Group& group = nodes.groups[node.group];
  std::map<Key, std::size_t> known;
  std::vector<std::vector<MergedPart>> parts;
  const std::size_t first = plan.primitives.size();
  for (std::uint32_t k = group.first; k < group.first + group.count; ++k) {
    const std::uint32_t object = nodes.grouped[k];
    const MeshId mesh = node.look.valid() ? node.look : scene.objects.mesh[object];
    for (const Primitive& p : scene.meshes[mesh.value].primitives) {
      const Geometry& geometry = scene.geometries[p.geometry.value];
      if (list_corners(geometry) == 0) continue;
      const Key key(p.material, list_topology(geometry.topology), streams_of(geometry));
      const auto [at, fresh] = known.emplace(key, parts.size());
      if (fresh) {
        parts.emplace_back();
        MergedPrimitive& primitive = plan.primitives.emplace_back();
        std::tie(primitive.material, primitive.topology, primitive.streams) = key;
      }
      parts[at->second].push_back({object, p.geometry});
      MergedPrimitive& primitive = plan.primitives[first + at->second];
      primitive.vertices += geometry.vertex_count();
      primitive.indices += list_corners(geometry);
      primitive.indexed = primitive.indexed || !is_plain_list(geometry);
    }
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    MergedPrimitive& primitive = plan.primitives[first + i];
    primitive.first_part = plan.parts.size();
    primitive.part_count = parts[i].size();
    plan.parts.insert(plan.parts.end(), parts[i].begin(), parts[i].end());
    if (!primitive.indexed) primitive.indices = 0;
  }
}

}  // namespace

MergePlan plan_merge(const Scene& scene, const NodePlan& nodes) {
  MergePlan plan;
  if (nodes.layout != Layout::merged) return plan;
  auto mesh = static_cast<std::uint32_t>(scene.meshes.size());
  for (const GroupNode& node : nodes.group_nodes) {
    const std::size_t first = plan.primitives.size();
    plan.first_primitive.push_back(static_cast<std::uint32_t>(first));
    merge_node(scene, nodes, node, plan);
    plan.mesh_of_node.push_back(plan.primitives.size() == first ? MeshId() : MeshId(mesh++));
  }
  plan.first_primitive.push_back(static_cast<std::uint32_t>(plan.primitives.size()));
  return plan;
}

Result<void> MergePlan::measure(const Scene& scene) {
  for (MergedPrimitive& primitive : primitives) {
    const std::uint32_t first = parts[primitive.first_part].object;
    if (primitive.vertices > limits::kMaxMergedVertices) {
      return fail(ErrorKind::bad_input, "objects[" + std::to_string(first) + "] and others",
                  std::to_string(primitive.vertices) +
                      " vertices in one mesh; indices have 32 bits: use layout instances");
    }
    primitive.box = Box();
    std::uint32_t last = first;
    float sum = 0.0F;  // of 0 or NaN
    for_each_vertex(scene, *this, primitive,
                    [&](const Geometry& g, const Placement& placement, std::uint32_t v, std::uint32_t i) {
                      const glm::vec3 p = placement.position(g.positions_m[v]);
                      primitive.box.add(p);
                      if (sum == 0.0F) last = i;
                      sum += (p.x * 0.0F + p.y * 0.0F) + p.z * 0.0F;
                    });
    if (sum != 0.0F) {
      return fail(ErrorKind::bad_input,
                  "objects[" + std::to_string(last) + "] " + std::string(scene.objects.names[last]),
                  "its vertices are beyond the numbers that float32 holds");
    }
  }
  return {};
}

void write_merged_stream(const Scene& scene, const MergePlan& plan, const MergedPrimitive& primitive,
                         VertexStream stream, ByteSink& sink) {
  if (!primitive.has(stream)) return;
  const auto put = [&](const auto& value) { sink.write(&value, sizeof value); };
  for_each_vertex(scene, plan, primitive,
                  [&](const Geometry& g, const Placement& placement, std::uint32_t v, std::uint32_t object) {
                    switch (stream) {
                      case VertexStream::position:
                        return put(placement.position(g.positions_m[v]));
                      case VertexStream::normal:
                        return put(placement.normal(g.normals[v]));
                      case VertexStream::tangent:
                        return put(placement.tangent(g.tangents[v]));
                      case VertexStream::texcoord_0:
                        return put(g.texcoords[0][v]);
                      case VertexStream::texcoord_1:
                        return put(g.texcoords[1][v]);
                      case VertexStream::color:
                        return put(g.colors[v]);
                      case VertexStream::object_id:
                        return put(object);  // little-endian: its low half first
                    }
                  });
}

void write_merged_indices(const Scene& scene, const MergePlan& plan, const MergedPrimitive& primitive,
                          bool narrow, ByteSink& sink) {
  if (!primitive.indexed) return;
  std::uint32_t base = 0;
  for (std::uint64_t p = primitive.first_part; p < primitive.first_part + primitive.part_count; ++p) {
    const MergedPart& part = plan.parts[p];
    const Geometry& geometry = scene.geometries[part.geometry.value];
    const bool mirrored = is_mirrored(scene.objects.frame_from_object[part.object]);
    for_each_corner(geometry, mirrored, [&](std::uint32_t vertex) {
      const std::uint32_t index = base + vertex;
      sink.write(&index, narrow ? 2 : 4);  // little-endian: the low half first
    });
    base += static_cast<std::uint32_t>(geometry.vertex_count());
  }
}

}  // namespace scenegen::gltf
