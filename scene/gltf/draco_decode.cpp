#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>

#include <cmath>

#include "scene/gltf/build.h"

namespace scenegen::gltf::reading {

namespace {

/// Number of faces that the stream says it holds.
std::uint64_t stated_faces(const Bytes& bytes, const Place& at) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  char magic[5] = {};
  std::uint8_t major = 0, minor = 0, type = 0, method = 0;
  std::uint16_t flags = 0;
  if (!buffer.Decode(magic, 5) || std::string_view(magic, 5) != "DRACO") reject(at, "not a Draco stream");
  if (!buffer.Decode(&major) || !buffer.Decode(&minor) || !buffer.Decode(&type) || !buffer.Decode(&method) ||
      !buffer.Decode(&flags)) {
    reject(at, "truncated Draco stream");
  }
  if (major != 2 || minor != 2) {
    reject(at, "Draco stream " + std::to_string(major) + "." + std::to_string(minor) + "; glTF has 2.2");
  }
  if (type != draco::TRIANGULAR_MESH || method > 1) reject(at, "the Draco stream is not a triangle mesh");
  buffer.set_bitstream_version(static_cast<std::uint16_t>(DRACO_BITSTREAM_VERSION(major, minor)));
  if ((flags & METADATA_FLAG_MASK) != 0) {
    draco::GeometryMetadata metadata;
    draco::MetadataDecoder decoder;
    if (!decoder.DecodeGeometryMetadata(&buffer, &metadata)) reject(at, "damaged Draco metadata");
  }
  std::uint32_t vertices = 0, faces = 0;
  if (method == draco::MESH_EDGEBREAKER_ENCODING) {
    std::uint8_t traversal = 0;
    if (!buffer.Decode(&traversal) || !draco::DecodeVarint(&vertices, &buffer))
      reject(at, "truncated Draco stream");
  }
  if (!draco::DecodeVarint(&faces, &buffer)) reject(at, "truncated Draco stream");
  if (method == draco::MESH_SEQUENTIAL_ENCODING && !draco::DecodeVarint(&vertices, &buffer))
    reject(at, "truncated Draco stream");
  if (vertices > 3ULL * faces)
    reject(at, "Draco stream of " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
                   " faces");
  return faces;
}

template <class Vector>
void copy_attribute(const draco::Mesh& mesh, std::uint32_t id, const Place& at, std::vector<Vector>& out) {
  constexpr int kComponents = Vector::length();
  const draco::PointAttribute* const attribute = mesh.GetAttributeByUniqueId(id);
  if (attribute == nullptr) reject(at, "the Draco stream has no attribute " + std::to_string(id));
  const int given = attribute->num_components();
  if (given != kComponents && !(kComponents == 4 && given == 3)) {
    reject(at, "Draco attribute " + std::to_string(id) + " has " + std::to_string(given) +
                   " components; wanted " + std::to_string(kComponents));
  }
  const std::uint32_t points = mesh.num_points();
  out.resize(points, Vector(1.0F));
  float value[kComponents];
  for (std::uint32_t i = 0; i < points; ++i) {
    const draco::AttributeValueIndex entry = attribute->mapped_index(draco::PointIndex(i));
    const bool ok = entry.value() < attribute->size() &&
                    attribute->ConvertValue<float>(entry, static_cast<std::int8_t>(given), value);
    if (!ok) reject(at, "damaged Draco attribute " + std::to_string(id));
    for (int c = 0; c < given; ++c) {
      if (!std::isfinite(value[c])) reject(at, "point " + std::to_string(i) + " is not finite");
      out[i][c] = value[c];
    }
  }
}

}  // namespace

void decode_draco(const PrimitiveRecord& primitive, Data& data, const Place& at, Geometry& out) {
  const Bytes bytes = data.view(primitive.draco_view, at.key("bufferView"));
  const std::uint64_t faces = stated_faces(bytes, at);
  data.draco_triangles().take(faces, at);  // before the decoder allocates what the header says
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) reject(at, "damaged Draco stream: " + printable(decoded.status().error_msg_string()));
  const draco::Mesh& mesh = *decoded.value();
  out.indices.reserve(3ULL * mesh.num_faces());
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& point : mesh.face(f)) {
      check_index(point.value(), mesh.num_points(), "points", at);
      out.indices.push_back(point.value());
    }
  }
  const Place names = at.key("attributes");
  const auto& id = primitive.draco_id;
  if (id[0] != kNone) copy_attribute(mesh, id[0], names.key("POSITION"), out.positions_m);
  if (id[1] != kNone) copy_attribute(mesh, id[1], names.key("NORMAL"), out.normals);
  if (id[2] != kNone) copy_attribute(mesh, id[2], names.key("TANGENT"), out.tangents);
  if (id[3] != kNone) copy_attribute(mesh, id[3], names.key("TEXCOORD_0"), out.texcoords[0]);
  if (id[4] != kNone) copy_attribute(mesh, id[4], names.key("TEXCOORD_1"), out.texcoords[1]);
  if (id[5] != kNone) copy_attribute(mesh, id[5], names.key("COLOR_0"), out.colors);
}

}  // namespace scenegen::gltf::reading
