// Plays a Timeline: seek and advance, forwards and backwards.
#pragma once

#include <glm/glm.hpp>
#include <memory>

#include "timeline/timeline.h"

namespace scenegen::timeline {

/// State of the scene at one time. Costs: a step O(changes); a seek O(log events + min(events passed,
/// tracks)) plus the objects changed; no allocation after construction. The first seek after construction
/// reports against the state before the first key (objects without a track are visible, the others as their
/// first key says).
class Player {
 public:
  explicit Player(std::shared_ptr<const Timeline> timeline);
  ~Player();
  Player(Player&&) noexcept;
  Player& operator=(Player&&) noexcept;

  /// Goes to `time_s` (clamped to [0, duration]; NaN is 0).
  const ChangeSet& seek(double time_s);
  /// seek(time_s() + dt_s); dt_s may be negative.
  const ChangeSet& advance(double dt_s);

  [[nodiscard]] double time_s() const;
  [[nodiscard]] bool visible(ObjectId id) const;
  [[nodiscard]] std::size_t visible_count() const;
  [[nodiscard]] glm::mat4 world_from_object(ObjectId id) const;
  [[nodiscard]] MeshId mesh(ObjectId id) const;
  [[nodiscard]] glm::vec4 base_color(MaterialId id) const;
  [[nodiscard]] glm::vec3 emissive(MaterialId id) const;
  [[nodiscard]] glm::mat4 world_from_camera(CameraId id) const;
  [[nodiscard]] const Timeline& timeline() const;
  /// Host memory held by the player, without its timeline.
  [[nodiscard]] std::uint64_t memory_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace scenegen::timeline
