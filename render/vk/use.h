// Ways in which resources are used, the vocabulary of barriers.
#pragma once

#include <cstdint>

namespace scenegen::render::vkr {

/// A way in which the device (or the processor) uses a resource.
enum class Use : std::uint8_t {
  none,              ///< fresh: contents are discarded
  transfer_read,     ///< copied or blitted from
  transfer_write,    ///< copied or blitted to
  shader_data,       ///< uniform, storage, index and vertex reads of draws, and of shaders that cull
  sampled,           ///< sampled in fragment shaders
  color_attachment,  ///< drawn to, blended, resolved to
  depth_attachment,  ///< tested and written
  compute_read,      ///< storage reads of compute shaders
  compute_write,     ///< storage writes of compute shaders
  compute_update,    ///< storage reads and writes of them, atomics too
  compute_sampled,   ///< depth sampled in compute shaders
  predicate,         ///< read by conditional rendering
  indirect,          ///< draw commands and their number, read by indirect draws
  host_read,         ///< read by the processor after the fence
};

}  // namespace scenegen::render::vkr
