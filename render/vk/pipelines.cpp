#include "render/vk/pipelines.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "render/shaders/box_vert.h"
#include "render/shaders/color_frag.h"
#include "render/shaders/color_listed_vert.h"
#include "render/shaders/color_vert.h"
#include "render/shaders/depth_listed_vert.h"
#include "render/shaders/depth_vert.h"
#include "render/shaders/ids_frag.h"
#include "render/shaders/shadow_frag.h"
#include "render/shaders/sky_frag.h"
#include "render/shaders/sky_vert.h"

namespace scenegen::render::vkr {
namespace {

using Samples = vk::SampleCountFlagBits;

vk::raii::ShaderModule module(const Device& device, std::span<const std::uint32_t> code) {
  return {device.device, vk::ShaderModuleCreateInfo({}, code.size_bytes(), code.data())};
}

vk::AttachmentDescription attachment(vk::Format format, Samples samples, vk::AttachmentLoadOp load,
                                     vk::AttachmentStoreOp store, vk::ImageLayout layout) {
  return {
      {},     format, samples, load, store, vk::AttachmentLoadOp::eDontCare, vk::AttachmentStoreOp::eDontCare,
      layout, layout};
}

/// One subpass; `color` may be null (depth only), `resolve` is used with several samples.
vk::raii::RenderPass make_pass(const Device& device, vk::Format color, Samples samples, bool store_depth,
                               PassPart part = PassPart::whole) {
  using Load = vk::AttachmentLoadOp;
  using Store = vk::AttachmentStoreOp;
  const bool first = part == PassPart::first;
  const Load load = part == PassPart::second ? Load::eLoad : Load::eClear;
  const bool has_color = color != vk::Format::eUndefined;
  const bool many = has_color && samples != Samples::e1;
  const bool resolves = many && !first;
  std::vector<vk::AttachmentDescription> attachments;
  attachments.push_back(attachment(kDepthFormat, samples, load,
                                   store_depth || first ? Store::eStore : Store::eDontCare,
                                   vk::ImageLayout::eDepthStencilAttachmentOptimal));
  if (has_color)
    attachments.push_back(attachment(color, samples, load, resolves ? Store::eDontCare : Store::eStore,
                                     vk::ImageLayout::eColorAttachmentOptimal));
  if (many)  // of a first part too, though unused, so that one framebuffer serves all
    attachments.push_back(attachment(color, Samples::e1, Load::eDontCare, Store::eStore,
                                     vk::ImageLayout::eColorAttachmentOptimal));
  const vk::AttachmentReference depth_ref(0, vk::ImageLayout::eDepthStencilAttachmentOptimal);
  const vk::AttachmentReference color_ref(1, vk::ImageLayout::eColorAttachmentOptimal);
  const vk::AttachmentReference resolve_ref(2, vk::ImageLayout::eColorAttachmentOptimal);
  vk::SubpassDescription subpass;
  subpass.pipelineBindPoint = vk::PipelineBindPoint::eGraphics;
  subpass.pDepthStencilAttachment = &depth_ref;
  if (has_color) subpass.setColorAttachments(color_ref);
  if (resolves) subpass.pResolveAttachments = &resolve_ref;
  return {device.device, vk::RenderPassCreateInfo({}, attachments, subpass)};
}

constexpr std::array kBindings{
    vk::VertexInputBindingDescription(0, sizeof(glm::vec3), vk::VertexInputRate::eVertex),
    vk::VertexInputBindingDescription(1, sizeof(VertexAttributes), vk::VertexInputRate::eVertex)};
constexpr std::array kAttributes{vk::VertexInputAttributeDescription(0, 0, vk::Format::eR32G32B32Sfloat, 0),
                                 vk::VertexInputAttributeDescription(1, 1, vk::Format::eR16G16B16A16Snorm,
                                                                     offsetof(VertexAttributes, normal)),
                                 vk::VertexInputAttributeDescription(2, 1, vk::Format::eR16G16B16A16Snorm,
                                                                     offsetof(VertexAttributes, tangent)),
                                 vk::VertexInputAttributeDescription(3, 1, vk::Format::eR32G32Sfloat,
                                                                     offsetof(VertexAttributes, texcoord0)),
                                 vk::VertexInputAttributeDescription(4, 1, vk::Format::eR32G32Sfloat,
                                                                     offsetof(VertexAttributes, texcoord1)),
                                 vk::VertexInputAttributeDescription(5, 1, vk::Format::eR16G16B16A16Unorm,
                                                                     offsetof(VertexAttributes, color))};

/// Of a list: the slot of an instance.
constexpr vk::VertexInputBindingDescription kListBinding(2, sizeof(std::uint32_t),
                                                         vk::VertexInputRate::eInstance);
constexpr vk::VertexInputAttributeDescription kListAttribute(6, 2, vk::Format::eR32Uint, 0);
constexpr std::array kListedBindings{kBindings[0], kBindings[1], kListBinding};
constexpr std::array kListedAttributes{kAttributes[0], kAttributes[1], kAttributes[2], kAttributes[3],
                                       kAttributes[4], kAttributes[5], kListAttribute};

/// What differs between pipelines.
struct Recipe {
  std::span<const vk::PipelineShaderStageCreateInfo> stages;
  vk::RenderPass pass;
  vk::PrimitiveTopology topology = vk::PrimitiveTopology::eTriangleList;
  Samples samples = Samples::e1;
  bool vertices = true;
  bool listed = false;
  bool color = true;
  bool write_color = true;
  bool blend = false;
  bool write_depth = true;
  vk::CompareOp compare = vk::CompareOp::eGreater;
};

vk::raii::Pipeline build(const Device& device, vk::PipelineLayout layout, const Recipe& recipe) {
  vk::PipelineVertexInputStateCreateInfo vertex_input;
  if (recipe.vertices) vertex_input = vk::PipelineVertexInputStateCreateInfo({}, kBindings, kAttributes);
  if (recipe.listed)
    vertex_input = vk::PipelineVertexInputStateCreateInfo({}, kListedBindings, kListedAttributes);
  const vk::PipelineInputAssemblyStateCreateInfo assembly({}, recipe.topology);
  vk::PipelineViewportStateCreateInfo viewport;
  viewport.viewportCount = 1;
  viewport.scissorCount = 1;
  vk::PipelineRasterizationStateCreateInfo raster;
  raster.lineWidth = 1.0F;
  vk::PipelineMultisampleStateCreateInfo multisample;
  multisample.rasterizationSamples = recipe.samples;
  const vk::PipelineDepthStencilStateCreateInfo depth({}, VK_TRUE, recipe.write_depth ? VK_TRUE : VK_FALSE,
                                                      recipe.compare);
  using Mask = vk::ColorComponentFlagBits;
  vk::PipelineColorBlendAttachmentState target;
  if (recipe.write_color) target.colorWriteMask = Mask::eR | Mask::eG | Mask::eB | Mask::eA;
  if (recipe.blend) {  // premultiplied alpha
    target.blendEnable = VK_TRUE;
    target.srcColorBlendFactor = target.srcAlphaBlendFactor = vk::BlendFactor::eOne;
    target.dstColorBlendFactor = target.dstAlphaBlendFactor = vk::BlendFactor::eOneMinusSrcAlpha;
  }
  vk::PipelineColorBlendStateCreateInfo blend;
  if (recipe.color) blend.setAttachments(target);
  constexpr std::array kDynamic{vk::DynamicState::eViewport, vk::DynamicState::eScissor,
                                vk::DynamicState::eCullMode, vk::DynamicState::eFrontFace};
  const vk::PipelineDynamicStateCreateInfo dynamic({}, kDynamic);
  vk::GraphicsPipelineCreateInfo create;
  create.setStageCount(static_cast<std::uint32_t>(recipe.stages.size())).setPStages(recipe.stages.data());
  create.pVertexInputState = &vertex_input;
  create.pInputAssemblyState = &assembly;
  create.pViewportState = &viewport;
  create.pRasterizationState = &raster;
  create.pMultisampleState = &multisample;
  create.pDepthStencilState = &depth;
  create.pColorBlendState = &blend;
  create.pDynamicState = &dynamic;
  create.layout = layout;
  create.renderPass = recipe.pass;
  return {device.device, nullptr, create};
}

vk::PrimitiveTopology topology(PrimitiveKind kind) {
  switch (kind) {
    case PrimitiveKind::lines:
      return vk::PrimitiveTopology::eLineList;
    case PrimitiveKind::points:
      return vk::PrimitiveTopology::ePointList;
    default:
      return vk::PrimitiveTopology::eTriangleList;
  }
}

}  // namespace

Pipelines::Pipelines(const Device& device, vk::SampleCountFlagBits color_samples, bool shadows)
    : device_(device), color_samples_(color_samples), shadows_(shadows) {
  using Stage = vk::ShaderStageFlagBits;
  using Type = vk::DescriptorType;
  const std::array frame_bindings{
      vk::DescriptorSetLayoutBinding(0, Type::eUniformBuffer, 1,
                                     Stage::eVertex | Stage::eFragment | Stage::eCompute),
      vk::DescriptorSetLayoutBinding(1, Type::eStorageBuffer, 1, Stage::eVertex | Stage::eCompute),
      vk::DescriptorSetLayoutBinding(2, Type::eStorageBuffer, 1, Stage::eVertex | Stage::eFragment),
      vk::DescriptorSetLayoutBinding(3, Type::eCombinedImageSampler, 1, Stage::eFragment)};
  const vk::DescriptorSetLayoutBinding texture_binding(0, Type::eCombinedImageSampler, kTextureCount,
                                                       Stage::eFragment);
  frame_set_layout_ =
      vk::raii::DescriptorSetLayout(device.device, vk::DescriptorSetLayoutCreateInfo({}, frame_bindings));
  texture_set_layout_ =
      vk::raii::DescriptorSetLayout(device.device, vk::DescriptorSetLayoutCreateInfo({}, texture_binding));
  const std::array sets{*frame_set_layout_, *texture_set_layout_};
  layout_ = vk::raii::PipelineLayout(device.device, vk::PipelineLayoutCreateInfo({}, sets));
  const vk::PushConstantRange corners(Stage::eVertex, 0, 2 * sizeof(glm::vec4));
  box_layout_ =
      vk::raii::PipelineLayout(device.device, vk::PipelineLayoutCreateInfo({}, *frame_set_layout_, corners));
  for (const PassPart part : {PassPart::whole, PassPart::first, PassPart::second}) {
    const auto i = static_cast<std::size_t>(part);
    color_passes_[i] = make_pass(device, kColorFormat, color_samples, false, part);
    ids_passes_[i] = make_pass(device, kIdFormat, Samples::e1, true, part);
  }
  shadow_pass_ = make_pass(device, vk::Format::eUndefined, Samples::e1, true);
  color_vert_ = module(device, kColorVert);
  color_listed_vert_ = module(device, kColorListedVert);
  color_frag_ = module(device, kColorFrag);
  depth_vert_ = module(device, kDepthVert);
  depth_listed_vert_ = module(device, kDepthListedVert);
  ids_frag_ = module(device, kIdsFrag);
  shadow_frag_ = module(device, kShadowFrag);
  sky_vert_ = module(device, kSkyVert);
  sky_frag_ = module(device, kSkyFrag);
  box_vert_ = module(device, kBoxVert);
  sky_ = make_sky();
}

vk::RenderPass Pipelines::render_pass(PassKind pass, PassPart part) const {
  if (pass == PassKind::shadow) return *shadow_pass_;
  return *(pass == PassKind::ids ? ids_passes_ : color_passes_)[static_cast<std::size_t>(part)];
}

vk::Pipeline Pipelines::box(PassKind pass) {
  vk::raii::Pipeline& box = pass == PassKind::color ? color_box_ : ids_box_;
  if (!*box) box = make_box(pass);
  return *box;
}

vk::Pipeline Pipelines::get(const PipelineKey& key) {
  auto found = pipelines_.find(key);
  if (found == pipelines_.end()) found = pipelines_.emplace(key, make(key)).first;
  return *found->second;
}

vk::raii::Pipeline Pipelines::make(const PipelineKey& key) const {
  struct Constants {
    std::int32_t alpha_mode;
    std::uint32_t texture_mask;
    VkBool32 shadow;
    VkBool32 shadows;
  };
  const Constants constants{static_cast<std::int32_t>(key.alpha), key.texture_mask,
                            key.pass == PassKind::shadow ? VK_TRUE : VK_FALSE, shadows_ ? VK_TRUE : VK_FALSE};
  constexpr std::array kEntries{vk::SpecializationMapEntry(0, offsetof(Constants, alpha_mode), 4),
                                vk::SpecializationMapEntry(1, offsetof(Constants, texture_mask), 4),
                                vk::SpecializationMapEntry(2, offsetof(Constants, shadow), 4),
                                vk::SpecializationMapEntry(3, offsetof(Constants, shadows), 4)};
  const vk::SpecializationInfo specialization(static_cast<std::uint32_t>(kEntries.size()), kEntries.data(),
                                              sizeof(constants), &constants);
  const bool color = key.pass == PassKind::color;
  vk::ShaderModule vertex = color ? *color_vert_ : *depth_vert_;
  if (key.listed) vertex = color ? *color_listed_vert_ : *depth_listed_vert_;
  vk::ShaderModule fragment = color ? *color_frag_ : *ids_frag_;
  if (key.pass == PassKind::shadow) fragment = *shadow_frag_;
  std::vector<vk::PipelineShaderStageCreateInfo> stages;
  stages.emplace_back(vk::PipelineShaderStageCreateFlags{}, vk::ShaderStageFlagBits::eVertex, vertex, "main",
                      &specialization);
  // Shadows of opaque things need no fragment shader at all.
  if (key.pass != PassKind::shadow || key.alpha == AlphaMode::mask)
    stages.emplace_back(vk::PipelineShaderStageCreateFlags{}, vk::ShaderStageFlagBits::eFragment, fragment,
                        "main", &specialization);
  Recipe recipe;
  recipe.stages = stages;
  recipe.listed = key.listed;
  recipe.pass = render_pass(key.pass);
  recipe.topology = topology(key.kind);
  recipe.samples = color ? color_samples_ : Samples::e1;
  recipe.color = key.pass != PassKind::shadow;
  recipe.blend = color && key.alpha == AlphaMode::blend;
  recipe.write_depth = key.alpha != AlphaMode::blend;
  return build(device_, *layout_, recipe);
}

vk::raii::Pipeline Pipelines::make_box(PassKind pass) const {
  const std::array stages{
      vk::PipelineShaderStageCreateInfo({}, vk::ShaderStageFlagBits::eVertex, *box_vert_, "main")};
  Recipe recipe;
  recipe.stages = stages;
  recipe.pass = render_pass(pass);
  recipe.samples = pass == PassKind::color ? color_samples_ : Samples::e1;
  recipe.vertices = false;
  recipe.write_color = false;
  recipe.write_depth = false;
  recipe.compare = vk::CompareOp::eGreaterOrEqual;
  return build(device_, *box_layout_, recipe);
}

vk::raii::Pipeline Pipelines::make_sky() const {
  const std::array stages{
      vk::PipelineShaderStageCreateInfo({}, vk::ShaderStageFlagBits::eVertex, *sky_vert_, "main"),
      vk::PipelineShaderStageCreateInfo({}, vk::ShaderStageFlagBits::eFragment, *sky_frag_, "main")};
  Recipe recipe;
  recipe.stages = stages;
  recipe.pass = render_pass(PassKind::color);
  recipe.samples = color_samples_;
  recipe.vertices = false;
  recipe.write_depth = false;
  recipe.compare = vk::CompareOp::eGreaterOrEqual;
  return build(device_, *layout_, recipe);
}

}  // namespace scenegen::render::vkr
