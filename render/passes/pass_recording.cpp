#include "render/passes/pass_recording.h"

#include <cassert>

namespace scenegen::render {

void begin_secondary(const vk::raii::CommandBuffer& commands, const vkr::Pipelines& pipelines,
                     const Target& target, vk::CommandBufferUsageFlags usage) {
  // No framebuffer: what is cached outlives a resize of everything but the viewport.
  const vk::CommandBufferInheritanceInfo inherited(pipelines.render_pass(target.pass), 0);
  commands.begin({usage | vk::CommandBufferUsageFlagBits::eRenderPassContinue, &inherited});
  set_viewport(commands, target.extent);
}

void PassRecording::begin(Form form) {
  assert(form_ == Form::not_begun || form_ == form);
  if (form_ == form) return;
  form_ = form;
  begin_pass(
      context_.frame.commands, context_.pipelines, target_, context_.barriers,
      form == Form::draws ? vk::SubpassContents::eInline : vk::SubpassContents::eSecondaryCommandBuffers,
      part_);
}

void PassRecording::end_first_part() {
  assert(part_ == vkr::PassPart::first && form_ != Form::not_begun);
  if (recorder_) {  // what it bound is not to be relied on after this
    solid_.add(recorder_->recorded());
    recorder_.reset();
  }
  context_.frame.commands.endRenderPass();
  if (target_.pass == vkr::PassKind::color) context_.frame.mark(context_.frame.commands, GpuStage::solid);
  part_ = vkr::PassPart::second;
  form_ = Form::not_begun;
}

DrawRecorder& PassRecording::draws() {
  begin(Form::draws);
  if (!recorder_)
    recorder_.emplace(context_.frame.commands, context_.pipelines, context_.gpu, context_.scene,
                      target_.pass);
  return *recorder_;
}

void PassRecording::execute(std::span<const vk::CommandBuffer> secondaries, const Recorded& held) {
  begin(Form::secondaries);
  if (!secondaries.empty()) {
    (*context_.frame.commands)
        .executeCommands(static_cast<std::uint32_t>(secondaries.size()), secondaries.data(),
                         *context_.frame.commands.getDispatcher());
  }
  solid_.add(held);
}

const vk::raii::CommandBuffer& PassRecording::rest() {
  assert(form_ != Form::not_begun);
  if (form_ == Form::draws) return context_.frame.commands;
  if (rest_ == nullptr) {
    rest_ = &context_.frame.secondary(context_.device);
    begin_secondary(*rest_, context_.pipelines, target_, vk::CommandBufferUsageFlagBits::eOneTimeSubmit);
  }
  return *rest_;
}

void PassRecording::end() {
  if (form_ == Form::not_begun) begin(Form::draws);
  if (rest_ != nullptr) {
    rest_->end();
    context_.frame.commands.executeCommands(**rest_);
  }
  context_.frame.commands.endRenderPass();
}

}  // namespace scenegen::render
