// Meshes: vertex streams and indices.
#include <cmath>
#include <cstring>

#include "scene/import/convert.h"

namespace scenegen::import {

namespace {

using nlohmann::json;

bool all_finite(const std::vector<float>& values) {
  for (const float v : values) {
    if (!std::isfinite(v)) return false;
  }
  return true;
}

std::vector<float> flat(const aiVector3D* vectors, unsigned count, unsigned components) {
  std::vector<float> out;
  out.reserve(std::size_t{count} * components);
  for (unsigned i = 0; i < count; ++i) {
    const float xyz[3] = {vectors[i].x, vectors[i].y, vectors[i].z};
    out.insert(out.end(), xyz, xyz + components);
  }
  return out;
}

/// Unit length, as glTF asks; a normal without a direction points up.
std::vector<float> unit_vectors(const aiVector3D* vectors, unsigned count) {
  std::vector<float> out;
  out.reserve(std::size_t{count} * 3);
  for (unsigned i = 0; i < count; ++i) {
    const double x = vectors[i].x;
    const double y = vectors[i].y;
    const double z = vectors[i].z;
    const double length = std::sqrt(x * x + y * y + z * z);
    if (!(length > 1e-12) || !std::isfinite(length)) {
      out.insert(out.end(), {0.0F, 1.0F, 0.0F});
      continue;
    }
    for (const double v : {x, y, z}) out.push_back(static_cast<float>(v / length));
  }
  return out;
}

std::vector<float> tangents(const aiMesh& mesh) {
  const std::vector<float> unit = unit_vectors(mesh.mTangents, mesh.mNumVertices);
  std::vector<float> out;
  out.reserve(std::size_t{mesh.mNumVertices} * 4);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D across = mesh.mNormals[i] ^ mesh.mTangents[i];
    out.insert(out.end(), &unit[3 * std::size_t{i}], &unit[3 * std::size_t{i}] + 3);
    out.push_back(across * mesh.mBitangents[i] < 0 ? -1.0F : 1.0F);
  }
  return out;
}

std::vector<float> colors(const aiMesh& mesh) {
  std::vector<float> out;
  out.reserve(std::size_t{mesh.mNumVertices} * 4);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiColor4D& color = mesh.mColors[0][i];
    for (const float v : {color.r, color.g, color.b, color.a})
      out.push_back(v > 0 ? std::min(v, 1.0F) : 0.0F);  // also NaN
  }
  return out;
}

/// Vertices of a face of the mesh's kind: 3, 2 or 1; 0 for none (polygons that resisted triangulation).
unsigned face_size(const aiMesh& mesh) {
  if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) != 0) return 3;
  if ((mesh.mPrimitiveTypes & aiPrimitiveType_LINE) != 0) return 2;
  return (mesh.mPrimitiveTypes & aiPrimitiveType_POINT) != 0 || mesh.mNumFaces == 0 ? 1 : 0;
}

std::vector<std::uint32_t> face_indices(const aiMesh& mesh, unsigned size) {
  std::vector<std::uint32_t> out;
  out.reserve(std::size_t{mesh.mNumFaces} * size);
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != size) continue;
    bool inside = true;
    for (unsigned k = 0; k < size; ++k) inside &= face.mIndices[k] < mesh.mNumVertices;
    if (inside) out.insert(out.end(), face.mIndices, face.mIndices + size);
  }
  return out;
}

json attributes(Conversion& c, const aiMesh& mesh, const std::vector<float>& positions) {
  constexpr auto kVertices = GlbBuilder::Target::vertices;
  json out = {{"POSITION", c.document.floats(positions, 3, kVertices, true)}};
  const auto add = [&](const std::string& name, const std::vector<float>& values, unsigned components) {
    if (all_finite(values)) {
      out[name] = c.document.floats(values, components, kVertices, false);
    } else {
      c.notes.add("a vertex attribute with numbers that are not finite (" + name + ")");
    }
  };
  if (mesh.HasNormals() && face_size(mesh) == 3)
    add("NORMAL", unit_vectors(mesh.mNormals, mesh.mNumVertices), 3);
  if (mesh.HasNormals() && mesh.HasTangentsAndBitangents() && face_size(mesh) == 3)
    add("TANGENT", tangents(mesh), 4);
  unsigned sets = 0;
  for (unsigned i = 0; i < AI_MAX_NUMBER_OF_TEXTURECOORDS && mesh.HasTextureCoords(i); ++i, ++sets) {
    if (i < 2) add("TEXCOORD_" + std::to_string(i), flat(mesh.mTextureCoords[i], mesh.mNumVertices, 2), 2);
  }
  if (sets > 2) c.notes.add("texture coordinates beyond the second set", sets - 2);
  if (mesh.HasVertexColors(0)) add("COLOR_0", colors(mesh), 4);
  return out;
}

json convert_mesh(Conversion& c, const aiMesh& mesh) {
  const unsigned size = face_size(mesh);
  if (mesh.mNumVertices == 0 || !mesh.HasPositions() || size == 0) return nullptr;
  const std::vector<float> positions = flat(mesh.mVertices, mesh.mNumVertices, 3);
  if (!all_finite(positions)) {
    c.notes.add("meshes with positions that are not finite");
    return nullptr;
  }
  std::vector<std::uint32_t> indices = face_indices(mesh, size);
  if (indices.empty() && mesh.mNumFaces != 0) return nullptr;
  json out = {{"attributes", attributes(c, mesh, positions)}};
  if (size != 3) out["mode"] = size == 2 ? 1 : 0;
  if (!indices.empty()) out["indices"] = c.document.indices(indices, mesh.mNumVertices);
  if (mesh.mMaterialIndex < c.scene.mNumMaterials) out["material"] = convert_material(c, mesh.mMaterialIndex);
  if (mesh.HasBones()) c.notes.add("bones: meshes stand as they were modelled");
  if (mesh.mNumAnimMeshes != 0) c.notes.add("morph targets: meshes are drawn at rest");
  return out;
}

}  // namespace

std::vector<json> convert_meshes(Conversion& c) {
  std::vector<json> out;
  out.reserve(c.scene.mNumMeshes);
  for (unsigned i = 0; i < c.scene.mNumMeshes; ++i) out.push_back(convert_mesh(c, *c.scene.mMeshes[i]));
  return out;
}

}  // namespace scenegen::import
