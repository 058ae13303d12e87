#include "render/passes/indirect_nodes.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <numeric>

#include "render/passes/occlusion.h"

#include "scene/held_bytes.h"

namespace scenegen::render {

using vkr::Use;

IndirectNodes::IndirectNodes(std::uint32_t most_draws, std::uint64_t fail_after, bool single)
    : unit_((most_draws + kSizes - 1) / kSizes),
      block_commands_(std::max(kIndirectBlockCommands, kSizes * unit_)),
      fail_after_(fail_after),
      single_(single) {}

IndirectNodes::Place IndirectNodes::take(const PassContext& context, std::uint32_t draws) {
  assert(draws > 0 && draws <= kSizes * unit_);
  // As in CommandCache: one that waits holds back those behind it for a frame or two, no more.
  while (!retired_.empty() && retired_.front().last_used <= context.completed) {
    const Place& place = retired_.front().place;
    free_[place.size].push_back(place);
    retired_.pop_front();
  }
  const std::uint32_t size = (draws + unit_ - 1) / unit_;
  if (!free_[size].empty()) {
    const Place place = free_[size].back();
    free_[size].pop_back();
    return place;
  }
  if (fail_after_ != 0 && places_ >= fail_after_)
    throw vk::OutOfDeviceMemoryError("allocating indirect draws (fault injected)");
  if (blocks_.empty() || used_ + size * unit_ > block_commands_) {
    using Usage = vk::BufferUsageFlagBits;
    blocks_.push_back(context.memory.buffer(sizeof(Command) * std::uint64_t{block_commands_},
                                            Usage::eIndirectBuffer | Usage::eTransferDst,
                                            vkr::MemoryUse::written, MemoryKind::indirect));
    used_ = 0;
  }
  const Place place{static_cast<std::uint32_t>(blocks_.size()) - 1, used_, size};
  used_ += size * unit_;
  ++places_;
  return place;
}

IndirectNodes::Command* IndirectNodes::stage(const PassContext& context, std::uint64_t commands) {
  vkr::Buffer& staging = staging_[context.frame.serial % context.frames_in_flight];
  const std::uint64_t bytes = sizeof(Command) * commands;
  // The frame that used it is done. A first frame writes all there is: that much is not kept for ever.
  if (staging.bytes > kStagingBytes && staging.bytes / 16 > bytes) staging = {};
  if (staging.bytes < bytes) {
    staging = {};
    const std::uint64_t room = bytes > kStagingBytes ? bytes : std::max(bytes + bytes / 2, kStagingBytes / 4);
    staging = context.memory.buffer(room, vk::BufferUsageFlagBits::eTransferSrc, vkr::MemoryUse::upload,
                                    MemoryKind::staging);
  }
  return reinterpret_cast<Command*>(staging.mapped());
}

void IndirectNodes::write(const PassContext& context, const Octree::Chunk& chunk, Kept& kept, bool reversed) {
  const DrawScene& scene = context.scene;
  const std::uint32_t longest = context.device.properties.limits.maxDrawIndirectCount;
  kept.runs.clear();
  commands_.clear();
  const DrawPrimitive* last = nullptr;
  for (std::size_t i = 0; i < chunk.slots.size(); ++i) {
    const std::uint32_t slot = chunk.slots[reversed ? chunk.slots.size() - 1 - i : i];
    const DrawPrimitive& primitive = scene.primitive(slot);
    const GeometryRange& range = context.gpu.range(primitive.geometry);
    if (range.index_count == 0) continue;
    const std::uint32_t state = 2 * primitive.batch + (scene.mirrored(slot) ? 1 : 0);
    const std::uint32_t triangles = range.kind == PrimitiveKind::triangles ? range.index_count / 3 : 0;
    const bool same = !kept.runs.empty() && kept.runs.back().state == state;
    // Instances are drawn in ascending order, so not when that is reversed.
    if (same && !single_ && !reversed && last == &primitive &&
        commands_.back().firstInstance + commands_.back().instanceCount == slot) {
      ++commands_.back().instanceCount;
    } else {
      const auto written = static_cast<std::uint32_t>(commands_.size());
      if (!same || kept.runs.back().count == longest) kept.runs.push_back({slot, state, written, 0, 0});
      ++kept.runs.back().count;
      commands_.push_back({range.index_count, 1, range.first_index, range.vertex_offset, slot});
    }
    kept.runs.back().triangles += triangles;
    last = &primitive;
  }
  kept.commands = static_cast<std::uint32_t>(commands_.size());
}

void IndirectNodes::update(const PassContext& context, const Octree& tree,
                           std::span<const std::uint32_t> chunks, bool reversed) {
  if (kept_.size() < tree.chunk_numbers()) kept_.resize(std::max(tree.chunk_numbers(), 2 * kept_.size()));
  changed_.clear();
  std::uint64_t draws = 0;
  for (const std::uint32_t number : chunks) {
    Kept& kept = kept_[number];
    if (!fresh(number, tree.chunk(number).revision)) {
      changed_.push_back(number);
      draws += tree.chunk(number).slots.size();
    } else {
      kept.last_used = context.frame.serial;
    }
  }
  if (changed_.empty()) return;
  Command* staged = nullptr;  // only if some place cannot be written directly
  std::uint64_t from = 0;
  for (const std::uint32_t number : changed_) {
    const Octree::Chunk& chunk = tree.chunk(number);
    Kept& kept = kept_[number];
    if (kept.place.size != 0) retired_.push_back({kept.place, kept.last_used});
    kept.place = {};
    write(context, chunk, kept, reversed);
    kept.place = take(context, std::max(1U, kept.commands));
    const vkr::Buffer& block = blocks_[kept.place.block];
    if (block.mapped() != nullptr) {
      std::memcpy(block.mapped() + sizeof(Command) * std::uint64_t{kept.place.first}, commands_.data(),
                  sizeof(Command) * commands_.size());
    } else if (!commands_.empty()) {
      if (staged == nullptr) staged = stage(context, draws);
      std::memcpy(staged + from, commands_.data(), sizeof(Command) * commands_.size());
      copies_.resize(blocks_.size());
      copies_[kept.place.block].emplace_back(from * sizeof(Command),
                                             std::uint64_t{kept.place.first} * sizeof(Command),
                                             sizeof(Command) * commands_.size());
      from += commands_.size();
    }
    kept.revision = chunk.revision;
    kept.last_used = context.frame.serial;
  }
  if (from > 0) copy_staged(context);
  counters_.written += changed_.size();
  counters_.written_draws += draws;
}

void IndirectNodes::copy_staged(const PassContext& context) {
  const vkr::Buffer& staging = staging_[context.frame.serial % context.frames_in_flight];
  for (std::size_t block = 0; block < copies_.size(); ++block) {
    if (copies_[block].empty()) continue;
    const vk::Buffer to = *blocks_[block].buffer;
    context.frame.commands.copyBuffer(*staging.buffer, to, copies_[block]);
    context.barriers.buffer(to, Use::transfer_write, Use::indirect);
    copies_[block].clear();
  }
  context.barriers.flush(context.frame.commands);
}

IndirectNodes::Kinds IndirectNodes::kinds(const Octree& tree, std::span<const std::uint32_t> chunks) const {
  Kinds sum;
  for (const std::uint32_t number : chunks) {
    const Octree::Chunk& chunk = tree.chunk(number);
    if (!fresh(number, chunk.revision)) continue;
    ++sum.chunks;
    sum.slots += chunk.slots.size();
    sum.commands += kept_[number].commands;
    sum.runs += kept_[number].runs.size();
  }
  return sum;
}

std::size_t IndirectNodes::draw(DrawRecorder& recorder, const Part& part) {
  // Counting sort by state: places before each, then chunk by chunk.
  runs_before_.assign(1, 0);
  for (const std::uint32_t number : part.chunks) {
    for (const Run& run : kept_[number].runs) {
      if (run.state + 2 > runs_before_.size()) runs_before_.resize(run.state + 2, 0);
      ++runs_before_[run.state + 1];
    }
  }
  std::partial_sum(runs_before_.begin(), runs_before_.end(), runs_before_.begin());
  sent_.resize(runs_before_.back());
  for (const std::uint32_t number : part.chunks) {
    const std::vector<Run>& runs = kept_[number].runs;
    for (std::uint32_t i = 0; i < runs.size(); ++i) sent_[runs_before_[runs[i].state]++] = {number, i};
  }
  if (part.reversed) std::reverse(sent_.begin(), sent_.end());
  for (const Sent& sent : sent_) {
    const Kept& kept = kept_[sent.chunk];
    const Run& run = kept.runs[sent.run];
    const std::uint64_t offset = (std::uint64_t{kept.place.first} + run.first) * sizeof(Command);
    recorder.draw_indirect({run.slot, *blocks_[kept.place.block].buffer, offset, run.count, run.triangles,
                            part.counts, part.governed ? predicate_offset(sent.chunk) : kLetPassOffset});
  }
  return sent_.size();
}

std::uint64_t IndirectNodes::memory_bytes() const {
  std::uint64_t sum =
      held_bytes(blocks_, kept_, changed_, commands_, runs_before_, sent_, copies_) + retired_.memory_bytes();
  for (const std::vector<Place>& places : free_) sum += held_bytes(places);
  for (const Kept& kept : kept_) sum += held_bytes(kept.runs);
  return sum;
}

}  // namespace scenegen::render
