#include "render/passes/hi_z.h"

#include <algorithm>
#include <cstring>

#include "render/shaders/hi_z_cull_comp.h"
#include "render/shaders/hi_z_pyramid_comp.h"
#include "render/shaders/hi_z_pyramid_depth_comp.h"
#include "render/shaders/hi_z_pyramid_samples_comp.h"

namespace scenegen::render {

using vkr::Use;
using Usage = vk::BufferUsageFlagBits;

namespace {

constexpr std::uint64_t kCommandBytes = sizeof(VkDrawIndexedIndirectCommand);
constexpr std::uint32_t kCommandWords = kCommandBytes / sizeof(std::uint32_t);
constexpr std::uint32_t kCullBuffers = 10;         // that hi_z_cull.comp binds
constexpr std::uint32_t kMostGroupsInRow = 65535;  // every device takes as many
constexpr std::uint32_t kLevelsAtOnce = 5;
/// Levels above this say nothing more: a box's footprint is looked up in at most 4 x 4 texels.
constexpr std::uint32_t kSmallestLevel = 4;

struct PyramidConstants {
  std::uint32_t size[2] = {0, 0};
  std::uint32_t source_offset = 0;
  std::uint32_t offset = 0;
  std::uint32_t levels = 0;
};

vk::Extent2D half(vk::Extent2D size) {
  return {(size.width + 1) / 2, (size.height + 1) / 2};
}

/// Number of levels and texels in all of them; level 0 has one for each pixel.
std::pair<std::uint32_t, std::uint64_t> pyramid_of(vk::Extent2D size) {
  std::uint32_t levels = 1;
  std::uint64_t texels = std::uint64_t{size.width} * size.height;
  do {
    size = half(size);
    texels += std::uint64_t{size.width} * size.height;
    ++levels;
  } while (std::max(size.width, size.height) > kSmallestLevel);
  return {levels, texels};
}

vk::raii::Pipeline compute_pipeline(const vkr::Device& device, vk::PipelineLayout layout,
                                    std::span<const std::uint32_t> code,
                                    const vk::SpecializationInfo* specialization = nullptr) {
  const vk::raii::ShaderModule module(device.device,
                                      vk::ShaderModuleCreateInfo({}, code.size_bytes(), code.data()));
  const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main",
                                                specialization);
  return {device.device, nullptr, vk::ComputePipelineCreateInfo({}, stage, layout)};
}

/// Commands of a part: one a block, behind those one more a block where some draw mirrored slots.
std::uint32_t commands_of(const HiZLayout& layout) {
  return static_cast<std::uint32_t>(layout.blocks.size()) * (layout.mirrored ? 2 : 1);
}

/// Memory that the processor writes, on the device where it can be mapped there.
vkr::Buffer written(vkr::Memory& memory, std::uint64_t bytes) {
  bytes = std::max<std::uint64_t>(bytes, sizeof(std::uint32_t));
  vkr::Buffer out = memory.buffer(bytes, Usage::eStorageBuffer, vkr::MemoryUse::written, MemoryKind::lists);
  if (out.mapped() == nullptr)
    out = memory.buffer(bytes, Usage::eStorageBuffer, vkr::MemoryUse::upload, MemoryKind::lists);
  return out;
}

template <class T>
vkr::Buffer table(vkr::Memory& memory, std::span<const T> values) {
  vkr::Buffer out = written(memory, values.size_bytes());
  if (!values.empty()) std::memcpy(out.mapped(), values.data(), values.size_bytes());
  return out;
}

}  // namespace

HiZ::HiZ(const PassContext& context, const Target& target, const HiZLayout& layout) : layout_(layout) {
  bit_words_ = context.scene.visible().words().size() * 2;
  const std::uint64_t slots = std::max<std::uint64_t>(context.scene.solid_end(), 1);
  const std::uint64_t seen_words =
      std::max<std::uint64_t>(std::uint64_t{layout.blocks.size()} * layout.block_slots / 32, 1);
  const auto on_device = [&](std::uint64_t bytes, vk::BufferUsageFlags usage) {
    return context.memory.buffer(bytes, Usage::eStorageBuffer | usage, vkr::MemoryUse::device,
                                 MemoryKind::lists);
  };
  blocks_ = table(context.memory, std::span(layout.blocks));
  groups_ = table(context.memory, std::span(layout.groups));
  slots_ = table(context.memory, std::span(layout.slots));
  seen_ = on_device(seen_words * sizeof(std::uint32_t), Usage::eTransferDst);
  list_ = on_device(slots * sizeof(std::uint32_t), Usage::eVertexBuffer);
  longest_run_ = std::max(context.device.properties.limits.maxDrawIndirectCount, 1U);
  commands_ =
      on_device(2 * std::max<std::uint64_t>(commands_of(layout), 1) * kCommandBytes, Usage::eIndirectBuffer);
  counts_ = on_device(sizeof(HiZCounts), Usage::eTransferDst | Usage::eTransferSrc);
  for (std::uint32_t i = 0; i < context.frames_in_flight; ++i) {
    places_[i].bits = written(context.memory, 2 * bit_words_ * sizeof(std::uint32_t));
    places_[i].order = written(context.memory, layout.blocks.size() * sizeof(std::uint32_t));
    places_[i].counts = context.memory.buffer(sizeof(HiZCounts), Usage::eTransferDst,
                                              vkr::MemoryUse::readback, MemoryKind::lists);
  }
  make_cull(context);
  make_pyramid(context, target);
  resized(context, target);
}

void HiZ::make_cull(const PassContext& context) {
  using Type = vk::DescriptorType;
  const vkr::Device& device = context.device;
  std::array<vk::DescriptorSetLayoutBinding, kCullBuffers> bindings;
  for (std::uint32_t i = 0; i < bindings.size(); ++i)
    bindings[i] =
        vk::DescriptorSetLayoutBinding(i, Type::eStorageBuffer, 1, vk::ShaderStageFlagBits::eCompute);
  cull_set_layout_ =
      vk::raii::DescriptorSetLayout(device.device, vk::DescriptorSetLayoutCreateInfo({}, bindings));
  const std::array sets{context.pipelines.frame_set_layout(), *cull_set_layout_};
  const vk::PushConstantRange constants(vk::ShaderStageFlagBits::eCompute, 0, sizeof(HiZConstants));
  cull_layout_ = vk::raii::PipelineLayout(device.device, vk::PipelineLayoutCreateInfo({}, sets, constants));
  const vk::SpecializationMapEntry entry(3, 0, sizeof(std::uint32_t));
  const vk::SpecializationInfo specialization(1, &entry, sizeof(std::uint32_t), &layout_.block_slots);
  cull_ = compute_pipeline(device, *cull_layout_, kHiZCullComp, &specialization);
  const std::array sizes{vk::DescriptorPoolSize(Type::eStorageBuffer, kCullBuffers * kMostFramesInFlight + 1),
                         vk::DescriptorPoolSize(Type::eCombinedImageSampler, 1)};
  pool_ = vk::raii::DescriptorPool(device.device,
                                   vk::DescriptorPoolCreateInfo({}, kMostFramesInFlight + 1, sizes));
  for (std::uint32_t i = 0; i < context.frames_in_flight; ++i)
    places_[i].set = (*device.device)
                         .allocateDescriptorSets({*pool_, *cull_set_layout_}, *device.device.getDispatcher())
                         .front();
}

void HiZ::make_pyramid(const PassContext& context, const Target& target) {
  using Type = vk::DescriptorType;
  using Stage = vk::ShaderStageFlagBits;
  const vkr::Device& device = context.device;
  const std::array bindings{
      vk::DescriptorSetLayoutBinding(0, Type::eStorageBuffer, 1, Stage::eCompute),
      vk::DescriptorSetLayoutBinding(1, Type::eCombinedImageSampler, 1, Stage::eCompute)};
  pyramid_set_layout_ =
      vk::raii::DescriptorSetLayout(device.device, vk::DescriptorSetLayoutCreateInfo({}, bindings));
  const vk::PushConstantRange constants(Stage::eCompute, 0, sizeof(PyramidConstants));
  pyramid_layout_ = vk::raii::PipelineLayout(
      device.device, vk::PipelineLayoutCreateInfo({}, *pyramid_set_layout_, constants));
  first_levels_ = target.resolves() ? compute_pipeline(device, *pyramid_layout_, kHiZPyramidSamplesComp)
                                    : compute_pipeline(device, *pyramid_layout_, kHiZPyramidDepthComp);
  more_levels_ = compute_pipeline(device, *pyramid_layout_, kHiZPyramidComp);
  pyramid_set_ = (*device.device)
                     .allocateDescriptorSets({*pool_, *pyramid_set_layout_}, *device.device.getDispatcher())
                     .front();
  sampler_ = vk::raii::Sampler(device.device, vk::SamplerCreateInfo());  // texels are fetched, not filtered
}

void HiZ::resized(const PassContext& context, const Target& target) {
  extent_ = target.extent;
  const auto [levels, texels] = pyramid_of(extent_);
  levels_ = levels;
  pyramid_ = {};
  pyramid_ = context.memory.buffer(texels * sizeof(float), Usage::eStorageBuffer, vkr::MemoryUse::device,
                                   MemoryKind::targets);
  using Type = vk::DescriptorType;
  const vk::DescriptorImageInfo depth(*sampler_, *target.depth.view,
                                      vk::ImageLayout::eDepthStencilReadOnlyOptimal);
  const vk::DescriptorBufferInfo pyramid(*pyramid_.buffer, 0, VK_WHOLE_SIZE);
  context.device.device.updateDescriptorSets(
      {vk::WriteDescriptorSet(pyramid_set_, 0, 0, Type::eStorageBuffer, {}, pyramid),
       vk::WriteDescriptorSet(pyramid_set_, 1, 0, Type::eCombinedImageSampler, depth, {})},
      {});
  for (std::uint32_t i = 0; i < context.frames_in_flight; ++i) {
    std::array<vk::DescriptorBufferInfo, kCullBuffers> infos;
    const std::array buffers{&blocks_,   &groups_,  &places_[i].bits, &seen_,  &list_,
                             &commands_, &pyramid_, &counts_,         &slots_, &places_[i].order};
    for (std::size_t b = 0; b < buffers.size(); ++b)
      infos[b] = vk::DescriptorBufferInfo(*buffers[b]->buffer, 0, VK_WHOLE_SIZE);
    context.device.device.updateDescriptorSets(
        vk::WriteDescriptorSet(places_[i].set, 0, 0, Type::eStorageBuffer, {}, infos), {});
  }
}

std::uint64_t HiZ::write_slots(const PassContext& context, std::uint64_t revision) {
  Place& p = place(context);
  if (p.revision == revision) return 0;
  const auto visible = context.scene.visible().words();
  const auto mirrored = context.scene.mirrored_slots().words();
  std::memcpy(p.bits.mapped(), visible.data(), visible.size_bytes());
  std::memcpy(p.bits.mapped() + visible.size_bytes(), mirrored.data(), mirrored.size_bytes());
  p.revision = revision;
  return visible.size_bytes() + mirrored.size_bytes();
}

std::uint64_t HiZ::write_order(const PassContext& context, const HiZOrder& order) {
  const auto blocks = order.blocks();
  in_order_ = static_cast<std::uint32_t>(blocks.size());
  if (!blocks.empty()) std::memcpy(place(context).order.mapped(), blocks.data(), blocks.size_bytes());
  return blocks.size_bytes();
}

void HiZ::build_pyramid(const PassContext& context, Target& target) {
  const vk::raii::CommandBuffer& commands = context.frame.commands;
  context.barriers.image(target.depth, Use::compute_sampled)
      .buffer(*pyramid_.buffer, Use::compute_read, Use::compute_write)
      .flush(commands);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *pyramid_layout_, 0, pyramid_set_, {});
  vk::Extent2D size = extent_;
  PyramidConstants constants;
  constants.offset = size.width * size.height;
  for (std::uint32_t done = 1; done < levels_; done += constants.levels) {
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, done == 1 ? *first_levels_ : *more_levels_);
    constants.size[0] = size.width;
    constants.size[1] = size.height;
    constants.levels = std::min(kLevelsAtOnce, levels_ - done);
    commands.pushConstants<PyramidConstants>(*pyramid_layout_, vk::ShaderStageFlagBits::eCompute, 0,
                                             constants);
    const vk::Extent2D first = half(size);
    commands.dispatch((first.width + 15) / 16, (first.height + 15) / 16, 1);
    for (std::uint32_t i = 0; i < constants.levels; ++i) {
      size = half(size);
      constants.source_offset = constants.offset;
      constants.offset += size.width * size.height;
    }
    context.barriers.buffer(*pyramid_.buffer, Use::compute_write, Use::compute_read).flush(commands);
  }
}

void HiZ::cull(const PassContext& context, Target& target, std::uint32_t part) {
  if (layout_.blocks.empty()) return;
  const vk::raii::CommandBuffer& commands = context.frame.commands;
  vkr::Barriers& barriers = context.barriers;
  if (part == 0) {
    // What the frame before drew from, it is done with; its counts were copied.
    barriers.buffer(*counts_.buffer, Use::transfer_read, Use::transfer_write);
    if (!cleared_) barriers.buffer(*seen_.buffer, Use::none, Use::transfer_write);
    barriers.flush(commands);
    commands.fillBuffer(*counts_.buffer, 0, VK_WHOLE_SIZE, 0);
    if (!cleared_) commands.fillBuffer(*seen_.buffer, 0, VK_WHOLE_SIZE, 0);
    barriers.buffer(*counts_.buffer, Use::transfer_write, Use::compute_update);
    if (!cleared_) barriers.buffer(*seen_.buffer, Use::transfer_write, Use::compute_update);
    cleared_ = true;
  } else {
    build_pyramid(context, target);
    barriers.buffer(*counts_.buffer, Use::compute_update, Use::compute_update);
  }
  barriers.buffer(*seen_.buffer, Use::compute_update, Use::compute_update)
      .buffer(*list_.buffer, Use::shader_data, Use::compute_write)
      .buffer(*commands_.buffer, Use::indirect, Use::compute_write)
      .flush(commands);

  HiZConstants constants{};
  constants.size_px = {extent_.width, extent_.height};
  constants.levels = levels_;
  constants.part = part;
  constants.blocks = in_order_;
  constants.groups_x = std::clamp(in_order_, 1U, kMostGroupsInRow);
  constants.bit_words = static_cast<std::uint32_t>(bit_words_);
  constants.command_words = kCommandWords * commands_of(layout_);
  constants.mirrored_words = kCommandWords * static_cast<std::uint32_t>(layout_.blocks.size());
  commands.bindPipeline(vk::PipelineBindPoint::eCompute, *cull_);
  context.gpu.bind_frame_set(commands, *cull_layout_, vk::PipelineBindPoint::eCompute);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *cull_layout_, 1, place(context).set, {});
  commands.pushConstants<HiZConstants>(*cull_layout_, vk::ShaderStageFlagBits::eCompute, 0, constants);
  commands.dispatch(constants.groups_x, (in_order_ + constants.groups_x - 1) / constants.groups_x, 1);
  barriers.buffer(*list_.buffer, Use::compute_write, Use::shader_data)
      .buffer(*commands_.buffer, Use::compute_write, Use::indirect);
  if (part == 1) barriers.buffer(*counts_.buffer, Use::compute_update, Use::transfer_read);
  barriers.flush(commands);
  if (part == 1) copy_counts(context);
}

void HiZ::copy_counts(const PassContext& context) {
  Place& p = place(context);
  p.counted = context.frame.serial;
  context.frame.commands.copyBuffer(*counts_.buffer, *p.counts.buffer,
                                    vk::BufferCopy(0, 0, sizeof(HiZCounts)));
  context.barriers.buffer(*p.counts.buffer, Use::transfer_write, Use::host_read)
      .flush(context.frame.commands);
}

void HiZ::draw(DrawRecorder& recorder, const HiZOrder& order, std::uint32_t part) const {
  if (layout_.blocks.empty()) return;
  recorder.read_slots_from(*list_.buffer);
  const std::uint64_t begin = std::uint64_t{part} * commands_of(layout_);
  for (std::size_t r = 0; r < layout_.runs.size(); ++r) {
    const auto [first, count] = order.parts()[r];
    for (const bool mirrored : {false, true}) {
      if (mirrored && !layout_.runs[r].mirrored) continue;
      const std::uint64_t at = begin + (mirrored ? layout_.blocks.size() : 0) + first;
      for (std::uint32_t done = 0; done < count; done += longest_run_)
        recorder.draw_listed_indirect({layout_.runs[r].batch, mirrored, *commands_.buffer,
                                       (at + done) * kCommandBytes, std::min(longest_run_, count - done)});
    }
  }
}

HiZCounts HiZ::counts(std::uint64_t serial, std::uint32_t frames_in_flight) const {
  HiZCounts out;
  const Place& p = places_[serial % frames_in_flight];
  if (p.counted == serial) std::memcpy(&out, p.counts.mapped(), sizeof(out));
  return out;
}

}  // namespace scenegen::render
