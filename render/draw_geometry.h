// Geometry as the device draws it: indexed lists of triangles, lines or points with every vertex stream
// present.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.h"

namespace scenegen::render {

enum class PrimitiveKind : std::uint8_t { triangles, lines, points };

/// Vertex streams without the position, 40 bytes: what colour passes read and depth passes do not.
struct VertexAttributes {
  glm::i16vec4 normal{0};   ///< signed, normalised; 0 means there is none (lines and points without normals)
  glm::i16vec4 tangent{0};  ///< w = handedness; 0 means there is none
  glm::vec2 texcoord0{0.0F};
  glm::vec2 texcoord1{0.0F};
  glm::u16vec4 color{65535};  ///< linear, normalised
};
static_assert(sizeof(VertexAttributes) == 40);

struct DrawGeometry {
  PrimitiveKind kind = PrimitiveKind::triangles;
  std::vector<glm::vec3> positions_m;
  std::vector<VertexAttributes> attributes;
  std::vector<std::uint32_t> indices;  ///< 3, 2 or 1 a primitive
};

/// Strips, fans and loops become lists; triangles without normals get flat ones (their vertices are then no
/// longer shared). Incomplete primitives at the end are dropped, as glTF says.
[[nodiscard]] DrawGeometry make_draw_geometry(const Geometry& geometry);

}  // namespace scenegen::render
