// The one place where barriers are made. Callers say what a resource was used for and what comes next; the
// list that results is plain data and is unit-tested, because the validation layer misses some of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "render/vk/memory.h"

namespace scenegen::render::vkr {

struct UseScope {
  vk::PipelineStageFlags2 stages;
  vk::AccessFlags2 access;
  vk::ImageLayout layout;
};
[[nodiscard]] UseScope scope_of(Use use);

/// Collects the barriers between two steps of a frame and emits them in one command. Kept from frame to
/// frame, it allocates nothing more.
class Barriers {
 public:
  /// `everywhere`: every flush becomes a full barrier on all stages and all memory (`--barriers full`), which
  /// must give equal pictures.
  explicit Barriers(bool everywhere = false) : everywhere_(everywhere) {}

  Barriers& buffer(vk::Buffer buffer, Use before, Use after);
  /// From the image's last use, which is remembered in it, to `after`.
  Barriers& image(Image& image, Use after);
  /// For contents that are about to be overwritten: waits for the last use, keeps nothing.
  Barriers& discard(Image& image, Use after);
  Barriers& image_levels(vk::Image image, std::uint32_t first_level, std::uint32_t levels, Use before,
                         Use after);
  void flush(const vk::raii::CommandBuffer& commands);

  // What flush would emit.
  [[nodiscard]] const std::vector<vk::BufferMemoryBarrier2>& buffers() const { return buffers_; }
  [[nodiscard]] const std::vector<vk::ImageMemoryBarrier2>& images() const { return images_; }
  [[nodiscard]] std::span<const vk::MemoryBarrier2> memory() const;

 private:
  void add_image(vk::Image image, const vk::ImageSubresourceRange& range, Use before, Use after);

  bool everywhere_;
  std::vector<vk::BufferMemoryBarrier2> buffers_;
  std::vector<vk::ImageMemoryBarrier2> images_;
};

}  // namespace scenegen::render::vkr
