// A Draco stream for tests: two triangles of four points, with normals and texture coordinates.
#pragma once

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <array>
#include <cstdint>
#include <vector>

namespace scenegen::testing {

/// Attribute ids 0 POSITION, 1 NORMAL, 2 TEXCOORD_0. `method`: 0 sequential, 1 edgebreaker. Empty when
/// encoding fails.
inline std::vector<std::uint8_t> draco_quad(int method) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  using Point = std::array<float, 3>;
  const Point corner[4] = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}};
  const Point up{0, 0, 1};
  const int faces[2][3] = {{0, 1, 2}, {0, 2, 3}};
  for (int f = 0; f < 2; ++f) {
    const Point* const p[3] = {&corner[faces[f][0]], &corner[faces[f][1]], &corner[faces[f][2]]};
    const draco::FaceIndex face(static_cast<std::uint32_t>(f));
    builder.SetAttributeValuesForFace(position, face, p[0]->data(), p[1]->data(), p[2]->data());
    builder.SetAttributeValuesForFace(normal, face, up.data(), up.data(), up.data());
    builder.SetAttributeValuesForFace(uv, face, p[0]->data(), p[1]->data(), p[2]->data());
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 10);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 12);
  draco::EncoderBuffer buffer;
  if (mesh == nullptr || !encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) return {};
  return {buffer.data(), buffer.data() + buffer.size()};
}

}  // namespace scenegen::testing
