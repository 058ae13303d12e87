// What each frame in flight owns: commands, fence, staging, timestamps, and a list of things to let go.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "render/gpu_stage.h"
#include "render/vk/memory.h"

namespace scenegen::render::vkr {

/// Mapped memory that is filled from the start each frame.
class Staging {
 public:
  void reset() { used_ = 0; }
  /// Space for `bytes`; grows by replacing the buffer, which is only legal before anything of this frame was
  /// recorded from it, so ask once a frame for all of it.
  std::byte* reserve(Memory& memory, std::uint64_t bytes);
  [[nodiscard]] vk::Buffer buffer() const { return *buffer_.buffer; }
  [[nodiscard]] std::uint64_t used() const { return used_; }

 private:
  Buffer buffer_;
  std::uint64_t used_ = 0;
};

struct Frame {
  vk::raii::CommandPool pool{nullptr};
  vk::raii::CommandBuffer commands{nullptr};
  vk::raii::Fence fence{nullptr};
  vk::raii::QueryPool timestamps{nullptr};
  Staging staging;
  Buffer color, ids, depth;  // readback, allocated when first asked for
  std::uint64_t serial = 0;  // counts frames from 1
  bool pending = false;      // submitted and not yet waited for

  /// A timestamp for the end of `stage`, which began where the mark before it was set. A stage may come
  /// several times. Does nothing unless the ring was made for it.
  void mark(const vk::raii::CommandBuffer& where, GpuStage stage);
  static constexpr std::uint32_t kMostMarks = 16;
  bool marking = false;
  std::array<GpuStage, kMostMarks> marks{};
  std::uint32_t marked = 0;

  /// A secondary command buffer for this frame only, not yet begun.
  const vk::raii::CommandBuffer& secondary(const Device& device);
  std::deque<vk::raii::CommandBuffer> secondaries;  // a deque: those handed out stay where they are
  std::size_t secondaries_used = 0;
};

/// Frames are used in turn. `acquire` waits for the device only when the frame is still pending.
class FrameRing {
 public:
  /// `stages`: frames measure their stages too, not just the whole.
  FrameRing(const Device& device, std::uint32_t frames, bool stages = false);
  ~FrameRing();
  FrameRing(const FrameRing&) = delete;
  FrameRing& operator=(const FrameRing&) = delete;

  /// The next frame, no longer in use by the device, its commands begun.
  Frame& begin();
  /// Ends the commands and submits them.
  void submit(Frame& frame);
  /// Waits until the device is done with the frame.
  void wait(Frame& frame);
  void wait_all();
  /// The device is done with this frame and all before it.
  [[nodiscard]] std::uint64_t completed() const { return completed_; }
  /// Milliseconds from the beginning of the frame to its end, and of each stage (0: not in this frame). None
  /// when the device has no timestamps; no stages when they are not measured. The frame must be done.
  struct GpuTimes {
    double frame_ms = 0;
    std::optional<std::array<double, kGpuStages>> stages_ms;
  };
  [[nodiscard]] std::optional<GpuTimes> gpu_times(const Frame& frame) const;

 private:
  const Device& device_;
  std::vector<Frame> frames_;
  std::size_t next_ = 0;
  std::uint64_t serials_ = 0;
  std::uint64_t completed_ = 0;
};

/// Records commands, submits them and waits: for uploads before the first frame.
void run_once(const Device& device, const std::function<void(const vk::raii::CommandBuffer&)>& record);

}  // namespace scenegen::render::vkr
