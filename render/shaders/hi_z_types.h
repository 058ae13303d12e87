// Structs of culling on the device, as shared_types.h.
#ifndef SCENEGEN_RENDER_SHADERS_HI_Z_TYPES_H
#define SCENEGEN_RENDER_SHADERS_HI_Z_TYPES_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace scenegen::render {
using glm::uvec2;
using glm::vec4;
using uint = std::uint32_t;
#endif

const uint kHiZNone = 0xFFFFFFFFu;

/// Slots [first, first + count) of the table of slots: they share state and geometry. One command draws those
/// of them that are to be drawn, a second one those that are mirrored.
struct HiZBlock {
  uint first;
  uint count;
  uint group;
  uint mirrored;  // 0: none ever is
  uint index_count;
  uint first_index;
  uint vertex_offset;
  uint triangles;  // of one slot
};

/// Box of a geometry, in the mesh's coordinates.
struct HiZGroup {
  vec4 lo;
  vec4 hi;
};

struct HiZConstants {
  uvec2 size_px;
  uint levels;          // of the pyramid
  uint part;            // 0 or 1
  uint blocks;          // that the frame looks at
  uint groups_x;        // workgroups in a row
  uint bit_words;       // 32-bit words of a set of slots
  uint command_words;   // of all commands of a part
  uint mirrored_words;  // from a block's command to the one for its mirrored slots
  uint unused0;
};

#ifdef __cplusplus
static_assert(sizeof(HiZBlock) == 32);
static_assert(sizeof(HiZGroup) == 32);
static_assert(sizeof(HiZConstants) == 40);
}  // namespace scenegen::render
#endif
#endif
