// Draw commands of chunks that are kept in device memory (METHODS 6b): the other form of a kept chunk.
#pragma once

#include <cstdint>
#include <span>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "render/config.h"
#include "render/passes/pass_recording.h"
#include "render/ring_queue.h"
#include "render/spatial/octree.h"

namespace scenegen::render {

/// A chunk is one place with VkDrawIndexedIndirectCommands, the same for all passes, cut into runs of one
/// pipeline state: each run is drawn by one command straight in the primary command buffer. Slots that follow
/// one another and share a primitive are instances of one command. A place that a frame in flight may still
/// read is never written: a chunk that changed gets another, and the old one waits for the last frame that
/// used it. 20 B a slot at most, and an eighth of `most_draws` more. Places are written directly where the
/// device's memory can be mapped; copying took an NVIDIA H200 2 us for each.
class IndirectNodes {
 public:
  /// `most_draws` of a chunk. `fail_after`: throws out-of-memory when more places are wanted than this (0:
  /// never): for tests.
  /// With `single` each slot is a command.
  IndirectNodes(std::uint32_t most_draws, std::uint64_t fail_after, bool single);

  /// Draws of one state: `count` commands from `first` of the chunk's on.
  struct Run {
    std::uint32_t slot = 0;   ///< one of them
    std::uint32_t state = 0;  ///< what is bound for them, in slot order: the batch, and whether mirrored
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::uint64_t triangles = 0;
  };

  /// Before a pass begins: writes the draws of those of `chunks` that changed, and remembers that this frame
  /// uses all of them. Throws vk::SystemError when there is no memory.
  void update(const PassContext& context, const Octree& tree, std::span<const std::uint32_t> chunks,
              bool reversed);
  /// Would update() write nothing for this revision?
  [[nodiscard]] bool fresh(std::uint32_t chunk, std::uint64_t revision) const {
    return chunk < kept_.size() && kept_[chunk].place.size != 0 && kept_[chunk].revision == revision;
  }
  /// Chunks to draw in one part of a pass. With `counts` each command has a count there: the chunk's
  /// predicate if `governed`, else one that always lets pass.
  struct Part {
    std::span<const std::uint32_t> chunks;
    vk::Buffer counts;
    bool governed = false;
    bool reversed = false;
  };
  /// Draws chunks that update() was told of, state by state and in a state in the order of the chunks: what
  /// is bound changes as often as there are states, not chunks. Returns the number of commands.
  std::size_t draw(DrawRecorder& recorder, const Part& part);

  /// What is kept of some chunks, as far as it is fresh.
  struct Kinds {
    std::uint64_t chunks = 0, slots = 0, commands = 0, runs = 0;
  };
  [[nodiscard]] Kinds kinds(const Octree& tree, std::span<const std::uint32_t> chunks) const;

  /// Since the last call.
  struct Counters {
    std::uint64_t written = 0;        ///< chunks
    std::uint64_t written_draws = 0;  ///< slots in them
  };
  [[nodiscard]] Counters take_counters() { return std::exchange(counters_, {}); }
  /// Host memory held.
  [[nodiscard]] std::uint64_t memory_bytes() const;

 private:
  using Command = VkDrawIndexedIndirectCommand;
  struct Place {
    std::uint32_t block = 0;
    std::uint32_t first = 0;  // command of the block
    std::uint32_t size = 0;   // in units; 0: none
  };
  struct Kept {
    Place place;
    std::uint64_t revision = 0;
    std::uint64_t last_used = 0;  // serial of a frame
    std::uint32_t commands = 0;
    std::vector<Run> runs;
  };
  struct Retired {
    Place place;
    std::uint64_t last_used = 0;
  };
  struct Sent {
    std::uint32_t chunk = 0;
    std::uint32_t run = 0;
  };
  Place take(const PassContext& context, std::uint32_t draws);
  /// Into commands_.
  void write(const PassContext& context, const Octree::Chunk& chunk, Kept& kept, bool reversed);
  /// Mapped memory of this frame for so many commands.
  Command* stage(const PassContext& context, std::uint64_t commands);
  void copy_staged(const PassContext& context);

  static constexpr std::uint32_t kSizes = 8;
  std::uint32_t unit_;  // commands in an eighth of a chunk with the most draws
  std::uint32_t block_commands_;
  std::uint64_t fail_after_;
  bool single_;
  std::uint64_t places_ = 0;
  std::vector<vkr::Buffer> blocks_;
  std::uint32_t used_ = 0;  // commands of the last block
  std::vector<Place> free_[kSizes + 1];
  RingQueue<Retired> retired_;
  std::vector<Kept> kept_;                           // by chunk
  vkr::Buffer staging_[kMostFramesInFlight];         // of each frame in flight
  std::vector<std::uint32_t> changed_;               // scratch
  std::vector<Command> commands_;                    // scratch, of a chunk
  std::vector<std::uint32_t> runs_before_;           // scratch, by state
  std::vector<Sent> sent_;                           // scratch
  std::vector<std::vector<vk::BufferCopy>> copies_;  // scratch, by block
  Counters counters_;
};

}  // namespace scenegen::render
