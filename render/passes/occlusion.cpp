#include "render/passes/occlusion.h"

#include <algorithm>
#include <cstring>

#include "render/shaders/scatter_comp.h"

namespace scenegen::render {

using vkr::Use;
using Usage = vk::BufferUsageFlagBits;

Occlusion::Occlusion(const vkr::Device& device, bool predicates)
    : device_(device), with_predicates_(predicates) {
  if (with_predicates_) make_scatter();
}

void Occlusion::make_scatter() {
  using Type = vk::DescriptorType;
  std::array<vk::DescriptorSetLayoutBinding, 3> bindings;
  for (std::uint32_t i = 0; i < 3; ++i)
    bindings[i] =
        vk::DescriptorSetLayoutBinding(i, Type::eStorageBuffer, 1, vk::ShaderStageFlagBits::eCompute);
  set_layout_ =
      vk::raii::DescriptorSetLayout(device_.device, vk::DescriptorSetLayoutCreateInfo({}, bindings));
  const vk::PushConstantRange count(vk::ShaderStageFlagBits::eCompute, 0, sizeof(std::uint32_t));
  layout_ = vk::raii::PipelineLayout(device_.device, vk::PipelineLayoutCreateInfo({}, *set_layout_, count));
  const vk::raii::ShaderModule module(device_.device,
                                      vk::ShaderModuleCreateInfo({}, sizeof(kScatterComp), kScatterComp));
  const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main");
  scatter_ = vk::raii::Pipeline(device_.device, nullptr, vk::ComputePipelineCreateInfo({}, stage, *layout_));
  const vk::DescriptorPoolSize size(Type::eStorageBuffer, 3 * kMostFramesInFlight);
  pool_ =
      vk::raii::DescriptorPool(device_.device, vk::DescriptorPoolCreateInfo({}, kMostFramesInFlight, size));
  for (Place& p : places_)
    p.set = (*device_.device)
                .allocateDescriptorSets({*pool_, *set_layout_}, *device_.device.getDispatcher())
                .front();
}

void Occlusion::describe(Place& p) {
  const std::array infos{vk::DescriptorBufferInfo(*p.results.buffer, 0, VK_WHOLE_SIZE),
                         vk::DescriptorBufferInfo(*p.chunks.buffer, 0, VK_WHOLE_SIZE),
                         vk::DescriptorBufferInfo(*predicates_.buffer, 0, VK_WHOLE_SIZE)};
  device_.device.updateDescriptorSets(
      vk::WriteDescriptorSet(p.set, 0, 0, vk::DescriptorType::eStorageBuffer, {}, infos), {});
}

void Occlusion::reserve(const PassContext& context, std::size_t asked, std::size_t chunks) {
  Place& p = place(context);
  const bool more_queries = p.room < asked || !*p.pool;
  if (more_queries) {
    const auto room = static_cast<std::uint32_t>(std::max<std::size_t>(asked + asked / 2, 256));
    p.pool =
        vk::raii::QueryPool(device_.device, vk::QueryPoolCreateInfo({}, vk::QueryType::eOcclusion, room));
    p.room = room;
    if (with_predicates_) {
      p.chunks = {};
      p.results = {};
      p.chunks = context.memory.buffer(4ULL * room, Usage::eStorageBuffer, vkr::MemoryUse::upload);
      p.results = context.memory.buffer(4ULL * room, Usage::eStorageBuffer | Usage::eTransferDst,
                                        vkr::MemoryUse::device);
    }
  }
  if (!with_predicates_) return;
  if (predicates_.bytes < 4 * chunks) {
    if (*predicates_.buffer) old_predicates_.push_back(std::move(predicates_));
    predicates_ =
        context.memory.buffer(std::max<std::uint64_t>(8 * chunks, 4096),
                              Usage::eStorageBuffer | Usage::eTransferDst | Usage::eConditionalRenderingEXT,
                              vkr::MemoryUse::device);
  }
  describe(p);  // nothing that uses the set is running: it belongs to this frame
}

void Occlusion::begin_frame(const PassContext& context, std::span<const Asked> asked) {
  Place& p = place(context);
  p.asked.assign(asked.begin(), asked.end());
  const vk::raii::CommandBuffer& commands = context.frame.commands;
  if (!p.asked.empty()) commands.resetQueryPool(*p.pool, 0, static_cast<std::uint32_t>(p.asked.size()));
  if (!with_predicates_) return;
  auto* chunks = reinterpret_cast<std::uint32_t*>(p.chunks.mapped());
  for (std::size_t i = 0; i < p.asked.size(); ++i) chunks[i] = p.asked[i].chunk;
  context.barriers.buffer(*predicates_.buffer, Use::predicate, Use::transfer_write).flush(commands);
  commands.fillBuffer(*predicates_.buffer, 0, VK_WHOLE_SIZE, 1);
  context.barriers.buffer(*predicates_.buffer, Use::transfer_write, Use::predicate).flush(commands);
}

vk::CommandBuffer Occlusion::boxes(const PassRecording& pass) {
  const PassContext& context = pass.context();
  const Place& p = place(context);
  const vk::raii::CommandBuffer& commands = context.frame.secondary(device_);
  begin_secondary(commands, context.pipelines, pass.target(), vk::CommandBufferUsageFlagBits::eOneTimeSubmit);
  commands.bindPipeline(vk::PipelineBindPoint::eGraphics, context.pipelines.box(pass.target().pass));
  context.gpu.bind_frame_set(commands, context.pipelines.box_layout());
  commands.setCullMode(vk::CullModeFlagBits::eNone);
  commands.setFrontFace(vk::FrontFace::eCounterClockwise);
  for (std::uint32_t i = 0; i < p.asked.size(); ++i) {
    const std::array corners{glm::vec4(p.asked[i].box_m.lo, 1.0F), glm::vec4(p.asked[i].box_m.hi, 1.0F)};
    commands.pushConstants<glm::vec4>(context.pipelines.box_layout(), vk::ShaderStageFlagBits::eVertex, 0,
                                      corners);
    commands.beginQuery(*p.pool, i, {});
    commands.draw(36, 1, 0, 0);
    commands.endQuery(*p.pool, i);
  }
  commands.end();
  return *commands;
}

void Occlusion::set_predicates(const PassContext& context) {
  const Place& p = place(context);
  const auto count = static_cast<std::uint32_t>(p.asked.size());
  if (count == 0) return;
  const vk::raii::CommandBuffer& commands = context.frame.commands;
  vkr::Barriers& barriers = context.barriers;
  commands.copyQueryPoolResults(*p.pool, 0, count, *p.results.buffer, 0, sizeof(std::uint32_t),
                                vk::QueryResultFlagBits::eWait);
  barriers.buffer(*p.results.buffer, Use::transfer_write, Use::compute_read)
      .buffer(*predicates_.buffer, Use::predicate, Use::compute_write)
      .flush(commands);
  commands.bindPipeline(vk::PipelineBindPoint::eCompute, *scatter_);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout_, 0, p.set, {});
  commands.pushConstants<std::uint32_t>(*layout_, vk::ShaderStageFlagBits::eCompute, 0, count);
  commands.dispatch((count + 63) / 64, 1, 1);
  barriers.buffer(*predicates_.buffer, Use::compute_write, Use::predicate).flush(commands);
}

Occlusion::Answers Occlusion::take_answers(const PassContext& context) {
  Place& p = place(context);
  if (p.asked.empty()) return {};
  p.samples.resize(p.asked.size());
  const vk::Result result =
      (*device_.device)
          .getQueryPoolResults(*p.pool, 0, static_cast<std::uint32_t>(p.samples.size()),
                               p.samples.size() * sizeof(std::uint32_t), p.samples.data(),
                               sizeof(std::uint32_t), {}, *device_.device.getDispatcher());
  if (result != vk::Result::eSuccess) return {};
  return {p.asked, p.samples};
}

}  // namespace scenegen::render
