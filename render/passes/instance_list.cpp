#include "render/passes/instance_list.h"

#include <algorithm>
#include <cstring>

namespace scenegen::render {

void InstanceList::write(const PassContext& context, std::span<const std::uint32_t> slots) {
  // The frame that used it is done.
  vkr::Buffer& buffer = buffers_[context.frame.serial % context.frames_in_flight];
  if (buffer.bytes < slots.size_bytes() || buffer.bytes == 0) {
    const std::uint64_t most = context.scene.slot_count() * sizeof(std::uint32_t);
    buffer = {};
    buffer = context.memory.buffer(
        std::max<std::uint64_t>(std::min<std::uint64_t>(slots.size_bytes() * 3 / 2, most), 4),
        vk::BufferUsageFlagBits::eVertexBuffer, vkr::MemoryUse::upload, MemoryKind::lists);
  }
  if (!slots.empty()) std::memcpy(buffer.mapped(), slots.data(), slots.size_bytes());
}

}  // namespace scenegen::render
