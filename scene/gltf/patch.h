// Adds what a scene gained since it was read to the document that it was read from, and keeps the rest of
// that document byte for byte: materials, textures, skins, cameras, lights, animations, extras, unknown
// extensions.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::gltf {

struct PatchOptions {
  VisibilityEncoding visibility = VisibilityEncoding::scale;
  /// For materials behind those of the file: the one it copies but for base colour, or none (a plain one).
  std::span<const MaterialId> material_copy_of;
  std::vector<OutputFile>* later = nullptr;  ///< as in WriteOptions
};

/// `scene` is what read() gave with `source`, plus tracks, frames, meshes (of the file's geometries) and
/// materials behind those that were there, visibility tracks and frames of objects, mesh tracks, and objects
/// that name one of the new meshes. Writes
/// .glb or .gltf as gltf::write does. Our animation comes first, the file's own follow. Errors (bad_input):
/// something that cannot be expressed, with the JSON pointer of the node and the reason (a skinned mesh and
/// visibility by scale).
[[nodiscard]] Result<WriteReport> patch(const SourceDocument& source, const Scene& scene,
                                        const std::string& path, const PatchOptions& options);

}  // namespace scenegen::gltf
