// Occlusion queries of one pass, and the predicates that they set in the same frame.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "render/config.h"
#include "render/passes/pass_recording.h"
#include "scene/transform.h"

namespace scenegen::render {

/// What is asked about: `number`, `revision` and `guess` are the asker's business.
struct Asked {
  std::uint32_t number = 0;
  std::uint64_t revision = 0;
  bool believed_hidden = false;
  Box box_m;  ///< already grown
  /// Shares the query of the one before: its answer is about all of their boxes.
  bool with_previous = false;
  std::uint8_t guess = 0;  ///< why it is asked about, of what is not believed hidden, ...
  float wrong = 0;         ///< ... how often such guesses were wrong, ...
  bool limited = false;    ///< ... and whether that limits them
};

/// How many queries they take.
[[nodiscard]] std::size_t query_count(std::span<const Asked> asked);

/// A chunk whose predicate is the result of a query; the query's box bounds all that is drawn of the chunk.
struct Governed {
  std::uint32_t query = 0;  ///< index of this frame's queries
  std::uint32_t chunk = 0;
};

/// What becomes of results on the device.
enum class Predicates : std::uint8_t {
  none,         ///< nothing: the processor reads them, later
  conditional,  ///< conditional rendering of kept command buffers, also of those that nothing was asked about
  counts        ///< numbers of indirect draws of the chunks that are governed
};

/// Where a chunk's predicate stands, B.
constexpr std::uint64_t predicate_offset(std::uint32_t chunk) {
  return sizeof(std::uint32_t) * (std::uint64_t{chunk} + 1);
}
/// A predicate that always lets pass. Not for nothing: lavapipe (Mesa 22.3) takes the last number of draws
/// there was for indirect draws that are given none, so what is drawn first is given this one.
constexpr std::uint64_t kLetPassOffset = 0;

/// One for each kind of pass (colour; ids), since each has a depth of its own. The predicates stand at fixed
/// places, 4 B a chunk: kept commands name them.
class Occlusion {
 public:
  Occlusion(const vkr::Device& device, Predicates predicates);

  /// Makes room for so much `asked`, and chunk numbers below `chunks`. May throw for want of memory, records
  /// nothing.
  void reserve(const PassContext& context, std::size_t asked, std::size_t chunks);
  /// Null without predicates. Another one after reserve() grew it.
  [[nodiscard]] vk::Buffer predicates() const { return *predicates_.buffer; }

  /// Before the pass: this frame's queries are reset, conditional predicates let everything pass.
  void begin_frame(const PassContext& context, std::span<const Asked> asked,
                   std::span<const Governed> governed);
  /// Inside the pass, after what can hide: draws the boxes into the primary.
  void draw_boxes(const PassRecording& pass);
  /// The same as commands to execute; null when nothing is asked.
  [[nodiscard]] vk::CommandBuffer boxes(const PassRecording& pass);
  /// Between the parts of a pass: this frame's results become the predicates of the governed chunks.
  void set_predicates(const PassContext& context);

  /// What was asked in the frame that used this one's place before, and the results of its queries (0:
  /// hidden), to each that shares one. Empty when there was none. To be called before begin_frame(); the
  /// device is done with that frame.
  struct Answers {
    std::span<const Asked> asked;
    std::span<const std::uint32_t> samples;
  };
  [[nodiscard]] Answers take_answers(const PassContext& context);
  /// Host memory held.
  [[nodiscard]] std::uint64_t memory_bytes() const;

 private:
  struct Place {  // of a frame in flight
    vk::raii::QueryPool pool{nullptr};
    std::uint32_t room = 0;
    vkr::Buffer governed;
    vkr::Buffer results;  // of each query
    vk::DescriptorSet set;
    std::vector<Asked> asked;
    std::uint32_t queries = 0;
    std::uint32_t governed_count = 0;
    std::vector<std::uint32_t> samples;
  };
  [[nodiscard]] Place& place(const PassContext& context) {
    return places_[context.frame.serial % context.frames_in_flight];
  }
  [[nodiscard]] vkr::Use read() const {
    return form_ == Predicates::conditional ? vkr::Use::predicate : vkr::Use::indirect;
  }
  void make_scatter();
  void describe(Place& place);
  void record_boxes(const vk::raii::CommandBuffer& commands, const PassRecording& pass);

  const vkr::Device& device_;
  Predicates form_;
  bool fresh_ = false;  // predicates hold nothing yet
  std::array<Place, kMostFramesInFlight> places_;
  vkr::Buffer predicates_;
  std::vector<vkr::Buffer> old_predicates_;  // commands of frames in flight may name them
  vk::raii::DescriptorSetLayout set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  vk::raii::Pipeline scatter_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
};

}  // namespace scenegen::render
