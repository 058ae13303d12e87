// Secondary command buffers that are kept from frame to frame (D 3.1.3), one a chunk and pass.
#pragma once

#include <cstdint>
#include <span>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "render/passes/pass_recording.h"
#include "render/ring_queue.h"
#include "render/vk/driver_heap.h"

namespace scenegen::render {

/// A command buffer that the device may still run is never recorded again: the chunk gets another one, and
/// the old one waits for the last frame that used it. Everything is allocated from one pool; what is no
/// longer needed is used again before more is allocated.
class CommandCache {
 public:
  /// What a chunk's commands hold.
  struct Entry {
    vk::CommandBuffer commands;
    Recorded held;
  };

  /// `fail_after`: throws out-of-memory when more buffers are wanted than this (0: never): for tests.
  explicit CommandCache(const vkr::Device& device, std::uint64_t fail_after = 0);

  /// Commands that draw `slots` in the pass: the kept ones if they were recorded for this revision, else they
  /// are recorded now. Throws vk::SystemError when there is no memory.
  /// With `predicates`, the commands run only where the 32-bit value of the chunk there is not 0.
  const Entry& get(const PassRecording& pass, std::uint32_t chunk, std::uint64_t revision,
                   std::span<const std::uint32_t> slots, vk::Buffer predicates = {});
  /// Would get() record nothing for this revision in the colour pass? (If that is not drawn: in the other.)
  [[nodiscard]] bool fresh(std::uint32_t chunk, std::uint64_t revision) const;
  /// Nothing that was recorded is good any more (the picture has another size).
  void forget();

  /// Since the last call.
  struct Counters {
    std::uint64_t recorded = 0;        ///< buffers recorded
    std::uint64_t recorded_draws = 0;  ///< draw commands in them
  };
  [[nodiscard]] Counters take_counters() { return std::exchange(counters_, {}); }
  [[nodiscard]] std::uint64_t buffers() const { return allocated_; }
  /// Host memory held, and what the driver holds for the buffers.
  void add_memory(MemoryAccount& to) const;

 private:
  struct Buffer {
    vk::raii::CommandBuffer commands{nullptr};
    std::uint64_t draws = 0;  // in it, until it is recorded again
  };
  struct Kept {
    Buffer owner;
    Entry entry;
    std::uint64_t revision = 0;
    std::uint64_t last_used = 0;  // serial of a frame
    vk::Buffer predicates;
    std::uint32_t chunk = 0;
  };
  struct Retired {
    Buffer owner;
    std::uint64_t last_used = 0;
  };
  void retire(Kept& kept);
  Buffer take(std::uint64_t completed);
  void record(const PassRecording& pass, Kept& kept, std::span<const std::uint32_t> slots);

  const vkr::Device& device_;
  vkr::DriverHeap heap_;  // outlives the pool
  vk::raii::CommandPool pool_{nullptr};
  std::vector<Buffer> free_;
  RingQueue<Retired> retired_;
  std::vector<Kept> kept_[2];  // by pass (color, ids) and chunk
  std::uint64_t allocated_ = 0;
  std::uint64_t draws_ = 0;  // in all buffers
  std::uint64_t fail_after_;
  Counters counters_;
};

}  // namespace scenegen::render
