// One pass of a frame while it is recorded: draws into the primary command buffer, or secondary command
// buffers executed from it. The two do not mix inside one render pass, so what comes last (sky, blended
// objects) goes into a secondary of this frame in the second case.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vulkan/vulkan_raii.hpp>

#include "render/passes/draw_recorder.h"
#include "render/passes/targets.h"
#include "render/vk/frame_ring.h"

namespace scenegen::render {

/// What recording needs, the same for all passes of a frame.
struct PassContext {
  const vkr::Device& device;
  vkr::Memory& memory;
  vkr::Pipelines& pipelines;
  const GpuScene& gpu;
  const DrawScene& scene;
  vkr::Frame& frame;
  vkr::Barriers& barriers;
  std::uint64_t completed = 0;         ///< serial of the last frame that the device is done with
  std::uint32_t frames_in_flight = 1;  ///< frame n - this many is done when frame n is recorded
};

/// Begins a secondary command buffer that runs inside `pass`: it inherits nothing but the attachments.
void begin_secondary(const vk::raii::CommandBuffer& commands, const vkr::Pipelines& pipelines,
                     const Target& target, vk::CommandBufferUsageFlags usage);

class PassRecording {
 public:
  PassRecording(const PassContext& context, Target& target) : context_(context), target_(target) {}

  /// Draws of solid objects into the primary: the pass begins with the first call.
  [[nodiscard]] DrawRecorder& draws();
  /// Cached secondaries instead, in order. `held` is what they hold, for the report.
  void execute(std::span<const vk::CommandBuffer> secondaries, const Recorded& held);
  /// The pass will have two parts: to be said before anything is executed.
  void in_two_parts() { part_ = vkr::PassPart::first; }
  /// Takes that back, before the pass has begun.
  void in_one_part() { part_ = vkr::PassPart::whole; }
  [[nodiscard]] bool begun() const { return form_ != Form::not_begun || in_second_part(); }
  /// Ends the first part; what is not allowed inside a pass can be recorded now, into
  /// context().frame.commands.
  void end_first_part();
  [[nodiscard]] bool in_second_part() const { return part_ == vkr::PassPart::second; }
  /// Where to record what comes after the solid objects. State of earlier draws is not to be relied on.
  [[nodiscard]] const vk::raii::CommandBuffer& rest();
  /// Ends the pass.
  void end();

  [[nodiscard]] const PassContext& context() const { return context_; }
  [[nodiscard]] const Target& target() const { return target_; }
  [[nodiscard]] Target& target() { return target_; }
  [[nodiscard]] Recorded solid() const {
    Recorded all = solid_;
    if (recorder_) all.add(recorder_->recorded());
    return all;
  }

 private:
  enum class Form : std::uint8_t { not_begun, draws, secondaries };
  void begin(Form form);

  PassContext context_;
  Target& target_;
  Form form_ = Form::not_begun;
  vkr::PassPart part_ = vkr::PassPart::whole;
  std::optional<DrawRecorder> recorder_;
  const vk::raii::CommandBuffer* rest_ = nullptr;
  Recorded solid_;
};

}  // namespace scenegen::render
