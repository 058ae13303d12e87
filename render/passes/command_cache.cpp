#include "render/passes/command_cache.h"

#include <algorithm>
#include <cassert>

#include "render/passes/occlusion.h"
#include "scene/held_bytes.h"

namespace scenegen::render {

CommandCache::CommandCache(const vkr::Device& device, std::uint64_t fail_after)
    : device_(device),
      pool_(device.device, {vk::CommandPoolCreateFlagBits::eResetCommandBuffer, device.queue_family},
            heap_.callbacks()),
      fail_after_(fail_after) {}

void CommandCache::retire(Kept& kept) {
  if (*kept.owner.commands) {
    retired_.reserve_one();  // may throw: what may be running must not have been moved by then
    retired_.push_back({std::move(kept.owner), kept.last_used});
  }
  kept = Kept{};
}

void CommandCache::forget() {
  for (std::vector<Kept>& of_pass : kept_) {
    for (Kept& kept : of_pass) retire(kept);
  }
}

CommandCache::Buffer CommandCache::take(std::uint64_t completed) {
  // In order of retirement, which is nearly that of last use: one that waits holds back those behind it for a
  // frame or two, no more.
  while (!retired_.empty() && retired_.front().last_used <= completed) {
    free_.push_back(std::move(retired_.front().owner));
    retired_.pop_front();
  }
  if (free_.empty()) {
    constexpr std::uint32_t kAtOnce = 64;
    if (fail_after_ != 0 && allocated_ + kAtOnce > fail_after_)
      throw vk::OutOfDeviceMemoryError("allocating command buffers (fault injected)");
    vk::raii::CommandBuffers made(device_.device, {*pool_, vk::CommandBufferLevel::eSecondary, kAtOnce});
    allocated_ += kAtOnce;
    for (vk::raii::CommandBuffer& one : made) free_.push_back({std::move(one), 0});
  }
  Buffer out = std::move(free_.back());
  free_.pop_back();
  return out;
}

void CommandCache::record(const PassRecording& pass, Kept& kept, std::span<const std::uint32_t> slots) {
  const PassContext& context = pass.context();
  const vk::raii::CommandBuffer& commands = kept.owner.commands;
  draws_ -= std::exchange(kept.owner.draws, 0);
  // Several frames may have it in flight at once.
  begin_secondary(commands, context.pipelines, pass.target(),
                  vk::CommandBufferUsageFlagBits::eSimultaneousUse);
  // Neither is inherited: begun and ended in here, at a fixed place.
  if (kept.predicates) {
    commands.beginConditionalRenderingEXT(
        vk::ConditionalRenderingBeginInfoEXT(kept.predicates, predicate_offset(kept.chunk)));
  }
  DrawRecorder recorder(commands, context.pipelines, context.gpu, context.scene, pass.target().pass);
  for (const std::uint32_t slot : slots) recorder.draw(slot);
  if (kept.predicates) commands.endConditionalRenderingEXT();
  commands.end();
  kept.entry = {*commands, recorder.recorded()};
  draws_ += kept.owner.draws = recorder.recorded().draws;
  ++counters_.recorded;
  counters_.recorded_draws += recorder.recorded().draws;
}

bool CommandCache::fresh(std::uint32_t chunk, std::uint64_t revision) const {
  const std::vector<Kept>& of_pass = kept_[kept_[0].empty() ? 1 : 0];
  return chunk < of_pass.size() && *of_pass[chunk].owner.commands && of_pass[chunk].revision == revision;
}

const CommandCache::Entry& CommandCache::get(const PassRecording& pass, std::uint32_t chunk,
                                             std::uint64_t revision, std::span<const std::uint32_t> slots,
                                             vk::Buffer predicates) {
  assert(pass.target().pass != vkr::PassKind::shadow);
  std::vector<Kept>& of_pass = kept_[pass.target().pass == vkr::PassKind::color ? 0 : 1];
  if (of_pass.size() <= chunk) of_pass.resize(std::max<std::size_t>(chunk + 1, of_pass.size() * 2));
  Kept& kept = of_pass[chunk];
  if (!*kept.owner.commands || kept.revision != revision || kept.predicates != predicates) {
    retire(kept);
    kept.predicates = predicates;
    kept.chunk = chunk;
    kept.owner = take(pass.context().completed);
    record(pass, kept, slots);
    kept.revision = revision;
  }
  kept.last_used = pass.context().frame.serial;
  return kept.entry;
}

void CommandCache::add_memory(MemoryAccount& to) const {
  to.add_host(MemoryKind::commands, held_bytes(free_, kept_[0], kept_[1]) + retired_.memory_bytes());
  to.commands.buffers += allocated_;
  to.commands.draws += draws_;
  to.commands.driver += heap_.bytes();
}

}  // namespace scenegen::render
