// Draws that the device culls by itself (D 5.4, table 6): one indirect draw an object, whose number of
// instances a compute shader sets to 0 or 1 by the frustum.
#pragma once

#include "tools/experiments/draw_stage.h"

namespace scenegen::tools {

class DeviceCulling {
 public:
  /// The stage's scene must have one state of drawing. Throws as Vulkan does.
  explicit DeviceCulling(DrawStage& stage);
  /// Culls, then draws: a whole frame.
  void record(const render::PassContext& context);
  /// Draws that the last frame left, read back; waits for the device.
  [[nodiscard]] std::uint32_t drawn();

 private:
  DrawStage& stage_;
  std::uint32_t count_;
  render::vkr::Buffer boxes_, commands_;
  vk::raii::DescriptorSetLayout set_layout_{nullptr};
  vk::raii::PipelineLayout layout_{nullptr};
  vk::raii::Pipeline pipeline_{nullptr};
  vk::raii::DescriptorPool pool_{nullptr};
  vk::DescriptorSet set_;
};

}  // namespace scenegen::tools
