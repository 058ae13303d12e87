#include "render/passes/targets.h"

#include <array>
#include <vector>

namespace scenegen::render {

using vkr::Use;

Target make_target(const vkr::Device& device, vkr::Memory& memory, const vkr::Pipelines& pipelines,
                   vkr::PassKind pass, vk::Extent2D extent, vk::SampleCountFlagBits samples) {
  using Usage = vk::ImageUsageFlagBits;
  Target t;
  t.pass = pass;
  t.extent = extent;
  vk::ImageUsageFlags depth_usage = Usage::eDepthStencilAttachment;
  if (pass == vkr::PassKind::shadow || vkr::can_sample_depth(device, samples)) depth_usage |= Usage::eSampled;
  if (pass == vkr::PassKind::ids) depth_usage |= Usage::eTransferSrc;
  t.depth = memory.image({vkr::kDepthFormat, extent, 1, samples, depth_usage});
  std::vector<vk::ImageView> views{*t.depth.view};
  if (t.has_color()) {
    const bool many = samples != vk::SampleCountFlagBits::e1;
    const vk::Format format = pass == vkr::PassKind::ids ? vkr::kIdFormat : vkr::kColorFormat;
    const vk::ImageUsageFlags result_usage = Usage::eColorAttachment | Usage::eTransferSrc;
    t.color = memory.image(
        {format, extent, 1, samples, many ? vk::ImageUsageFlags{Usage::eColorAttachment} : result_usage});
    views.push_back(*t.color.view);
    if (many) {
      t.resolve = memory.image({format, extent, 1, vk::SampleCountFlagBits::e1, result_usage});
      views.push_back(*t.resolve.view);
    }
  }
  t.framebuffer = vk::raii::Framebuffer(
      device.device,
      vk::FramebufferCreateInfo({}, pipelines.render_pass(pass), views, extent.width, extent.height, 1));
  return t;
}

void begin_pass(const vk::raii::CommandBuffer& commands, const vkr::Pipelines& pipelines, Target& target,
                vkr::Barriers& barriers, vk::SubpassContents contents, vkr::PassPart part) {
  if (part == vkr::PassPart::second) {
    barriers.image(target.depth, Use::depth_attachment).image(target.color, Use::color_attachment);
  } else {
    barriers.discard(target.depth, Use::depth_attachment);
    if (target.has_color()) barriers.discard(target.color, Use::color_attachment);
  }
  if (target.resolves()) barriers.discard(target.resolve, Use::color_attachment);
  barriers.flush(commands);

  const vk::ClearValue far{vk::ClearDepthStencilValue(0.0F, 0)};
  vk::ClearValue background{vk::ClearColorValue(std::array{0.0F, 0.0F, 0.0F, 1.0F})};
  if (target.pass == vkr::PassKind::ids)
    background = vk::ClearValue{vk::ClearColorValue(std::array{0xFFFFFFFFU, 0U, 0U, 0U})};
  const std::array clears{far, background};
  const vk::Rect2D area({0, 0}, target.extent);
  commands.beginRenderPass(
      vk::RenderPassBeginInfo(pipelines.render_pass(target.pass, part), *target.framebuffer, area, clears),
      contents);
  if (contents == vk::SubpassContents::eInline) set_viewport(commands, target.extent);
}

void set_viewport(const vk::raii::CommandBuffer& commands, vk::Extent2D extent) {
  commands.setViewport(0, vk::Viewport(0.0F, 0.0F, static_cast<float>(extent.width),
                                       static_cast<float>(extent.height), 0.0F, 1.0F));
  commands.setScissor(0, vk::Rect2D({0, 0}, extent));
}

void record_readback(const vk::raii::CommandBuffer& commands, vkr::Image& image, const vkr::Buffer& to,
                     vkr::Barriers& barriers) {
  barriers.image(image, Use::transfer_read).flush(commands);
  const vk::BufferImageCopy region(0, 0, 0, {image.aspect, 0, 0, 1}, {0, 0, 0},
                                   vk::Extent3D(image.extent, 1));
  commands.copyImageToBuffer(*image.image, vk::ImageLayout::eTransferSrcOptimal, *to.buffer, region);
  barriers.buffer(*to.buffer, Use::transfer_write, Use::host_read).flush(commands);
}

}  // namespace scenegen::render
