// Which slots culling on the device looks at together, and in what order: pure processor code.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/draw_scene.h"
#include "render/shaders/hi_z_types.h"
#include "render/spatial/slot_boxes.h"
#include "render/view.h"

namespace scenegen::render {

/// How opaque and masked slots are cut into blocks: what is known before anything is laid out.
struct HiZCut {
  std::vector<std::uint32_t> firsts;  ///< of groups, neighbours of one state and geometry; and their end
  std::uint32_t block_slots = 256;    ///< at most, of each block; 64 where few share a geometry

  explicit HiZCut(const DrawScene& scene);
  /// As many as a layout has, and those of geometries without indices, of which it draws nothing.
  [[nodiscard]] std::uint64_t blocks() const;
};

/// Slots of the scene in blocks that share state and geometry and are compact in space. Not changed once it
/// is made.
struct HiZLayout {
  /// Blocks [first, end) that one pipeline state draws.
  struct Run {
    std::uint32_t batch = 0;
    bool mirrored = false;  ///< the device may draw mirrored slots of it
    std::uint32_t first = 0;
    std::uint32_t end = 0;
  };
  std::uint32_t block_slots = 256;   ///< as of HiZCut
  std::vector<std::uint32_t> slots;  ///< what `first` and `count` of blocks speak of
  std::vector<HiZBlock> blocks;
  std::vector<HiZGroup> groups;
  std::vector<Run> runs;
  std::vector<std::uint32_t> block_of_slot;  ///< kHiZNone: nothing is drawn of it
  std::vector<std::uint32_t> run_of_block;
  bool mirrored = false;  ///< some runs draw mirrored slots

  /// `ranges`: of each geometry. Cut as HiZCut says, along a Hilbert curve through the middles of where
  /// slots are now. States of which a slot is mirrored now draw such slots, with `all_mirrored` every one.
  HiZLayout(const DrawScene& scene, std::span<const GeometryRange> ranges, bool all_mirrored);
  /// Is this slot drawn when it is mirrored?
  [[nodiscard]] bool draws_mirrored(std::uint32_t slot) const;
  [[nodiscard]] std::uint64_t memory_bytes() const;

 private:
  void add_group(const DrawScene& scene, std::span<const GeometryRange> ranges, std::uint32_t first,
                 std::uint32_t end);
};

/// The blocks of a layout that a frame looks at: those in the frustum, each state's from front to back.
class HiZOrder {
 public:
  /// Blocks [first, first + count) of blocks() belong to the run.
  struct Part {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };
  HiZOrder(const HiZLayout& layout, const DrawScene& scene);

  /// The slot is somewhere else now: its block reaches there too, and keeps reaching where it was.
  void moved(std::uint32_t slot, const Box& box);
  /// By where blocks have their middles. O(blocks), allocates nothing.
  void rank(const View& view);
  [[nodiscard]] std::span<const std::uint32_t> blocks() const { return std::span(ranked_).first(count_); }
  /// One a run of the layout.
  [[nodiscard]] std::span<const Part> parts() const { return parts_; }
  [[nodiscard]] std::uint64_t memory_bytes() const;

 private:
  static constexpr std::uint32_t kBuckets = 1024;  // of distance
  const HiZLayout& layout_;
  SlotBoxes boxes_;  // of blocks
  Box bounds_m_;     // of all
  BitSet all_;
  std::vector<std::uint64_t> inside_;
  std::vector<std::uint16_t> bucket_;
  std::vector<std::uint32_t> found_, sorted_, ranked_;
  std::vector<Part> parts_;
  std::array<std::uint32_t, kBuckets> next_{};
  std::uint32_t count_ = 0;
};

}  // namespace scenegen::render
