// What would make an invalid or crashing file is refused before a byte is written.
#pragma once

#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// Linear pass over the scene: finite numbers, names in UTF-8, tracks with keys at t >= 0, geometry with
/// vertices, images of kinds that glTF holds. Everything else is the contract of validate() and asserted
/// here.
[[nodiscard]] Result<void> check_writable(const Scene& scene);

/// The part of it that patch() needs: what comes from the file is as the reader took it.
[[nodiscard]] Result<void> check_patchable(const Scene& scene);

/// MIME type as glTF wants it: the one given, or told from the first bytes; empty when glTF has no place for
/// it.
[[nodiscard]] std::string image_mime_type(const Image& image);

}  // namespace scenegen::gltf
