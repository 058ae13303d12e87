// Which triangles of a mesh belong together. Private to scene/gltf.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace scenegen::gltf {

/// What one part has of one primitive: vertices of the primitive, three an element (two for lines).
struct PartPiece {
  std::uint32_t primitive = 0;  ///< position in Mesh::primitives
  std::vector<std::uint32_t> corners;
};
struct MeshPart {
  std::vector<PartPiece> pieces;  ///< ascending primitives
};

/// Elements of `geometry` as corner lists (strips and fans resolved); empty for points and strips of lines,
/// which are one piece.
[[nodiscard]] std::vector<std::uint32_t> element_corners(const Geometry& geometry);
/// Corners of an element: 3, 2 (lines) or 0 (one piece).
[[nodiscard]] std::uint32_t element_size(Topology topology);

/// Connected pieces over all primitives of `mesh`; corners at equal positions are the same corner. Ordered by
/// their first element. A primitive that is one piece has no corners in its PartPiece.
[[nodiscard]] std::vector<MeshPart> connected_parts(const Scene& scene, const Mesh& mesh);

}  // namespace scenegen::gltf
