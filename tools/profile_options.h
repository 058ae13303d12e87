// Options of appearance profiles, which several verbs take: generate and animate (along a curve), schedule
// (by the types of its tasks).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "timeline/profiles.h"
#include "tools/cli.h"

namespace scenegen::tools {

struct ProfileRequest {
  timeline::Profile profile = timeline::Profile::appear;  ///< along a curve
  double duration_s = 0;                                  ///< along a curve; 0: default_activity_s()
  glm::dvec3 move_z_up_m{10, 0, 0};                       ///< author's frame
  timeline::ProfileOptions options;                       ///< colors, their form, the height of drops
};

/// Where profiles come from: the options --profile and --profile-duration, or the tasks of a plan.
enum class ProfileSource : std::uint8_t { curve, plan };

/// Adds the group "Profile". The options write into `request`, which must outlive them.
void add_profile_options(Options& options, ProfileRequest& request, ProfileSource source);

/// Options that have no effect when objects get only the profiles `used` (for generate: request.profile).
[[nodiscard]] std::vector<Conflict> profile_conflicts(const ProfileRequest& request,
                                                      std::span<const timeline::Profile> used);

/// "construct, demolish, …": for the help of options that take the name of a profile.
[[nodiscard]] std::vector<std::pair<std::string, timeline::Profile>> profile_choices();

/// What --profile, --profile-duration and --move-offset say, for timeline::activities_of_appearance().
[[nodiscard]] timeline::CurveActivities curve_activities(const ProfileRequest& request);

}  // namespace scenegen::tools
