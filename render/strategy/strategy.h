// A way of drawing the scene. One file each; a new one adds a line to registry.cpp and touches no other.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/draw_scene.h"
#include "render/memory_account.h"
#include "render/model/choice.h"
#include "render/model/prediction.h"
#include "render/node_overlay.h"
#include "render/plan_counters.h"
#include "render/stage_timer.h"
#include "render/strategy_names.h"
#include "render/strategy_options.h"
#include "render/view.h"

namespace scenegen::render {

class DrawRecorder;
class PassRecording;
namespace vkr {
struct Device;
}

/// What a strategy may keep a reference to: all of it outlives the strategy.
struct StrategyContext {
  const DrawScene& scene;
  const vkr::Device& device;
  StrategyOptions options;
  const model::UnitCosts&
      costs;  ///< may become better from frame to frame, never between plan() and draw_*()
  std::uint32_t frames_in_flight = 2;
  glm::uvec2 size{0};  ///< of the pictures, pixels; resized() tells another
  /// An octree starts empty and is filled by CachedOctree::catch_up(), a slice a frame.
  bool octree_in_slices = false;
  bool shadows = false;  ///< of the sun are drawn, whatever the strategy
  bool readback = true;  ///< pictures are copied out
};

/// What a frame took that was submitted some frames ago, seconds; gpu_s < 0: not measured.
struct FrameTimes {
  std::uint64_t serial = 0;  ///< frames are counted from 1
  double cpu_s = 0;
  double gpu_s = -1;
};

/// Counts of a frame that the device made; added to its report.
struct DeviceCounts {
  std::uint64_t drawn = 0;    ///< slots of the colour pass
  std::uint64_t reveals = 0;  ///< slots drawn in second parts, of all passes
  std::uint64_t triangles = 0;
  std::uint64_t ids_triangles = 0;
};

/// What a strategy that chooses among others took.
struct ChoiceReport {
  std::string_view used;  ///< name of a strategy
  model::Verdict verdict;
  double choose_s = 0;  ///< what the choice itself took, part of plan()
};

/// Knows neither files nor tracks. A frame: update() with a ChangeSet that DrawScene has taken, plan() on the
/// processor, then draw_solid() and draw_blended() once a pass.
class Strategy {
 public:
  Strategy() = default;
  Strategy(const Strategy&) = delete;
  Strategy& operator=(const Strategy&) = delete;
  virtual ~Strategy() = default;

  virtual void update(const timeline::ChangeSet& changes) = 0;
  virtual void plan(const View& view) = 0;
  /// Draws opaque and masked objects into a pass that has not begun.
  virtual void draw_solid(PassRecording& pass) = 0;
  /// Draws blended objects, back to front.
  virtual void draw_blended(DrawRecorder& recorder) = 0;
  /// The pictures have another size: nothing that holds a viewport is good any more. No frame is in flight.
  virtual void resized(glm::uvec2 /*size*/) {}
  /// An earlier frame was finished: for strategies that learn.
  virtual void finished(const FrameTimes& /*measured*/) {}
  /// What only the device knew of a frame, once that is done.
  [[nodiscard]] virtual DeviceCounts device_counts(std::uint64_t /*serial*/) const { return {}; }
  /// For the model's prediction of the frame that was just drawn; what this way of drawing did not find out
  /// stays 0 and `exact_*` false. Not part of drawing: called only when someone wants predictions.
  [[nodiscard]] virtual model::FrameFacts facts() const { return {}; }

  /// Of a strategy that chooses among others, about the last plan(); null: it does not.
  [[nodiscard]] virtual const ChoiceReport* choice() const { return nullptr; }
  /// Chunks in the frustum of the frame that was just drawn; none for strategies without an octree. For
  /// pictures of how it works.
  [[nodiscard]] virtual std::vector<ChunkBox> chunk_boxes() const { return {}; }

  /// Adds the host memory that it holds, and what drivers hold for it; its Vulkan memory is counted where it
  /// was allocated.
  virtual void add_memory(MemoryAccount& /*to*/) const {}

  /// Of the last plan and the passes since.
  [[nodiscard]] const PlanCounters& counters() const { return counters_; }
  /// What a person should know: a limit met, a slower way taken.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 protected:
  PlanCounters counters_;
  std::vector<std::string> warnings_;
};

struct StrategyEntry {
  std::string_view name;
  std::string_view summary;
  std::unique_ptr<Strategy> (*make)(const StrategyContext& context);
  StrategyTraits traits = {};
};

/// All strategies, in the order in which help lists them.
[[nodiscard]] std::span<const StrategyEntry> strategies();
/// Null when there is none of that name.
[[nodiscard]] const StrategyEntry* find_strategy(std::string_view name);

}  // namespace scenegen::render
