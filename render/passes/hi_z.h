// Culling on the device: which slots a pass draws, found by frustum and depth pyramid.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "render/config.h"
#include "render/passes/pass_recording.h"
#include "render/shaders/hi_z_types.h"

namespace scenegen::render {

/// Slots of the scene in blocks that share state and geometry, and the indirect draws that they come to: one
/// a block, one more for those of its slots that are mirrored. Not changed once it is made.
struct HiZLayout {
  /// Commands [first, first + count) that one pipeline state draws.
  struct Run {
    std::uint32_t batch = 0;
    bool mirrored = false;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  std::uint32_t block_slots = 256;  ///< at most, of each block
  std::uint32_t commands = 0;
  std::vector<HiZBlock> blocks;
  std::vector<HiZGroup> groups;
  std::vector<Run> runs;

  bool mirrored = false;  ///< some blocks have a command for mirrored slots

  /// 256, or 64 where geometries are shared by few.
  [[nodiscard]] static std::uint32_t block_slots_of(std::uint64_t slots, std::uint64_t groups) {
    return groups > 0 && slots / groups < 128 ? 64 : 256;
  }

  /// Blocks of 256 slots where as many share a geometry, else of 64. Those in which a slot is mirrored now
  /// have a command for such slots, with `all_mirrored` every one.
  HiZLayout(const DrawScene& scene, const GpuScene& gpu, std::uint32_t longest_run, bool all_mirrored);
  /// Does the block of this slot have a command for mirrored ones?
  [[nodiscard]] bool draws_mirrored(std::uint32_t slot) const;
  [[nodiscard]] std::uint64_t memory_bytes() const;
};

/// What the device counted in a frame, by part.
struct HiZCounts {
  struct Part {
    std::uint32_t drawn = 0;  ///< slots
    std::uint32_t triangles = 0;
  };
  std::array<Part, 2> parts;
};

/// Of one kind of pass (colour; ids), each of which has a depth of its own. Everything but the bits of
/// visible and mirrored slots stays on the device: 4 B and 1/8 B a slot, 40 B a block.
class HiZ {
 public:
  HiZ(const PassContext& context, const Target& target, const HiZLayout& layout);

  /// Which depth picture there is now. No frame may be in flight.
  void resized(const PassContext& context, const Target& target);
  /// Sets of slots that are visible by timeline, and mirrored; `revision` tells one state of them from
  /// another.
  void write_slots(const PassContext& context, std::uint64_t revision);
  /// Outside a pass: finds what a part (0 or 1) draws. Before part 1 the pyramid is made of the depth that
  /// part 0 left.
  void cull(const PassContext& context, Target& target, std::uint32_t part);
  /// Inside the pass.
  void draw(DrawRecorder& recorder, std::uint32_t part) const;
  /// What was counted in a frame that is done; nothing when it was not drawn this way, or its place was used
  /// again.
  [[nodiscard]] HiZCounts counts(std::uint64_t serial, std::uint32_t frames_in_flight) const;

 private:
  struct Place {  // of a frame in flight
    vkr::Buffer bits;
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
  std::array<Place, kMostFramesInFlight> places_;
  vkr::Buffer blocks_, groups_, seen_, list_, commands_, pyramid_, counts_;
  vk::raii::Sampler sampler_{nullptr};
  vk::raii::DescriptorSetLayout cull_set_layout_{nullptr}, pyramid_set_layout_{nullptr};
  vk::raii::PipelineLayout cull_layout_{nullptr}, pyramid_layout_{nullptr};
  vk::raii::Pipeline cull_{nullptr}, first_levels_{nullptr}, more_levels_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
  vk::DescriptorSet pyramid_set_;
};

}  // namespace scenegen::render
