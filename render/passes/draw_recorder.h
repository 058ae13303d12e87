// Records draws of slots into a pass that has begun, binding only what changes from one to the next.
#pragma once

#include <cstdint>
#include <vulkan/vulkan_raii.hpp>

#include "render/draw_scene.h"
#include "render/gpu_scene.h"
#include "render/vk/pipelines.h"

namespace scenegen::render {

/// What was recorded.
struct Recorded {
  std::uint64_t draws = 0;
  std::uint64_t triangles = 0;
  std::uint64_t state_changes = 0;  ///< pipelines, sets of textures and windings bound
  void add(const Recorded& other) {
    draws += other.draws;
    triangles += other.triangles;
    state_changes += other.state_changes;
  }
};

/// Draws that stand in device memory, all of one state.
struct IndirectDraws {
  std::uint32_t slot = 0;  ///< one of them
  vk::Buffer commands;     ///< VkDrawIndexedIndirectCommand, one after the other
  std::uint64_t offset = 0;
  std::uint32_t count = 0;
  std::uint64_t triangles = 0;
  vk::Buffer counts;  ///< if given: no more are drawn than the 32-bit number there says
  std::uint64_t counts_offset = 0;
};

/// The same, of slots that stand in the list of read_slots_from(). What is drawn only the device knows.
struct ListedIndirectDraws {
  std::uint32_t batch = 0;
  bool mirrored = false;
  vk::Buffer commands;
  std::uint64_t offset = 0;
  std::uint32_t count = 0;
};

class DrawRecorder {
 public:
  DrawRecorder(const vk::raii::CommandBuffer& commands, vkr::Pipelines& pipelines, const GpuScene& gpu,
               const DrawScene& scene, vkr::PassKind pass);

  void draw(std::uint32_t slot) { draw_run(slot, 1); }
  /// Slots [first, first + count) at once; they must share a primitive and whether they are mirrored.
  void draw_run(std::uint32_t first, std::uint32_t count) { draw_instances(first, false, first, count); }

  void draw_indirect(const IndirectDraws& draws);

  void draw_listed_indirect(const ListedIndirectDraws& draws);

  /// Where draw_listed() and draw_listed_indirect() find slots: 32-bit numbers.
  void read_slots_from(vk::Buffer list);
  /// Slots [first, first + count) of that list at once; `slot`, one of them, stands for them: all share
  /// state, geometry and whether they are mirrored.
  void draw_listed(std::uint32_t slot, std::uint32_t first, std::uint32_t count) {
    draw_instances(slot, true, first, count);
  }

  [[nodiscard]] const Recorded& recorded() const { return recorded_; }

 private:
  void draw_instances(std::uint32_t slot, bool listed, std::uint32_t first, std::uint32_t count);
  void bind_batch(std::uint32_t batch, bool listed = false);
  void set_winding(bool mirrored, const DrawState& state);

  const vk::raii::CommandBuffer& commands_;
  vkr::Pipelines& pipelines_;
  const GpuScene& gpu_;
  const DrawScene& scene_;
  vkr::PassKind pass_;
  vk::Pipeline pipeline_;
  std::uint32_t batch_ = 0xFFFFFFFFU;
  bool listed_ = false;  // the pipeline takes slots from a list
  std::uint32_t texture_set_ = 0xFFFFFFFFU;
  vk::CullModeFlags cull_;
  vk::FrontFace front_ = vk::FrontFace::eCounterClockwise;
  Recorded recorded_;
};

/// Every visible opaque and masked slot, neighbours with the same primitive as one instanced draw: for passes
/// that no strategy plans (the shadow map).
void record_all_solid(DrawRecorder& recorder, const DrawScene& scene);

}  // namespace scenegen::render
