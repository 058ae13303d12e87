// Block suballocator for device memory, and the buffers and images that live in it.
#pragma once

#include <array>
#include <list>
#include <memory>
#include <span>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "render/memory_account.h"
#include "render/vk/device.h"
#include "render/vk/free_list.h"
#include "render/vk/use.h"

namespace scenegen::render::vkr {

enum class MemoryUse : std::uint8_t {
  device,    ///< fastest for the device
  written,   ///< the same, and mapped where the device has such memory: written once, by the processor
  scene,     ///< the same, but of the host when the device has no more (D 2.4)
  upload,    ///< written by the processor, mapped
  readback,  ///< read by the processor, mapped, cached where possible
};

class Memory;

/// A piece of a block; gives itself back.
class Allocation {
 public:
  Allocation() = default;
  Allocation(Allocation&& other) noexcept { swap(other); }
  Allocation& operator=(Allocation&& other) noexcept {
    Allocation gone(std::move(other));
    swap(gone);
    return *this;
  }
  ~Allocation();

  [[nodiscard]] vk::DeviceMemory memory() const;
  [[nodiscard]] std::uint64_t offset() const { return offset_; }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  /// First byte when the memory is mapped, else null.
  [[nodiscard]] std::byte* mapped() const;

 private:
  friend class Memory;
  struct Block;
  void swap(Allocation& other) noexcept {
    std::swap(block_, other.block_);
    std::swap(offset_, other.offset_);
    std::swap(bytes_, other.bytes_);
    std::swap(kind_, other.kind_);
    std::swap(spilled_, other.spilled_);
  }
  /// Adds to a share what this piece is, or takes it off.
  void count(MemoryShare& share, bool gone) const;
  Block* block_ = nullptr;
  std::uint64_t offset_ = 0;
  std::uint64_t bytes_ = 0;
  MemoryKind kind_ = MemoryKind::unused;
  bool spilled_ = false;  // meant for the device, in memory of the host
};

struct Buffer {
  Allocation allocation;  // freed after the buffer
  vk::raii::Buffer buffer{nullptr};
  std::uint64_t bytes = 0;
  [[nodiscard]] std::byte* mapped() const { return allocation.mapped(); }
};

struct Image {
  Allocation allocation;
  vk::raii::Image image{nullptr};
  vk::raii::ImageView view{nullptr};
  vk::Format format{};
  vk::Extent2D extent;
  std::uint32_t mip_levels = 1;
  vk::ImageAspectFlags aspect;
  Use last_use = Use::none;  ///< kept by Barriers
};

struct ImageOptions {
  vk::Format format{};
  vk::Extent2D extent;
  std::uint32_t mip_levels = 1;
  vk::SampleCountFlagBits samples = vk::SampleCountFlagBits::e1;
  vk::ImageUsageFlags usage;
  MemoryKind kind = MemoryKind::targets;
};

/// Throws vk::OutOfDeviceMemoryError and the like; the room's border turns them into errors.
class Memory {
 public:
  explicit Memory(const Device& device, const MemoryFaults& faults = {});
  ~Memory();
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  [[nodiscard]] Buffer buffer(std::uint64_t bytes, vk::BufferUsageFlags usage, MemoryUse use,
                              MemoryKind kind);
  [[nodiscard]] Image image(const ImageOptions& options);
  /// Bytes of all blocks taken from the driver.
  [[nodiscard]] std::uint64_t block_bytes() const;
  /// Adds all that is taken from the driver, by kind.
  void add_to(MemoryAccount& account) const;
  /// What was for MemoryUse::scene and lies in memory of the host, of one kind, bytes.
  [[nodiscard]] std::uint64_t spilled_bytes(MemoryKind kind) const {
    return shares_[static_cast<std::size_t>(kind)].spilled;
  }
  /// Gives blocks in which nothing lies back to the driver.
  void release_unused();

 private:
  Allocation allocate(const vk::MemoryRequirements& needs, MemoryUse use, bool image);
  Allocation allocate_from(std::uint32_t type, const vk::MemoryRequirements& needs, bool image);
  Allocation counted(Allocation piece, MemoryKind kind);
  void take_from_device(std::uint64_t bytes);

  const Device& device_;
  MemoryFaults faults_;
  std::uint64_t device_bytes_ = 0;                // for faults_ only
  std::array<MemoryShare, kMemoryKinds> shares_;  // of what is allocated; pieces take themselves off
  std::list<Allocation::Block> blocks_;
};

}  // namespace scenegen::render::vkr
