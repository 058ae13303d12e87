// Slots that instanced draws show, where the device reads them.
#pragma once

#include <cstdint>
#include <span>

#include "render/config.h"
#include "render/passes/pass_recording.h"

namespace scenegen::render {

/// One list for each frame in flight, in memory that the processor writes and the device reads as it draws:
/// 4 B an instance and frame, read once a draw; copying them to the device first would only add to that.
class InstanceList {
 public:
  /// For this frame; to be called once in it. Allocates only when the list is longer than any before. Throws
  /// vk::SystemError when there is no memory.
  void write(const PassContext& context, std::span<const std::uint32_t> slots);
  /// The list of this frame.
  [[nodiscard]] vk::Buffer buffer(const PassContext& context) const {
    return *buffers_[context.frame.serial % context.frames_in_flight].buffer;
  }

 private:
  vkr::Buffer buffers_[kMostFramesInFlight];
};

}  // namespace scenegen::render
