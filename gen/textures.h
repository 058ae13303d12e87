// Small generated images, PNG in memory; the same bytes everywhere.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "scene/scene.h"

namespace scenegen::gen {

struct BrickImages {
  Image base_color, normal;
};
/// Faces of a brick of `size_mm` (length, width, height) with the mortar round them, laid out as in
/// primitives.h: 512 x 256.
[[nodiscard]] BrickImages brick_images(const glm::ivec3& size_mm);

/// Grey noise that repeats without a seam, 128 x 128: for ground and streets.
[[nodiscard]] Image noise_image();

}  // namespace scenegen::gen
