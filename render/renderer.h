// Draws a scene as its timeline plays. One frame, in named phases: update, plan, record, submit, finish.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/device_options.h"
#include "render/gpu_stage.h"
#include "render/memory_account.h"
#include "render/model/choice.h"
#include "render/model/unit_costs.h"
#include "render/node_overlay.h"
#include "render/plan_counters.h"
#include "render/strategy_options.h"
#include "render/view.h"
#include "scene/result.h"
#include "timeline/player.h"

namespace scenegen::render {

/// Which pictures a frame makes.
struct Outputs {
  bool color = true;
  bool ids = false;
  bool depth = false;
  bool readback = true;  ///< false: they stay on the device, and FrameResult has none
};

struct RendererOptions {
  DeviceOptions device;
  std::shared_ptr<vkr::Device> shared_device;  ///< used in place of opening one for `device`
  glm::uvec2 size{1280, 720};
  std::uint32_t samples = 4;  ///< of the colour picture: 1 or 4
  Outputs outputs;
  std::string strategy = "inline";
  StrategyOptions how;
  std::optional<model::UnitCosts> costs;  ///< from a calibration of this device; none: rough ones
  /// FrameReport::predicted is wanted; costs some 50 us a frame, milliseconds in large scenes, in no stage.
  bool predictions = false;
  bool shadows = true;
  /// Frames that may be submitted and not finished, 1 to 3. With 1 the processor and the device work one
  /// after the other.
  std::uint32_t frames_in_flight = 2;
  /// For tests: times by pass on a CPU device too, where they mean nothing (it works when it likes).
  bool gpu_stages_on_cpu = false;
  bool chunk_boxes = false;  ///< FrameResult::chunk_boxes are wanted
  MemoryFaults memory_faults;
  bool full_barriers = false;  ///< a full barrier at every step: must give equal pictures
};

/// What one frame did; times in ms. Stages of the base are parts of record_ms.
struct FrameReport : PlanCounters {
  double time_s = 0;
  std::uint64_t objects = 0;
  std::uint64_t changed = 0;        ///< entries of the ChangeSet
  std::uint64_t visible = 0;        ///< objects visible by timeline
  std::uint64_t draws = 0;          ///< draw commands of the colour pass, without the sky
  std::uint64_t triangles = 0;      ///< of the colour pass, without the sky
  std::uint64_t state_changes = 0;  ///< pipelines, sets of textures and windings bound there
  std::uint64_t shadow_draws = 0;
  std::uint64_t shadow_triangles = 0;
  std::uint64_t ids_draws = 0;  ///< of the pass of ids and depth
  std::uint64_t ids_triangles = 0;
  std::uint64_t uploaded_bytes = 0;
  double update_ms = 0;
  double update_octree_ms = 0;  ///< of it the strategy's own part, T_upd(H)
  double plan_ms = 0;           ///< culling and sorting
  double record_ms = 0;
  double upload_ms = 0;  ///< of it copying what changed to staging memory
  double submit_ms = 0;
  double wait_ms = 0;  ///< what the processor waited for the device
  double gpu_ms = -1;  ///< between the frame's timestamps; -1 when the device has none
  /// By GpuStage, of gpu_ms; -1 without timestamps and on a CPU device, whose timestamps inside a submission
  /// say nothing.
  std::array<double, kGpuStages> gpu_stages_ms{-1, -1, -1, -1, -1, -1, -1};
  double readback_ms = 0;

  std::string_view strategy_used;  ///< of `adaptive`: what it took
  model::Verdict verdict;          ///< and why; model::in_words()
  double choose_ms = 0;            ///< what choosing took, part of plan_ms
  double predict_ms = 0;           ///< what predicting took, in no stage
  /// By model::Method, with RendererOptions::predictions; not corrected.
  std::array<model::Prediction, model::kMethods> predicted;
  model::FrameFacts facts;  ///< what they were made from
};

/// Rows from the top. Pictures that were not asked for are empty.
struct FrameResult {
  FrameReport report;
  std::vector<std::uint8_t> rgba;  ///< sRGB
  std::vector<std::uint32_t> ids;  ///< ObjectId of the nearest opaque or masked object; 0xFFFFFFFF: none
  std::vector<float> depth;  ///< of the same, as in the depth buffer: View::distance_m makes metres of it
  std::vector<ChunkBox> chunk_boxes;  ///< what the octree's chunks were found to be
};

/// Not for several threads at once. After an error of kind no_device (a lost device, memory that ran out and
/// without which there is no slower way) every call gives that error again: it can only be destroyed.
class Renderer {
 public:
  /// Uploads the scene in the state of `player`. Errors: no_device, usage (unknown strategy, device, sample
  /// count, number of frames in flight). `scene` is not needed afterwards.
  [[nodiscard]] static Result<Renderer> create(const Scene& scene, const timeline::Player& player,
                                               const RendererOptions& options);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// Frames that may be submitted and not finished: RendererOptions::frames_in_flight.
  [[nodiscard]] std::uint32_t most_in_flight() const;
  [[nodiscard]] std::uint32_t in_flight() const;
  /// Draws the state of `player`, which differs from the last submitted one by `changes`. Must not be called
  /// with most_in_flight() frames unfinished.
  Result<void> submit(const timeline::ChangeSet& changes, const timeline::Player& player, const View& view);
  /// Waits for the oldest unfinished frame and copies its pictures; reuses the vectors of `out`.
  Result<void> finish(FrameResult& out);

  /// RendererOptions::predictions from the next frame on. Predicting reads boxes of the whole scene between
  /// recording and submitting: frames whose times count are better without.
  void set_predictions(bool wanted);

  /// Pictures of another size from now on. No frame may be unfinished. Errors as for create().
  Result<void> resize(glm::uvec2 size);

  [[nodiscard]] const DeviceInfo& device() const;
  [[nodiscard]] glm::uvec2 size() const;
  /// Images that could not be decoded, a strategy that had to go a slower way, and the like; may grow.
  [[nodiscard]] std::vector<std::string> warnings() const;
  /// Device memory taken from the driver, bytes.
  [[nodiscard]] std::uint64_t device_bytes() const;
  /// All memory of the renderer, of `player` and its timeline, by kind. Takes some microseconds a thousand
  /// chunks.
  [[nodiscard]] MemoryAccount memory(const timeline::Player& player) const;
  /// What the validation layer reported so far; forgets it.
  [[nodiscard]] std::vector<std::string> take_validation_messages();

 private:
  struct State;
  explicit Renderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace scenegen::render
