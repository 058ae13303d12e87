// What passes draw to: pictures of one size, shared by all frames in flight (the queue runs them one after
// the other).
#pragma once

#include <glm/glm.hpp>
#include <vulkan/vulkan_raii.hpp>

#include "render/vk/barrier.h"
#include "render/vk/frame_ring.h"
#include "render/vk/memory.h"
#include "render/vk/pipelines.h"

namespace scenegen::render {

/// Attachments and framebuffer of one pass.
struct Target {
  vkr::PassKind pass = vkr::PassKind::color;
  vk::Extent2D extent;
  vkr::Image depth;
  vkr::Image color;    ///< multisampled, or the result itself; none for the shadow map
  vkr::Image resolve;  ///< only with several samples
  vk::raii::Framebuffer framebuffer{nullptr};

  [[nodiscard]] bool has_color() const { return pass != vkr::PassKind::shadow; }
  [[nodiscard]] bool resolves() const { return static_cast<bool>(*resolve.image); }
  [[nodiscard]] vkr::Image& result() { return resolves() ? resolve : color; }
};

[[nodiscard]] Target make_target(const vkr::Device& device, vkr::Memory& memory,
                                 const vkr::Pipelines& pipelines, vkr::PassKind pass, vk::Extent2D extent,
                                 vk::SampleCountFlagBits samples);

/// Barriers to attachment layouts (old contents are dropped), then the pass begins: cleared, viewport set. A
/// second part keeps what the first drew. `contents` says whether draws or secondary command buffers follow;
/// those set their viewport themselves.
void begin_pass(const vk::raii::CommandBuffer& commands, const vkr::Pipelines& pipelines, Target& target,
                vkr::Barriers& barriers, vk::SubpassContents contents = vk::SubpassContents::eInline,
                vkr::PassPart part = vkr::PassPart::whole);
void set_viewport(const vk::raii::CommandBuffer& commands, vk::Extent2D extent);

/// Copies one image into a readback buffer, for the processor to read after the fence.
void record_readback(const vk::raii::CommandBuffer& commands, vkr::Image& image, const vkr::Buffer& to,
                     vkr::Barriers& barriers);

}  // namespace scenegen::render
