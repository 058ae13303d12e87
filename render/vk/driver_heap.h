// What a driver holds on the processor's side for one object of ours, counted by allocation callbacks.
#pragma once

#include <atomic>
#include <cstdint>
#include <vulkan/vulkan.hpp>

namespace scenegen::render::vkr {

/// Hand callbacks() to whatever is made; must outlive it. Vulkan cannot be asked what command buffers take; a
/// software driver allocates all of it through these. Costs a few nanoseconds an allocation.
class DriverHeap {
 public:
  DriverHeap();
  DriverHeap(const DriverHeap&) = delete;
  DriverHeap& operator=(const DriverHeap&) = delete;

  [[nodiscard]] const vk::AllocationCallbacks& callbacks() const { return callbacks_; }
  /// Held now, with what the allocator adds to each piece.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> bytes_{0};  // drivers may call from any thread
  vk::AllocationCallbacks callbacks_;
};

/// Resident memory of the process, bytes; 0 where it cannot be told.
[[nodiscard]] std::uint64_t process_bytes();

}  // namespace scenegen::render::vkr
