#include "render/passes/occlusion.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "render/shaders/scatter_comp.h"
#include "scene/held_bytes.h"

namespace scenegen::render {

using vkr::Use;
using Usage = vk::BufferUsageFlagBits;

namespace {

// A predicate that lets pass: also as a number of draws it is more than any chunk has.
std::uint32_t let_all_pass(const vkr::Device& device) {
  return std::min(device.properties.limits.maxDrawIndirectCount, 0x7FFFFFFFU);
}

struct ScatterConstants {
  std::uint32_t count = 0;
  std::uint32_t pass = 0;
};

}  // namespace

std::size_t query_count(std::span<const Asked> asked) {
  return static_cast<std::size_t>(
      std::count_if(asked.begin(), asked.end(), [](const Asked& a) { return !a.with_previous; }));
}

Occlusion::Occlusion(const vkr::Device& device, Predicates predicates) : device_(device), form_(predicates) {
  if (form_ != Predicates::none) make_scatter();
}

void Occlusion::make_scatter() {
  using Type = vk::DescriptorType;
  std::array<vk::DescriptorSetLayoutBinding, 3> bindings;
  for (std::uint32_t i = 0; i < 3; ++i)
    bindings[i] =
        vk::DescriptorSetLayoutBinding(i, Type::eStorageBuffer, 1, vk::ShaderStageFlagBits::eCompute);
  set_layout_ =
      vk::raii::DescriptorSetLayout(device_.device, vk::DescriptorSetLayoutCreateInfo({}, bindings));
  const vk::PushConstantRange constants(vk::ShaderStageFlagBits::eCompute, 0, sizeof(ScatterConstants));
  layout_ =
      vk::raii::PipelineLayout(device_.device, vk::PipelineLayoutCreateInfo({}, *set_layout_, constants));
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
                         vk::DescriptorBufferInfo(*p.governed.buffer, 0, VK_WHOLE_SIZE),
                         vk::DescriptorBufferInfo(*predicates_.buffer, 0, VK_WHOLE_SIZE)};
  device_.device.updateDescriptorSets(
      vk::WriteDescriptorSet(p.set, 0, 0, vk::DescriptorType::eStorageBuffer, {}, infos), {});
}

void Occlusion::reserve(const PassContext& context, std::size_t asked, std::size_t chunks) {
  chunks = std::max<std::size_t>(chunks, 1);  // buffers to fill and bind even where nothing is seen yet
  Place& p = place(context);
  const bool more_queries = p.room < asked || !*p.pool;
  if (more_queries) {
    const auto room = static_cast<std::uint32_t>(std::max<std::size_t>(asked + asked / 2, 256));
    p.room = 0;
    p.asked.clear();
    p.asked.reserve(room);  // all at once: how much is asked differs from frame to frame
    p.samples.reserve(room);
    p.pool =
        vk::raii::QueryPool(device_.device, vk::QueryPoolCreateInfo({}, vk::QueryType::eOcclusion, room));
    if (form_ != Predicates::none) {
      p.results = {};
      p.results = context.memory.buffer(sizeof(std::uint32_t) * std::uint64_t{room},
                                        Usage::eStorageBuffer | Usage::eTransferDst, vkr::MemoryUse::device,
                                        MemoryKind::queries);
    }
    p.room = room;
  }
  if (form_ == Predicates::none) return;
  // Each chunk is governed by one query at most.
  if (p.governed.bytes < sizeof(Governed) * chunks) {
    p.governed = {};
    p.governed = context.memory.buffer(std::max<std::uint64_t>(2 * sizeof(Governed) * chunks, 4096),
                                       Usage::eStorageBuffer, vkr::MemoryUse::upload, MemoryKind::queries);
  }
  if (predicates_.bytes < predicate_offset(static_cast<std::uint32_t>(chunks))) {
    if (*predicates_.buffer) old_predicates_.push_back(std::move(predicates_));
    const auto read =
        form_ == Predicates::conditional ? Usage::eConditionalRenderingEXT : Usage::eIndirectBuffer;
    predicates_ = context.memory.buffer(std::max<std::uint64_t>(8 * chunks, 4096),
                                        Usage::eStorageBuffer | Usage::eTransferDst | read,
                                        vkr::MemoryUse::device, MemoryKind::queries);
    fresh_ = true;
  }
  describe(p);  // nothing that uses the set is running: it belongs to this frame
}

void Occlusion::begin_frame(const PassContext& context, std::span<const Asked> asked,
                            std::span<const Governed> governed) {
  Place& p = place(context);
  p.asked.assign(asked.begin(), asked.end());
  p.queries = static_cast<std::uint32_t>(query_count(asked));
  p.governed_count = static_cast<std::uint32_t>(governed.size());
  const vk::raii::CommandBuffer& commands = context.frame.commands;
  if (p.queries > 0) commands.resetQueryPool(*p.pool, 0, p.queries);
  if (form_ == Predicates::none) return;
  std::copy(governed.begin(), governed.end(), reinterpret_cast<Governed*>(p.governed.mapped()));
  if (form_ == Predicates::counts && !std::exchange(fresh_, false)) return;
  context.barriers.buffer(*predicates_.buffer, read(), Use::transfer_write).flush(commands);
  commands.fillBuffer(*predicates_.buffer, 0, VK_WHOLE_SIZE, let_all_pass(device_));
  context.barriers.buffer(*predicates_.buffer, Use::transfer_write, read()).flush(commands);
}

void Occlusion::record_boxes(const vk::raii::CommandBuffer& commands, const PassRecording& pass) {
  const PassContext& context = pass.context();
  const Place& p = place(context);
  if (p.asked.empty()) return;
  commands.bindPipeline(vk::PipelineBindPoint::eGraphics, context.pipelines.box(pass.target().pass));
  context.gpu.bind_frame_set(commands, context.pipelines.box_layout());
  commands.setCullMode(vk::CullModeFlagBits::eNone);
  commands.setFrontFace(vk::FrontFace::eCounterClockwise);
  std::uint32_t query = 0;
  for (std::size_t i = 0; i < p.asked.size(); ++i) {
    const std::array corners{glm::vec4(p.asked[i].box_m.lo, 1.0F), glm::vec4(p.asked[i].box_m.hi, 1.0F)};
    commands.pushConstants<glm::vec4>(context.pipelines.box_layout(), vk::ShaderStageFlagBits::eVertex, 0,
                                      corners);
    if (!p.asked[i].with_previous) commands.beginQuery(*p.pool, query, {});
    commands.draw(36, 1, 0, 0);
    if (i + 1 == p.asked.size() || !p.asked[i + 1].with_previous) commands.endQuery(*p.pool, query++);
  }
}

void Occlusion::draw_boxes(const PassRecording& pass) {
  record_boxes(pass.context().frame.commands, pass);
}

vk::CommandBuffer Occlusion::boxes(const PassRecording& pass) {
  const PassContext& context = pass.context();
  if (place(context).asked.empty()) return {};
  const vk::raii::CommandBuffer& commands = context.frame.secondary(device_);
  begin_secondary(commands, context.pipelines, pass.target(), vk::CommandBufferUsageFlagBits::eOneTimeSubmit);
  record_boxes(commands, pass);
  commands.end();
  return *commands;
}

void Occlusion::set_predicates(const PassContext& context) {
  const Place& p = place(context);
  if (p.governed_count == 0) return;
  const vk::raii::CommandBuffer& commands = context.frame.commands;
  vkr::Barriers& barriers = context.barriers;
  commands.copyQueryPoolResults(*p.pool, 0, p.queries, *p.results.buffer, 0, sizeof(std::uint32_t),
                                vk::QueryResultFlagBits::eWait);
  barriers.buffer(*p.results.buffer, Use::transfer_write, Use::compute_read)
      .buffer(*predicates_.buffer, read(), Use::compute_write)
      .flush(commands);
  commands.bindPipeline(vk::PipelineBindPoint::eCompute, *scatter_);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout_, 0, p.set, {});
  commands.pushConstants<ScatterConstants>(*layout_, vk::ShaderStageFlagBits::eCompute, 0,
                                           ScatterConstants{p.governed_count, let_all_pass(device_)});
  commands.dispatch((p.governed_count + 63) / 64, 1, 1);
  barriers.buffer(*predicates_.buffer, Use::compute_write, read()).flush(commands);
}

Occlusion::Answers Occlusion::take_answers(const PassContext& context) {
  Place& p = place(context);
  if (p.asked.empty()) return {};
  p.samples.resize(p.asked.size());
  const vk::Result result =
      (*device_.device)
          .getQueryPoolResults(*p.pool, 0, p.queries, p.queries * sizeof(std::uint32_t), p.samples.data(),
                               sizeof(std::uint32_t), {}, *device_.device.getDispatcher());
  if (result != vk::Result::eSuccess) return {};
  std::uint32_t query = p.queries;  // from the last on: to each of those that share it
  for (std::size_t i = p.asked.size(); i-- > 0;) {
    p.samples[i] = p.samples[query - 1];
    if (!p.asked[i].with_previous) --query;
  }
  return {p.asked, p.samples};
}

std::uint64_t Occlusion::memory_bytes() const {
  std::uint64_t sum = held_bytes(old_predicates_);
  for (const Place& p : places_) sum += held_bytes(p.asked, p.samples);
  return sum;
}

}  // namespace scenegen::render
