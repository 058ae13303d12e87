// What the activities of one object amount to, before anything is added to a scene. For profiles.cpp.
#pragma once

#include <span>
#include <vector>

#include "timeline/profiles.h"

namespace scenegen::timeline {

/// An activity with its times as tracks keep them.
struct ActivitySpan {
  Profile profile = Profile::appear;
  float start_s = 0, finish_s = 0;
  glm::vec3 offset_m{0.0F};  ///< of move; else zero
  friend bool operator==(const ActivitySpan&, const ActivitySpan&) = default;
};

constexpr std::uint8_t kOwnLook = 0xFF;

struct LookKey {
  float time_s = 0;
  std::uint8_t look = kOwnLook;  ///< a profile whose highlight is shown, or kOwnLook
  friend auto operator<=>(const LookKey&, const LookKey&) = default;
};

struct WayKey {
  float time_s = 0;
  glm::vec3 offset_m{0.0F};  ///< from where it is at rest, in the world
};

/// Keys strictly increase in time.
struct ObjectPlan {
  bool keeps_visibility = false;         ///< nothing is said of whether it is there
  bool there_at_start = true;            ///< at t = 0
  std::vector<float> visibility_flip_s;  ///< when it comes and goes, in turn
  std::vector<LookKey> looks;            ///< empty: always its own look
  std::vector<WayKey> way;               ///< empty: it stays where it is
};

/// `spans` in order of start, then finish. Errors: contradictions (apply_profiles), `where` empty.
[[nodiscard]] Result<ObjectPlan> plan_object(std::span<const ActivitySpan> spans,
                                             const ProfileOptions& options, float drop_height_m);

}  // namespace scenegen::timeline
