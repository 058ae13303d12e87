// The renderer's parts put together for one scene and one view, for experiments that record commands in ways
// that no strategy does.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "render/draw_scene.h"
#include "render/gpu_scene.h"
#include "render/passes/pass_recording.h"
#include "render/passes/targets.h"
#include "render/view.h"
#include "timeline/player.h"
#include "tools/experiments/experiment.h"

namespace scenegen::tools {

/// Milliseconds of one frame, the only one in flight.
struct StageFrame {
  double record_ms = 0;
  double submit_ms = 0;
  double wait_ms = 0;  ///< until the device is done
  double gpu_ms = -1;  ///< by the device's clock; -1 without one
  [[nodiscard]] double whole_ms() const { return record_ms + submit_ms + wait_ms; }
};

class DrawStage {
 public:
  /// The scene at the end of its time. `pass`: colour, with the context's samples, or ids.
  [[nodiscard]] static Result<std::unique_ptr<DrawStage>> make(const ExperimentContext& context,
                                                               const Scene& scene, const render::View& view,
                                                               render::vkr::PassKind pass);

  /// What Vulkan throws becomes an error.
  [[nodiscard]] Result<void> guarded(const std::function<void()>& body) const;

  /// `record` is given a frame that has begun, with the camera in place, and no pass begun. Throws as Vulkan
  /// does.
  StageFrame frame(const std::function<void(const render::PassContext&)>& record);

  /// The colour picture that the last frame left, sRGB, rows from the top; for tests.
  [[nodiscard]] std::vector<std::uint8_t> read_picture();

  [[nodiscard]] render::vkr::Device& device() { return *device_; }
  [[nodiscard]] render::vkr::Memory& memory() { return memory_; }
  [[nodiscard]] render::vkr::Pipelines& pipelines() { return pipelines_; }
  [[nodiscard]] const render::DrawScene& scene() const { return *scene_; }
  [[nodiscard]] render::GpuScene& gpu() { return *gpu_; }
  [[nodiscard]] render::Target& target() { return target_; }
  [[nodiscard]] const render::View& view() const { return view_; }
  /// Of the frames from now on.
  void look(const render::View& view) { view_ = view; }

 private:
  DrawStage(const ExperimentContext& context, const Scene& scene, const render::View& view,
            render::vkr::PassKind pass);

  // In order of construction; destroyed backwards.
  std::shared_ptr<render::vkr::Device> device_;
  render::View view_;
  render::vkr::Memory memory_;
  render::vkr::Pipelines pipelines_;
  render::Target target_, shadow_;
  std::optional<render::DrawScene> scene_;
  std::optional<render::GpuScene> gpu_;
  render::vkr::FrameRing ring_;
};

/// Memory that this process holds, B; 0 where it cannot be told.
[[nodiscard]] std::uint64_t resident_bytes();

}  // namespace scenegen::tools
