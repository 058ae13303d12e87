#include "render/vk/frame_ring.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "render/config.h"

namespace scenegen::render::vkr {

std::byte* Staging::reserve(Memory& memory, std::uint64_t bytes) {
  assert(used_ == 0);
  if (buffer_.bytes < bytes) {
    buffer_ = Buffer{};
    buffer_ = memory.buffer(std::max({bytes + bytes / 2, kStagingBytes}),
                            vk::BufferUsageFlagBits::eTransferSrc, MemoryUse::upload, MemoryKind::staging);
  }
  used_ = bytes;
  return buffer_.mapped();
}

const vk::raii::CommandBuffer& Frame::secondary(const Device& device) {
  if (secondaries_used == secondaries.size()) {
    vk::raii::CommandBuffers made(device.device, {*pool, vk::CommandBufferLevel::eSecondary, 1});
    secondaries.push_back(std::move(made.front()));
  }
  return secondaries[secondaries_used++];
}

void Frame::mark(const vk::raii::CommandBuffer& where, GpuStage stage) {
  if (!marking || marked == kMostMarks) return;
  where.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, *timestamps, 2 + marked);
  marks[marked++] = stage;
}

namespace {

/// Before what may be running is destroyed because waiting for it failed. A device that is lost runs nothing.
void wait_idle(const Device& device) {
  try {
    device.device.waitIdle();
  } catch (const std::exception&) {
  }
}

}  // namespace

FrameRing::FrameRing(const Device& device, std::uint32_t frames, bool stages)
    : device_(device), frames_(frames) {
  for (Frame& f : frames_) {
    f.pool = vk::raii::CommandPool(device.device, {{}, device.queue_family});
    f.commands = std::move(
        vk::raii::CommandBuffers(device.device, {*f.pool, vk::CommandBufferLevel::ePrimary, 1}).front());
    f.fence = vk::raii::Fence(device.device, vk::FenceCreateInfo{});
    if (device.timestamps)
      f.timestamps =
          vk::raii::QueryPool(device.device, {{}, vk::QueryType::eTimestamp, 2 + Frame::kMostMarks});
    f.marking = stages && device.timestamps;
  }
}

FrameRing::~FrameRing() {
  try {
    wait_all();
  } catch (const std::exception&) {
    wait_idle(device_);
  }
}

Frame& FrameRing::begin() {
  Frame& f = frames_[next_];
  next_ = (next_ + 1) % frames_.size();
  wait(f);
  f.staging.reset();
  f.pool.reset();
  f.secondaries_used = 0;
  f.marked = 0;
  f.serial = ++serials_;
  f.commands.begin(vk::CommandBufferBeginInfo(vk::CommandBufferUsageFlagBits::eOneTimeSubmit));
  if (device_.timestamps) {
    f.commands.resetQueryPool(*f.timestamps, 0, 2 + Frame::kMostMarks);
    f.commands.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, *f.timestamps, 0);
  }
  return f;
}

void FrameRing::submit(Frame& frame) {
  if (device_.timestamps)
    frame.commands.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, *frame.timestamps, 1);
  frame.commands.end();
  device_.queue.submit(vk::SubmitInfo({}, {}, *frame.commands), *frame.fence);
  frame.pending = true;
}

void FrameRing::wait(Frame& frame) {
  if (!frame.pending) return;
  constexpr std::uint64_t kForever = std::numeric_limits<std::uint64_t>::max();
  if (device_.device.waitForFences(*frame.fence, VK_TRUE, kForever) != vk::Result::eSuccess)
    throw vk::DeviceLostError("waiting for a frame");
  device_.device.resetFences(*frame.fence);
  frame.pending = false;
  completed_ = std::max(completed_, frame.serial);
}

void FrameRing::wait_all() {
  for (Frame& f : frames_) wait(f);
}

std::optional<FrameRing::GpuTimes> FrameRing::gpu_times(const Frame& frame) const {
  if (!device_.timestamps) return std::nullopt;
  std::array<std::uint64_t, 2 + Frame::kMostMarks> ticks;
  const std::uint32_t count = 2 + frame.marked;
  const vk::Result result =
      (*device_.device)
          .getQueryPoolResults(*frame.timestamps, 0, count, count * sizeof(ticks[0]), ticks.data(),
                               sizeof(ticks[0]), vk::QueryResultFlagBits::e64,
                               *device_.device.getDispatcher());
  if (result != vk::Result::eSuccess) return std::nullopt;
  const auto ms = [&](std::uint64_t from, std::uint64_t to) {
    return static_cast<double>(to - from) * static_cast<double>(device_.properties.limits.timestampPeriod) *
           1e-6;
  };
  GpuTimes out{ms(ticks[0], ticks[1]), std::nullopt};
  if (!frame.marking) return out;
  out.stages_ms.emplace().fill(0.0);
  for (std::uint32_t i = 0; i < frame.marked; ++i)
    (*out.stages_ms)[static_cast<std::size_t>(frame.marks[i])] += ms(ticks[i == 0 ? 0 : 1 + i], ticks[2 + i]);
  return out;
}

void run_once(const Device& device, const std::function<void(const vk::raii::CommandBuffer&)>& record) {
  const vk::raii::CommandPool pool(device.device, {{}, device.queue_family});
  const vk::raii::CommandBuffers buffers(device.device, {*pool, vk::CommandBufferLevel::ePrimary, 1});
  const vk::raii::CommandBuffer& commands = buffers.front();
  commands.begin(vk::CommandBufferBeginInfo(vk::CommandBufferUsageFlagBits::eOneTimeSubmit));
  record(commands);
  commands.end();
  const vk::raii::Fence fence(device.device, vk::FenceCreateInfo{});
  device.queue.submit(vk::SubmitInfo({}, {}, *commands), *fence);
  try {
    if (device.device.waitForFences(*fence, VK_TRUE, std::numeric_limits<std::uint64_t>::max()) !=
        vk::Result::eSuccess)
      throw vk::DeviceLostError("waiting for an upload");
  } catch (const std::exception&) {
    wait_idle(device);
    throw;
  }
}

}  // namespace scenegen::render::vkr
