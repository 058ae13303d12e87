// Layout `merged`: the meshes of all objects of a group as one mesh, in the coordinates of the group's frame.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/gltf/write_plan.h"
#include "scene/gltf/write_sink.h"
#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::gltf {

enum class VertexStream : std::uint8_t {
  position,
  normal,
  tangent,
  texcoord_0,
  texcoord_1,
  color,
  object_id  ///< (index & 0xFFFF, index >> 16): vertex attributes may not be 32-bit integers
};

/// All geometry of one group node with one material: what can be one draw. Strips, fans and loops become
/// lists; no vertex stream is made up, so geometry with other streams is another primitive.
struct MergedPrimitive {
  MaterialId material;
  Topology topology = Topology::triangles;  ///< points, lines or triangles
  std::uint8_t streams = 0;                 ///< bit VertexStream
  bool indexed = false;
  std::uint64_t first_part = 0, part_count = 0;  ///< into MergePlan::parts
  std::uint64_t vertices = 0, indices = 0;
  Box box;  ///< of the positions as written; after MergePlan::measure()

  [[nodiscard]] bool has(VertexStream stream) const {
    return ((streams >> static_cast<unsigned>(stream)) & 1U) != 0;
  }
};

struct MergedPart {
  std::uint32_t object = 0;
  GeometryId geometry;
};

/// Memory: 8 bytes for each primitive of each object (in each look); vertices are made while they are
/// written.
struct MergePlan {
  std::vector<MergedPrimitive> primitives;
  std::vector<std::uint32_t> first_primitive;  ///< by group node, and one more; empty in other layouts
  std::vector<MergedPart> parts;
  std::vector<MeshId> mesh_of_node;  ///< in the file, behind the scene's own; none where nothing is drawn

  [[nodiscard]] bool any() const { return !first_primitive.empty(); }
  /// Fills the boxes. Error: vertices beyond the numbers of float32.
  [[nodiscard]] Result<void> measure(const Scene& scene);
};

/// Empty unless the layout is `merged`.
[[nodiscard]] MergePlan plan_merge(const Scene& scene, const NodePlan& nodes);

/// The elements of one stream, 4 bytes times components each.
void write_merged_stream(const Scene& scene, const MergePlan& plan, const MergedPrimitive& primitive,
                         VertexStream stream, ByteSink& sink);
void write_merged_indices(const Scene& scene, const MergePlan& plan, const MergedPrimitive& primitive,
                          bool narrow, ByteSink& sink);

}  // namespace scenegen::gltf
