// A way of drawing the scene. One file each; a new one adds a line to registry.cpp and touches no other.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "render/draw_scene.h"
#include "render/view.h"

namespace scenegen::render {

class DrawRecorder;

/// Which part of a pass is being recorded: opaque and masked objects, or blended ones afterwards.
enum class DrawPart : std::uint8_t { solid, blended };

struct StrategyOptions {
  bool reversed = false;  ///< draw solid slots in reverse order: finds pixels where equal depths meet
};

/// What planning found, for the frame report.
struct PlanCounters {
  std::uint64_t tested = 0;  ///< boxes tested against the frustum
  std::uint64_t drawn = 0;   ///< slots in the list
};

/// Knows neither files nor tracks: it is fed ChangeSets (after DrawScene took them), plans on the processor,
/// then records into a pass that has begun. `record` may be called several times after one `plan`, once per
/// pass and part.
class Strategy {
 public:
  Strategy() = default;
  Strategy(const Strategy&) = delete;
  Strategy& operator=(const Strategy&) = delete;
  virtual ~Strategy() = default;

  virtual void update(const timeline::ChangeSet& changes) = 0;
  virtual PlanCounters plan(const View& view) = 0;
  virtual void record(DrawRecorder& recorder, DrawPart part) = 0;
};

struct StrategyEntry {
  std::string_view name;
  std::string_view summary;
  std::unique_ptr<Strategy> (*make)(const DrawScene& scene, const StrategyOptions& options);
};

/// All strategies, in the order in which help lists them.
[[nodiscard]] std::span<const StrategyEntry> strategies();
/// Null when there is none of that name.
[[nodiscard]] const StrategyEntry* find_strategy(std::string_view name);

}  // namespace scenegen::render
