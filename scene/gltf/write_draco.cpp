#include "scene/gltf/write_draco.h"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "scene/gltf/write_buffer.h"

namespace scenegen::gltf {

namespace {

/// What a compressed primitive costs in JSON beyond a plain one: the extension object and its buffer view.
constexpr std::uint64_t kJsonBytes = 180;

/// Draco's quantisation squares and subtracts in float32 and does not look whether that overflows.
constexpr float kMostMagnitude = 1e15F;

template <class Vector>
bool moderate(const std::vector<Vector>& values) {
  return std::all_of(values.begin(), values.end(), [](const Vector& v) {
    return glm::all(glm::lessThanEqual(glm::abs(v), Vector(kMostMagnitude)));
  });
}

bool encodable(const Geometry& g) {
  return g.topology == Topology::triangles && g.drawn_vertex_count() >= 3 && moderate(g.positions_m) &&
         moderate(g.normals) && moderate(g.tangents) && moderate(g.texcoords[0]) &&
         moderate(g.texcoords[1]) && moderate(g.colors);
}

template <class Vector>
int add_attribute(draco::GeometryAttribute::Type type, const std::vector<Vector>& values, draco::Mesh& mesh) {
  if (values.empty()) return -1;
  constexpr auto kComponents = static_cast<std::int8_t>(Vector::length());
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, kComponents, draco::DT_FLOAT32, false, sizeof(Vector), 0);
  const int id = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(values.size()));
  for (std::uint32_t i = 0; i < values.size(); ++i)
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &values[i]);
  return id;
}

/// The geometry as Draco has it. Equal values are joined, so that the encoder sees which triangles are
/// neighbours across edges where only normals or texture coordinates change (as draco_encoder does).
std::unique_ptr<draco::Mesh> draco_mesh(const Geometry& geometry, DracoStream& ids) {
  auto mesh = std::make_unique<draco::Mesh>();
  mesh->set_num_points(static_cast<std::uint32_t>(geometry.vertex_count()));
  using Attribute = draco::GeometryAttribute;
  ids.position = add_attribute(Attribute::POSITION, geometry.positions_m, *mesh);
  ids.normal = add_attribute(Attribute::NORMAL, geometry.normals, *mesh);
  ids.tangent = add_attribute(Attribute::GENERIC, geometry.tangents, *mesh);
  for (std::size_t set = 0; set < 2; ++set)
    ids.texcoord[set] = add_attribute(Attribute::TEX_COORD, geometry.texcoords[set], *mesh);
  ids.color = add_attribute(Attribute::COLOR, geometry.colors, *mesh);
  const auto faces = static_cast<std::uint32_t>(geometry.drawn_vertex_count() / 3);
  mesh->SetNumFaces(faces);
  for (std::uint32_t f = 0; f < faces; ++f) {
    const auto corner = [&](std::uint32_t k) {
      return draco::PointIndex(geometry.indices.empty() ? 3 * f + k : geometry.indices[3 * f + k]);
    };
    mesh->SetFace(draco::FaceIndex(f), {corner(0), corner(1), corner(2)});
  }
  if (!mesh->DeduplicateAttributeValues()) return nullptr;
  mesh->DeduplicatePointIds();
  return mesh;
}

/// Triangles with two corners in one place: they draw nothing, and the encoder drops them.
std::uint64_t collapsed_faces(const draco::Mesh& mesh, int position) {
  const draco::PointAttribute& attribute = *mesh.attribute(position);
  std::uint64_t count = 0;
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
    const draco::Mesh::Face& face = mesh.face(f);
    const auto a = attribute.mapped_index(face[0]), b = attribute.mapped_index(face[1]),
               c = attribute.mapped_index(face[2]);
    count += a == b || b == c || c == a ? 1 : 0;
  }
  return count;
}

bool encode(const draco::Mesh& mesh, const DracoOptions& options, DracoStream& out) {
  if (collapsed_faces(mesh, out.position) == mesh.num_faces()) return false;  // the encoder would crash
  using Attribute = draco::GeometryAttribute;
  draco::Encoder encoder;
  const int speed = 10 - static_cast<int>(options.level);
  encoder.SetSpeedOptions(speed, speed);
  const auto quantize = [&](Attribute::Type type, std::uint32_t bits) {
    if (bits > 0) encoder.SetAttributeQuantization(type, static_cast<int>(bits));
  };
  quantize(Attribute::POSITION, options.position_bits);
  quantize(Attribute::NORMAL, options.normal_bits);
  quantize(Attribute::TEX_COORD, options.texcoord_bits);
  quantize(Attribute::COLOR, options.color_bits);
  quantize(Attribute::GENERIC, options.generic_bits);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok()) return false;
  out.bytes.assign(buffer.data(), buffer.data() + buffer.size());
  return true;
}

/// Decodes the stream again: counts and box of what readers will see. False if it did not come back whole.
bool measure(const draco::Mesh& source, DracoStream& stream) {
  draco::DecoderBuffer buffer;
  buffer.Init(stream.bytes.data(), stream.bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) return false;
  const draco::Mesh& mesh = *decoded.value();
  if (mesh.num_faces() == 0 || mesh.num_attributes() != source.num_attributes()) return false;
  const std::uint64_t least = source.num_faces() - collapsed_faces(source, stream.position);
  if (mesh.num_faces() < least || mesh.num_faces() > source.num_faces()) return false;
  stream.vertices = mesh.num_points();
  stream.indices = 3ULL * mesh.num_faces();
  for (int a = 0; a < mesh.num_attributes(); ++a) {
    const draco::PointAttribute& attribute = *mesh.attribute(a);
    const bool is_position =
        &attribute == mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(stream.position));
    float value[4] = {};
    for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
      if (!attribute.ConvertValue<float>(attribute.mapped_index(point), attribute.num_components(), value))
        return false;
      if (!std::all_of(value, value + attribute.num_components(), [](float v) { return std::isfinite(v); }))
        return false;
      if (is_position) stream.box.add({value[0], value[1], value[2]});
    }
  }
  return true;
}

}  // namespace

bool DracoStreams::any() const {
  return std::any_of(of_geometry.begin(), of_geometry.end(), [](const DracoStream& s) { return s.used(); });
}

DracoStreams encode_draco(const Scene& scene, const DracoOptions& options) {
  DracoStreams out;
  if (!options.on) return out;
  out.of_geometry.resize(scene.geometries.size());
  const std::vector<std::uint8_t> used = used_geometries(scene);
  for (std::size_t g = 0; g < scene.geometries.size(); ++g) {
    if (used[g] == 0) continue;
    const Geometry& geometry = scene.geometries[g];
    DracoStream stream;
    std::unique_ptr<draco::Mesh> mesh;
    if (encodable(geometry)) mesh = draco_mesh(geometry, stream);
    if (mesh == nullptr || !encode(*mesh, options, stream) || !measure(*mesh, stream)) {
      ++out.unfit;
    } else if (stream.bytes.size() + kJsonBytes >= plain_bytes(geometry)) {
      ++out.larger;
    } else {
      out.of_geometry[g] = std::move(stream);
    }
  }
  return out;
}

}  // namespace scenegen::gltf
