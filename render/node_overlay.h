// Boxes of an octree's chunks drawn over a picture, coloured by what is known of them: to see how a strategy
// works, not to be fast.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/view.h"
#include "scene/transform.h"

namespace scenegen::render {

/// What a frame made of a chunk.
enum class ChunkVerdict : std::uint8_t {
  not_asked,  ///< nothing was asked about it: drawn
  visible,    ///< visible when it was last asked about: drawn
  hidden      ///< believed hidden, and asked again in this frame
};
struct ChunkBox {
  Box box_m;
  ChunkVerdict verdict = ChunkVerdict::not_asked;
};

/// Draws the edges of the boxes into a picture of `size`, rows from the top, 4 B a pixel: grey, green and
/// red; the red ones last, so that they are seen. Lines are cut at the near plane, and hidden by nothing.
void draw_chunk_boxes(std::span<const ChunkBox> boxes, const View& view, glm::uvec2 size,
                      std::span<std::uint8_t> rgba);

}  // namespace scenegen::render
