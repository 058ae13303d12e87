#include "timeline/profiles.h"

#include <algorithm>
#include <numeric>

#include "scene/color.h"
#include "timeline/track_table.h"
#include "timeline/words.h"

namespace scenegen::timeline {
namespace {

constexpr std::array<std::string_view, kProfileCount> kNames{"appear", "construct", "demolish", "temporary",
                                                             "drop",   "move",      "operate",  "neutral"};

glm::vec4 srgb(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  return {linear_from_srgb(r), linear_from_srgb(g), linear_from_srgb(b), 1.0F};
}

}  // namespace

std::string_view name(Profile profile) {
  return kNames[static_cast<std::size_t>(profile)];
}

Result<Profile> parse_profile(std::string_view text) {
  const auto found = std::find(kNames.begin(), kNames.end(), text);
  if (found != kNames.end()) return static_cast<Profile>(found - kNames.begin());
  return fail(ErrorKind::usage, "", unknown_word("profile", text, kNames));
}

ProfileOptions::ProfileOptions() {
  highlight.fill(glm::vec4(0.0F));
  const auto set = [&](Profile profile, const glm::vec4& linear) {
    highlight[static_cast<std::size_t>(profile)] = linear;
  };
  set(Profile::construct, srgb(0x43, 0xB0, 0x5C));
  set(Profile::demolish, srgb(0xD8, 0x43, 0x2F));
  set(Profile::temporary, srgb(0xF4, 0xC4, 0x30));
  set(Profile::move, srgb(0xF0, 0x8A, 0x24));
  set(Profile::operate, srgb(0x3A, 0x86, 0xD8));
}

double default_activity_s(const AppearanceInfo& info) {
  const double cells = static_cast<double>(info.cells.x) * info.cells.y * info.cells.z;
  return cells * info.interval_s / 20.0;
}

std::vector<Activity> activities_of_appearance(const Scene& scene, const CurveActivities& curve,
                                               std::span<const ObjectId> objects) {
  double duration_s = curve.duration_s;
  if (!(duration_s > 0) && scene.info.appearance) duration_s = default_activity_s(*scene.info.appearance);
  std::vector<Activity> out;
  const auto add = [&](ObjectId object) {
    if (!scene.objects.visibility[object.value].valid()) return;
    const std::optional<float> start_s = first_appearance_s(scene, object);
    if (!start_s) return;  // it never appears
    out.push_back({object, curve.profile, *start_s, *start_s + duration_s, curve.offset_m});
  };
  if (objects.empty()) {
    out.reserve(scene.objects.size());
    for (std::size_t i = 0; i < scene.objects.size(); ++i) add(ObjectId(i));
  } else {
    out.reserve(objects.size());
    for (const ObjectId object : objects) add(object);
  }
  return out;
}

Result<ProfileResult> apply_curve_profiles(Scene& scene, std::span<const Activity> activities,
                                           const ProfileOptions& options) {
  // What was given with the times: the last of them, and how long to hold after the last event.
  const double hold_s = scene.info.appearance ? scene.info.appearance->hold_s : 0.0;
  Result<ProfileResult> result = apply_profiles(scene, activities, options);
  if (!result) return result;
  remove_unused_tracks(scene);
  float last_s = 0;
  for (std::size_t i = 0; i < scene.tracks.size(); ++i) {
    last_s = std::max(last_s, scene.times_s(TrackId(i)).back());
  }
  scene.duration_s = std::max(scene.duration_s, static_cast<float>(last_s + hold_s));
  return result;
}

}  // namespace scenegen::timeline
