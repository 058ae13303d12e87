#include "render/vk/memory.h"

#include <algorithm>
#include <bit>
#include <new>
#include <optional>

#include "render/config.h"

namespace scenegen::render::vkr {

struct Allocation::Block {
  FreeList pieces;
  vk::raii::DeviceMemory memory{nullptr};
  std::byte* mapped = nullptr;
  std::uint32_t type = 0;
  bool device_local = false;
  std::array<MemoryShare, kMemoryKinds>* shares = nullptr;  // Memory's
  bool image = false;  // buffers and images never share a block: no bufferImageGranularity to mind
};

Allocation::~Allocation() {
  if (block_ == nullptr) return;
  count((*block_->shares)[static_cast<std::size_t>(kind_)], true);
  try {
    block_->pieces.release(offset_, bytes_);
  } catch (const std::bad_alloc&) {
    // The list of free pieces could not grow: this one stays taken until its block goes.
  }
}

void Allocation::count(MemoryShare& share, bool gone) const {
  const std::uint64_t change = gone ? 0 - bytes_ : bytes_;  // unsigned: wraps back
  (block_->device_local && !spilled_ ? share.device : share.host) += change;
  if (spilled_) share.spilled += change;
}

vk::DeviceMemory Allocation::memory() const {
  return *block_->memory;
}

std::byte* Allocation::mapped() const {
  return block_ == nullptr || block_->mapped == nullptr ? nullptr : block_->mapped + offset_;
}

Memory::Memory(const Device& device, const MemoryFaults& faults) : device_(device), faults_(faults) {}
Memory::~Memory() = default;

namespace {

using Flag = vk::MemoryPropertyFlagBits;

/// The first type that has all of the wanted properties, else all of the needed ones.
std::uint32_t memory_type(const vk::PhysicalDeviceMemoryProperties& properties, std::uint32_t allowed,
                          MemoryUse use) {
  vk::MemoryPropertyFlags needed;
  vk::MemoryPropertyFlags wanted;
  switch (use) {
    case MemoryUse::device:
    case MemoryUse::scene:
      wanted = Flag::eDeviceLocal;
      break;
    case MemoryUse::written:
      needed = Flag::eDeviceLocal;
      wanted = Flag::eHostVisible | Flag::eHostCoherent;
      break;
    case MemoryUse::upload:
      needed = Flag::eHostVisible | Flag::eHostCoherent;
      break;
    case MemoryUse::readback:
      needed = Flag::eHostVisible | Flag::eHostCoherent;
      wanted = Flag::eHostCached;
      break;
  }
  for (const vk::MemoryPropertyFlags flags : {needed | wanted, needed}) {
    for (std::uint32_t i = 0; i < properties.memoryTypeCount; ++i) {
      if ((allowed >> i & 1U) != 0 && (properties.memoryTypes[i].propertyFlags & flags) == flags) return i;
    }
  }
  throw vk::FeatureNotPresentError("no memory type fits");
}

/// A type for what does not fit device memory: not the device's own, else any that the host sees.
std::uint32_t host_type(const vk::PhysicalDeviceMemoryProperties& properties, std::uint32_t allowed) {
  for (const vk::MemoryPropertyFlags unwanted :
       {vk::MemoryPropertyFlags{Flag::eDeviceLocal}, vk::MemoryPropertyFlags{}}) {
    for (std::uint32_t i = 0; i < properties.memoryTypeCount; ++i) {
      const vk::MemoryPropertyFlags has = properties.memoryTypes[i].propertyFlags;
      if ((allowed >> i & 1U) != 0 && (has & Flag::eHostVisible) && !(has & unwanted)) return i;
    }
  }
  throw vk::OutOfDeviceMemoryError("no memory of the host that the device could use either");
}

}  // namespace

void Memory::take_from_device(std::uint64_t bytes) {
  if (faults_.device_bytes != 0 && device_bytes_ + bytes > faults_.device_bytes)
    throw vk::OutOfDeviceMemoryError("allocating device memory (fault injected)");
  device_bytes_ += bytes;
}

Allocation Memory::allocate(const vk::MemoryRequirements& needs, MemoryUse use, bool image) {
  const std::uint32_t type = memory_type(device_.memory_properties, needs.memoryTypeBits, use);
  if (use != MemoryUse::scene) {
    if (use == MemoryUse::device || use == MemoryUse::written) take_from_device(needs.size);
    // What of the device's memory the processor may write can be a small part of it (256 MiB without
    // resizable BAR); whoever asked for it copies where the rest is given.
    const std::uint32_t other =
        use == MemoryUse::written
            ? memory_type(device_.memory_properties, needs.memoryTypeBits, MemoryUse::device)
            : type;
    if (other == type) return allocate_from(type, needs, image);
    try {
      return allocate_from(type, needs, image);
    } catch (const vk::OutOfDeviceMemoryError&) {
      return allocate_from(other, needs, image);
    }
  }
  try {
    take_from_device(needs.size);
    return allocate_from(type, needs, image);
  } catch (const vk::OutOfDeviceMemoryError&) {
    Allocation out = allocate_from(host_type(device_.memory_properties, needs.memoryTypeBits), needs, image);
    out.spilled_ = true;
    return out;
  }
}

Allocation Memory::allocate_from(std::uint32_t type, const vk::MemoryRequirements& needs, bool image) {
  Allocation out;
  out.bytes_ = needs.size;
  std::uint64_t taken = 0;
  for (Allocation::Block& block : blocks_) {
    if (block.type != type || block.image != image) continue;
    if (const auto offset = block.pieces.allocate(needs.size, needs.alignment)) {
      out.block_ = &block;
      out.offset_ = *offset;
      return out;
    }
    taken += block.pieces.size();
  }
  release_unused();  // before a new one is asked for
  std::uint64_t bytes = std::clamp(std::bit_ceil(taken), kLeastMemoryBlockBytes, kMostMemoryBlockBytes);
  if (needs.size > bytes / 2) bytes = needs.size;
  Allocation::Block block{FreeList(bytes)};
  block.memory = vk::raii::DeviceMemory(device_.device, vk::MemoryAllocateInfo(bytes, type));
  constexpr vk::MemoryPropertyFlags kMapped = Flag::eHostVisible | Flag::eHostCoherent;
  if ((device_.memory_properties.memoryTypes[type].propertyFlags & kMapped) == kMapped)
    block.mapped = static_cast<std::byte*>(block.memory.mapMemory(0, VK_WHOLE_SIZE));
  block.type = type;
  block.device_local =
      static_cast<bool>(device_.memory_properties.memoryTypes[type].propertyFlags & Flag::eDeviceLocal);
  block.shares = &shares_;
  block.image = image;
  blocks_.push_back(std::move(block));
  out.block_ = &blocks_.back();
  out.offset_ = *blocks_.back().pieces.allocate(needs.size, needs.alignment);
  return out;
}

Allocation Memory::counted(Allocation piece, MemoryKind kind) {
  piece.kind_ = kind;
  piece.count(shares_[static_cast<std::size_t>(kind)], false);
  return piece;
}

Buffer Memory::buffer(std::uint64_t bytes, vk::BufferUsageFlags usage, MemoryUse use, MemoryKind kind) {
  Buffer out;
  out.bytes = std::max<std::uint64_t>(bytes, 16);
  out.buffer = vk::raii::Buffer(device_.device, vk::BufferCreateInfo({}, out.bytes, usage));
  out.allocation = counted(allocate(out.buffer.getMemoryRequirements(), use, false), kind);
  out.buffer.bindMemory(out.allocation.memory(), out.allocation.offset());
  return out;
}

Image Memory::image(const ImageOptions& options) {
  Image out;
  out.format = options.format;
  out.extent = options.extent;
  out.mip_levels = options.mip_levels;
  out.aspect = options.format == vk::Format::eD32Sfloat ? vk::ImageAspectFlagBits::eDepth
                                                        : vk::ImageAspectFlagBits::eColor;
  vk::ImageCreateInfo create;
  create.imageType = vk::ImageType::e2D;
  create.format = options.format;
  create.extent = vk::Extent3D(options.extent, 1);
  create.mipLevels = options.mip_levels;
  create.arrayLayers = 1;
  create.samples = options.samples;
  create.tiling = vk::ImageTiling::eOptimal;
  create.usage = options.usage;
  out.image = vk::raii::Image(device_.device, create);
  out.allocation =
      counted(allocate(out.image.getMemoryRequirements(), MemoryUse::device, true), options.kind);
  out.image.bindMemory(out.allocation.memory(), out.allocation.offset());
  out.view = vk::raii::ImageView(
      device_.device,
      vk::ImageViewCreateInfo({}, *out.image, vk::ImageViewType::e2D, options.format, {},
                              vk::ImageSubresourceRange(out.aspect, 0, options.mip_levels, 0, 1)));
  return out;
}

std::uint64_t Memory::block_bytes() const {
  std::uint64_t sum = 0;
  for (const Allocation::Block& block : blocks_) sum += block.pieces.size();
  return sum;
}

void Memory::add_to(MemoryAccount& account) const {
  for (std::size_t i = 0; i < kMemoryKinds; ++i) {
    account.kinds[i].host += shares_[i].host;
    account.kinds[i].device += shares_[i].device;
    account.kinds[i].spilled += shares_[i].spilled;
  }
  MemoryShare& unused = account[MemoryKind::unused];
  for (const Allocation::Block& block : blocks_)
    (block.device_local ? unused.device : unused.host) += block.pieces.free_bytes();
}

void Memory::release_unused() {
  blocks_.remove_if([](const Allocation::Block& block) { return block.pieces.unused(); });
}

}  // namespace scenegen::render::vkr
