// Culling on the device: which slots a pass draws, found by frustum and depth pyramid.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vulkan/vulkan_raii.hpp>

#include "render/config.h"
#include "render/passes/hi_z_layout.h"
#include "render/passes/pass_recording.h"

namespace scenegen::render {

/// What the device counted in a frame, by part.
struct HiZCounts {
  struct Part {
    std::uint32_t drawn = 0;  ///< slots
    std::uint32_t triangles = 0;
  };
  std::array<Part, 2> parts;
};

/// Of one kind of pass (colour; ids), each of which has a depth of its own. Everything but the bits of
/// visible and mirrored slots and the order of blocks stays on the device: 8 B and 1/8 B a slot, 72 B a
/// block.
class HiZ {
 public:
  HiZ(const PassContext& context, const Target& target, const HiZLayout& layout);

  /// Which depth picture there is now. No frame may be in flight.
  void resized(const PassContext& context, const Target& target);
  /// Sets of slots that are visible by timeline, and mirrored; `revision` tells one state of them from
  /// another. Returns how many bytes were written.
  std::uint64_t write_slots(const PassContext& context, std::uint64_t revision);
  /// Which blocks the frame looks at. Returns how many bytes were written.
  std::uint64_t write_order(const PassContext& context, const HiZOrder& order);
  /// Outside a pass: finds what a part (0 or 1) draws. Before part 1 the pyramid is made of the depth that
  /// part 0 left.
  void cull(const PassContext& context, Target& target, std::uint32_t part);
  /// Inside the pass.
  void draw(DrawRecorder& recorder, const HiZOrder& order, std::uint32_t part) const;
  /// What was counted in a frame that is done; nothing when it was not drawn this way, or its place was used
  /// again.
  [[nodiscard]] HiZCounts counts(std::uint64_t serial, std::uint32_t frames_in_flight) const;

 private:
  struct Place {  // of a frame in flight
    vkr::Buffer bits;
    vkr::Buffer order;   // of blocks
    vkr::Buffer counts;  // for the processor
    std::uint64_t revision = 0;
    std::uint64_t counted = 0;  // serial of the frame whose counts they are
    vk::DescriptorSet set;
  };
  void make_cull(const PassContext& context);
  void make_pyramid(const PassContext& context, const Target& target);
  /// To where the processor reads them once the frame is done.
  void copy_counts(const PassContext& context);
  void build_pyramid(const PassContext& context, Target& target);
  [[nodiscard]] Place& place(const PassContext& context) {
    return places_[context.frame.serial % context.frames_in_flight];
  }

  const HiZLayout& layout_;
  vk::Extent2D extent_;
  std::uint32_t levels_ = 1;
  std::uint64_t bit_words_ = 0;
  bool cleared_ = false;
  std::uint32_t in_order_ = 0;     // blocks that this frame looks at
  std::uint32_t longest_run_ = 1;  // commands of one indirect draw
  std::array<Place, kMostFramesInFlight> places_;
  vkr::Buffer blocks_, groups_, slots_, seen_, list_, commands_, pyramid_, counts_;
  vk::raii::Sampler sampler_{nullptr};
  vk::raii::DescriptorSetLayout cull_set_layout_{nullptr}, pyramid_set_layout_{nullptr};
  vk::raii::PipelineLayout cull_layout_{nullptr}, pyramid_layout_{nullptr};
  vk::raii::Pipeline cull_{nullptr}, first_levels_{nullptr}, more_levels_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
  vk::DescriptorSet pyramid_set_;
};

}  // namespace scenegen::render
