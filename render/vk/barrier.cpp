#include "render/vk/barrier.h"

namespace scenegen::render::vkr {
namespace {

using Stage = vk::PipelineStageFlagBits2;
using Access = vk::AccessFlagBits2;

bool writes(Use use) {
  return use == Use::transfer_write || use == Use::compute_write || use == Use::compute_update ||
         use == Use::color_attachment || use == Use::depth_attachment;
}

}  // namespace

UseScope scope_of(Use use) {
  switch (use) {
    case Use::none:
      return {Stage::eNone, Access::eNone, vk::ImageLayout::eUndefined};
    case Use::transfer_read:
      return {Stage::eAllTransfer, Access::eTransferRead, vk::ImageLayout::eTransferSrcOptimal};
    case Use::transfer_write:
      return {Stage::eAllTransfer, Access::eTransferWrite, vk::ImageLayout::eTransferDstOptimal};
    case Use::shader_data:
      return {Stage::eVertexInput | Stage::eVertexShader | Stage::eFragmentShader | Stage::eComputeShader,
              Access::eIndexRead | Access::eVertexAttributeRead | Access::eUniformRead |
                  Access::eShaderStorageRead,
              vk::ImageLayout::eUndefined};
    case Use::sampled:
      return {Stage::eFragmentShader, Access::eShaderSampledRead, vk::ImageLayout::eShaderReadOnlyOptimal};
    case Use::color_attachment:
      return {Stage::eColorAttachmentOutput, Access::eColorAttachmentRead | Access::eColorAttachmentWrite,
              vk::ImageLayout::eColorAttachmentOptimal};
    case Use::depth_attachment:
      return {Stage::eEarlyFragmentTests | Stage::eLateFragmentTests,
              Access::eDepthStencilAttachmentRead | Access::eDepthStencilAttachmentWrite,
              vk::ImageLayout::eDepthStencilAttachmentOptimal};
    case Use::compute_read:
      return {Stage::eComputeShader, Access::eShaderStorageRead, vk::ImageLayout::eUndefined};
    case Use::compute_write:
      return {Stage::eComputeShader, Access::eShaderStorageWrite, vk::ImageLayout::eUndefined};
    case Use::compute_update:
      return {Stage::eComputeShader, Access::eShaderStorageRead | Access::eShaderStorageWrite,
              vk::ImageLayout::eUndefined};
    case Use::compute_sampled:
      return {Stage::eComputeShader, Access::eShaderSampledRead,
              vk::ImageLayout::eDepthStencilReadOnlyOptimal};
    case Use::predicate:
      return {Stage::eConditionalRenderingEXT, Access::eConditionalRenderingReadEXT,
              vk::ImageLayout::eUndefined};
    case Use::indirect:
      return {Stage::eDrawIndirect, Access::eIndirectCommandRead, vk::ImageLayout::eUndefined};
    case Use::host_read:
      return {Stage::eHost, Access::eHostRead, vk::ImageLayout::eUndefined};
  }
  return {};
}

Barriers& Barriers::buffer(vk::Buffer buffer, Use before, Use after) {
  const UseScope from = scope_of(before);
  const UseScope to = scope_of(after);
  // A read before a write needs order only, no memory made visible.
  const vk::AccessFlags2 made_available = writes(before) ? from.access : vk::AccessFlags2{};
  buffers_.emplace_back(from.stages, made_available, to.stages, to.access, VK_QUEUE_FAMILY_IGNORED,
                        VK_QUEUE_FAMILY_IGNORED, buffer, 0, VK_WHOLE_SIZE);
  return *this;
}

void Barriers::add_image(vk::Image image, const vk::ImageSubresourceRange& range, Use before, Use after) {
  const UseScope from = scope_of(before);
  const UseScope to = scope_of(after);
  const vk::AccessFlags2 made_available = writes(before) ? from.access : vk::AccessFlags2{};
  images_.emplace_back(from.stages, made_available, to.stages, to.access, from.layout, to.layout,
                       VK_QUEUE_FAMILY_IGNORED, VK_QUEUE_FAMILY_IGNORED, image, range);
}

Barriers& Barriers::image(Image& image, Use after) {
  add_image(*image.image, {image.aspect, 0, VK_REMAINING_MIP_LEVELS, 0, 1}, image.last_use, after);
  image.last_use = after;
  return *this;
}

Barriers& Barriers::discard(Image& image, Use after) {
  this->image(image, after).images_.back().oldLayout = vk::ImageLayout::eUndefined;
  return *this;
}

Barriers& Barriers::image_levels(vk::Image image, std::uint32_t first_level, std::uint32_t levels, Use before,
                                 Use after) {
  add_image(image, {vk::ImageAspectFlagBits::eColor, first_level, levels, 0, 1}, before, after);
  return *this;
}

std::span<const vk::MemoryBarrier2> Barriers::memory() const {
  static const vk::MemoryBarrier2 all(Stage::eAllCommands, Access::eMemoryRead | Access::eMemoryWrite,
                                      Stage::eAllCommands, Access::eMemoryRead | Access::eMemoryWrite);
  return {&all, everywhere_ ? std::size_t{1} : 0};
}

void Barriers::flush(const vk::raii::CommandBuffer& commands) {
  const std::span<const vk::MemoryBarrier2> all = memory();
  if (all.empty() && buffers_.empty() && images_.empty()) return;
  commands.pipelineBarrier2(vk::DependencyInfo({}, all, buffers_, images_));
  buffers_.clear();
  images_.clear();
}

}  // namespace scenegen::render::vkr
