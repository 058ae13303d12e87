// Render passes, pipeline layouts and pipelines; pipelines are made when first needed.
#pragma once

#include <compare>
#include <map>
#include <vulkan/vulkan_raii.hpp>

#include "render/draw_scene.h"
#include "render/vk/device.h"

namespace scenegen::render::vkr {

constexpr vk::Format kColorFormat = vk::Format::eR8G8B8A8Srgb;
constexpr vk::Format kIdFormat = vk::Format::eR32Uint;
constexpr vk::Format kDepthFormat = vk::Format::eD32Sfloat;

/// A pass can be drawn whole, or in two parts with something between them that is no drawing: the first
/// clears and stores, the second loads and resolves. Commands recorded for one run in all of them.
enum class PassPart : std::uint8_t { whole, first, second };

enum class PassKind : std::uint8_t { color, ids, shadow };

struct PipelineKey {
  PassKind pass = PassKind::color;
  AlphaMode alpha = AlphaMode::opaque;
  PrimitiveKind kind = PrimitiveKind::triangles;
  std::uint32_t texture_mask = 0;  ///< bit i: samples texture i (kTexture…); kTangents
  bool listed = false;             ///< slots come from a third vertex buffer, a 32-bit number an instance
  friend auto operator<=>(const PipelineKey&, const PipelineKey&) = default;
};

/// Layouts are in attachment layout before and after every pass: transitions are the barrier helper's
/// business. VkRenderPass rather than dynamic rendering: the validation layer's synchronization checks cover
/// it.
class Pipelines {
 public:
  /// `shadows`: colour passes read the shadow map.
  Pipelines(const Device& device, vk::SampleCountFlagBits color_samples, bool shadows);

  [[nodiscard]] vk::RenderPass render_pass(PassKind pass, PassPart part = PassPart::whole) const;
  [[nodiscard]] vk::PipelineLayout layout() const { return *layout_; }
  [[nodiscard]] vk::DescriptorSetLayout frame_set_layout() const { return *frame_set_layout_; }
  [[nodiscard]] vk::DescriptorSetLayout texture_set_layout() const { return *texture_set_layout_; }
  [[nodiscard]] vk::Pipeline get(const PipelineKey& key);
  [[nodiscard]] vk::Pipeline sky() const { return *sky_; }
  /// Draws a box given by two push constants (vec4 lo, hi) for an occlusion query: both sides, nothing
  /// written, equal depth passes. Not for the shadow pass.
  [[nodiscard]] vk::Pipeline box(PassKind pass);
  [[nodiscard]] vk::PipelineLayout box_layout() const { return *box_layout_; }

 private:
  [[nodiscard]] vk::raii::Pipeline make(const PipelineKey& key) const;
  [[nodiscard]] vk::raii::Pipeline make_sky() const;
  [[nodiscard]] vk::raii::Pipeline make_box(PassKind pass) const;

  const Device& device_;
  vk::SampleCountFlagBits color_samples_;
  bool shadows_;
  vk::raii::DescriptorSetLayout frame_set_layout_{nullptr};
  vk::raii::DescriptorSetLayout texture_set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  vk::raii::PipelineLayout box_layout_{nullptr};
  vk::raii::RenderPass color_passes_[3]{nullptr, nullptr, nullptr}, ids_passes_[3]{nullptr, nullptr, nullptr};
  vk::raii::RenderPass shadow_pass_{nullptr};
  vk::raii::ShaderModule color_vert_{nullptr}, color_listed_vert_{nullptr}, color_frag_{nullptr},
      depth_vert_{nullptr}, depth_listed_vert_{nullptr}, ids_frag_{nullptr}, shadow_frag_{nullptr},
      sky_vert_{nullptr}, sky_frag_{nullptr}, box_vert_{nullptr};
  std::map<PipelineKey, vk::raii::Pipeline> pipelines_;
  vk::raii::Pipeline sky_{nullptr}, color_box_{nullptr}, ids_box_{nullptr};
};

}  // namespace scenegen::render::vkr
