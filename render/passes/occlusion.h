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

/// What is asked about.
struct Asked {
  std::uint32_t chunk = 0;
  std::uint64_t revision = 0;
  bool believed_hidden = false;
  Box box_m;  ///< already grown
};

/// One for each kind of pass (colour; ids), since each has a depth of its own. The predicates stand at a
/// fixed place, 4 B a chunk: kept commands name it. They are 1 at the start of each pass.
class Occlusion {
 public:
  /// Predicates need conditional rendering.
  Occlusion(const vkr::Device& device, bool predicates);

  /// Makes room for `asked` and chunk numbers below `chunks`. May throw for want of memory, records nothing.
  void reserve(const PassContext& context, std::size_t asked, std::size_t chunks);
  /// Null without predicates. Another one after reserve() grew it.
  [[nodiscard]] vk::Buffer predicates() const { return *predicates_.buffer; }

  /// Before the pass: predicates become 1, this frame's queries are reset.
  void begin_frame(const PassContext& context, std::span<const Asked> asked);
  /// Inside the pass: draws the boxes. Returns commands to execute.
  [[nodiscard]] vk::CommandBuffer boxes(const PassRecording& pass);
  /// Between the parts of a pass: this frame's results become the predicates of the chunks asked about.
  void set_predicates(const PassContext& context);

  /// What was asked in the frame that used this one's place before, and its results (0: hidden). Empty when
  /// there was none. To be called before begin_frame(); the device is done with that frame.
  struct Answers {
    std::span<const Asked> asked;
    std::span<const std::uint32_t> samples;
  };
  [[nodiscard]] Answers take_answers(const PassContext& context);

 private:
  struct Place {  // of a frame in flight
    vk::raii::QueryPool pool{nullptr};
    std::uint32_t room = 0;
    vkr::Buffer chunks;   // of each query
    vkr::Buffer results;  // of each query
    vk::DescriptorSet set;
    std::vector<Asked> asked;
    std::vector<std::uint32_t> samples;
  };
  [[nodiscard]] Place& place(const PassContext& context) {
    return places_[context.frame.serial % context.frames_in_flight];
  }
  void make_scatter();
  void describe(Place& place);

  const vkr::Device& device_;
  bool with_predicates_;
  std::array<Place, kMostFramesInFlight> places_;
  vkr::Buffer predicates_;
  std::vector<vkr::Buffer> old_predicates_;  // commands of frames in flight may name them
  vk::raii::DescriptorSetLayout set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  vk::raii::Pipeline scatter_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
};

}  // namespace scenegen::render
