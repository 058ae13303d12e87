#include "tools/experiments/device_culling.h"

#include <array>
#include <cstring>

#include "render/spatial/frustum_cull.h"
#include "tools/experiments/cull_comp.h"

namespace scenegen::tools {

using render::vkr::MemoryUse;
using render::vkr::Use;
using Usage = vk::BufferUsageFlagBits;
using Type = vk::DescriptorType;

namespace {

struct Bounds {
  glm::vec4 lo, hi;
};
struct Constants {
  std::array<glm::vec4, 6> planes;
  std::uint32_t plane_count, count;
};

}  // namespace

DeviceCulling::DeviceCulling(DrawStage& stage)
    : stage_(stage), count_(static_cast<std::uint32_t>(stage.scene().slot_count())) {
  const vk::raii::Device& device = stage.device().device;
  std::vector<Bounds> boxes;
  std::vector<VkDrawIndexedIndirectCommand> commands;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Box box = stage.scene().boxes().get(i);
    boxes.push_back({glm::vec4(box.lo, 1.0F), glm::vec4(box.hi, 1.0F)});
    const render::GeometryRange& range = stage.gpu().range(stage.scene().primitive(i).geometry);
    commands.push_back({range.index_count, 1, range.first_index, range.vertex_offset, i});
  }
  const auto uploaded = [&](const auto& data, vk::BufferUsageFlags usage, Use use) {
    const std::uint64_t bytes = data.size() * sizeof(data[0]);
    const render::vkr::Buffer from =
        stage.memory().buffer(bytes, Usage::eTransferSrc, MemoryUse::upload, render::MemoryKind::staging);
    render::vkr::Buffer to = stage.memory().buffer(bytes, usage | Usage::eTransferDst, MemoryUse::device,
                                                   render::MemoryKind::indirect);
    std::memcpy(from.mapped(), data.data(), bytes);
    render::vkr::run_once(stage.device(), [&](const vk::raii::CommandBuffer& c) {
      c.copyBuffer(*from.buffer, *to.buffer, vk::BufferCopy(0, 0, bytes));
      render::vkr::Barriers().buffer(*to.buffer, Use::transfer_write, use).flush(c);
    });
    return to;
  };
  boxes_ = uploaded(boxes, Usage::eStorageBuffer, Use::compute_read);
  commands_ =
      uploaded(commands, Usage::eStorageBuffer | Usage::eIndirectBuffer | Usage::eTransferSrc, Use::indirect);

  std::array<vk::DescriptorSetLayoutBinding, 2> bindings;
  for (std::uint32_t i = 0; i < 2; ++i)
    bindings[i] =
        vk::DescriptorSetLayoutBinding(i, Type::eStorageBuffer, 1, vk::ShaderStageFlagBits::eCompute);
  set_layout_ = vk::raii::DescriptorSetLayout(device, vk::DescriptorSetLayoutCreateInfo({}, bindings));
  const vk::PushConstantRange constants(vk::ShaderStageFlagBits::eCompute, 0, sizeof(Constants));
  layout_ = vk::raii::PipelineLayout(device, vk::PipelineLayoutCreateInfo({}, *set_layout_, constants));
  const vk::raii::ShaderModule module(device, vk::ShaderModuleCreateInfo({}, sizeof(kCullComp), kCullComp));
  const vk::PipelineShaderStageCreateInfo part({}, vk::ShaderStageFlagBits::eCompute, *module, "main");
  pipeline_ = vk::raii::Pipeline(device, nullptr, vk::ComputePipelineCreateInfo({}, part, *layout_));
  const vk::DescriptorPoolSize size(Type::eStorageBuffer, 2);
  pool_ = vk::raii::DescriptorPool(device, vk::DescriptorPoolCreateInfo({}, 1, size));
  set_ = (*device).allocateDescriptorSets({*pool_, *set_layout_}, *device.getDispatcher()).front();
  const std::array infos{vk::DescriptorBufferInfo(*boxes_.buffer, 0, VK_WHOLE_SIZE),
                         vk::DescriptorBufferInfo(*commands_.buffer, 0, VK_WHOLE_SIZE)};
  device.updateDescriptorSets(vk::WriteDescriptorSet(set_, 0, 0, Type::eStorageBuffer, {}, infos), {});
}

void DeviceCulling::record(const render::PassContext& context) {
  const vk::raii::CommandBuffer& commands = context.frame.commands;
  const render::CullPlanes planes =
      render::cull_planes(render::frustum_of(stage_.view().clip_from_world), stage_.scene().bounds_m());
  Constants constants{{}, planes.count, count_};
  for (std::uint32_t p = 0; p < planes.count; ++p)
    constants.planes[p] = glm::vec4(planes.planes[p].n, planes.planes[p].d + planes.planes[p].slack);
  context.barriers.buffer(*commands_.buffer, Use::indirect, Use::compute_write).flush(commands);
  commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline_);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout_, 0, set_, {});
  commands.pushConstants<Constants>(*layout_, vk::ShaderStageFlagBits::eCompute, 0, constants);
  commands.dispatch((count_ + 63) / 64, 1, 1);
  context.barriers.buffer(*commands_.buffer, Use::compute_write, Use::indirect).flush(commands);
  render::PassRecording pass(context, stage_.target());
  const std::uint32_t longest = stage_.device().properties.limits.maxDrawIndirectCount;
  for (std::uint32_t first = 0; first < count_; first += std::min(longest, count_ - first)) {
    render::IndirectDraws draws;
    draws.commands = *commands_.buffer;
    draws.offset = std::uint64_t{first} * sizeof(VkDrawIndexedIndirectCommand);
    draws.count = std::min(longest, count_ - first);
    pass.draws().draw_indirect(draws);
  }
  pass.end();
}

std::uint32_t DeviceCulling::drawn() {
  const std::uint64_t bytes = count_ * sizeof(VkDrawIndexedIndirectCommand);
  const render::vkr::Buffer back =
      stage_.memory().buffer(bytes, Usage::eTransferDst, MemoryUse::readback, render::MemoryKind::readback);
  render::vkr::run_once(stage_.device(), [&](const vk::raii::CommandBuffer& c) {
    render::vkr::Barriers().buffer(*commands_.buffer, Use::compute_write, Use::transfer_read).flush(c);
    c.copyBuffer(*commands_.buffer, *back.buffer, vk::BufferCopy(0, 0, bytes));
    render::vkr::Barriers()
        .buffer(*back.buffer, Use::transfer_write, Use::host_read)
        .buffer(*commands_.buffer, Use::transfer_read, Use::indirect)
        .flush(c);
  });
  const auto* commands = reinterpret_cast<const VkDrawIndexedIndirectCommand*>(back.mapped());
  std::uint32_t out = 0;
  for (std::uint32_t s = 0; s < count_; ++s) out += commands[s].instanceCount;
  return out;
}

}  // namespace scenegen::tools
