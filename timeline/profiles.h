// Appearance profiles: what is seen of an object while something happens to it (METHODS 1: visibility,
// transform and material timelines together). Turns activities into tracks.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::timeline {

enum class Profile : std::uint8_t {
  appear,     ///< hidden, from start on there
  construct,  ///< hidden; highlighted from start to finish; then its own look
  demolish,   ///< there; highlighted from start to finish; then gone
  temporary,  ///< there from start to finish only, highlighted
  drop,       ///< hidden; from start to finish it comes down into place; then there
  move,       ///< there, highlighted from start to finish while it goes by `offset_m`; stays there
  operate,    ///< there; highlighted from start to finish
  neutral,    ///< there from start on, never highlighted
};
constexpr std::size_t kProfileCount = 8;
[[nodiscard]] std::string_view name(Profile profile);
/// "appear", "construct", …; the error names the nearest one and all. Its `where` is empty.
[[nodiscard]] Result<Profile> parse_profile(std::string_view text);

/// One thing that happens to one object. An object may have several (construct, move, demolish); they are
/// taken in order of start.
///
/// What is there and what not: an object whose first activity is demolish, move or operate is there from the
/// beginning, else it is hidden until that activity starts. Activities may overlap: appear, construct and
/// neutral of what is there already hide nothing, spans of temporary join, of two demolitions the later
/// finish counts, a demolition ends a temporary. The highlight is that of the activity that started last and
/// has not finished. Contradictions are errors (below).
struct Activity {
  ObjectId object;
  Profile profile = Profile::appear;
  double start_s = 0, finish_s = 0;  ///< finish_s of appear and neutral means nothing
  glm::vec3 offset_m{0.0F};          ///< of `move`, in the world (Y up)
};

enum class ColorForm : std::uint8_t {
  swap,     ///< STEP tracks over meshes that share geometry: plays in every viewer
  pointer,  ///< a material of its own per timeline, whose base colour is animated (STEP)
};

struct ProfileOptions {
  ColorForm color = ColorForm::swap;
  /// Linear RGBA by profile; alpha 0: no highlight. By default construct #43b05c (green), demolish #d8432f
  /// (red), temporary #f4c430 (yellow), move #f08a24 (orange), operate #3a86d8 (blue), the others none.
  std::array<glm::vec4, kProfileCount> highlight;
  double drop_height_m = 0;  ///< 0: a tenth of the scene's height, at least one metre
  ProfileOptions();
};

/// What was added, for whoever writes it into a file that must keep the rest (scene/gltf/patch.h).
struct ProfileResult {
  std::size_t first_new_material = 0;
  /// For materials from first_new_material on: the material it copies but for its colour, or none.
  std::vector<MaterialId> copy_of;
};

/// Adds tracks, frames, meshes and materials to the ENDS of the scene's arrays; what stood there keeps its
/// place and content, but for Objects::visibility, Objects::frame and, of what is never seen in its own look
/// or highlighted by ColorForm::pointer, Objects::mesh of the objects that are named. Visibility that was
/// there is replaced unless all activities of the object are move or operate. Objects with equal timelines
/// share tracks, meshes and frames. Raises duration_s to the last finish (not beyond).
///
/// Highlights by `swap`: a mesh of the same geometry in a plain material without textures, which keeps
/// double_sided and unlit; a see-through material stays so, a masked one keeps the texture that it is cut out
/// by. By `pointer`: a copy of the material whose base_color is the highlight, so a texture (or vertex
/// colours) is tinted by it: glTF multiplies them.
///
/// Ways are LINEAR with a few keys: drop slows down towards its place (1 - (1 - u)^3), move starts and ends
/// gently (u^2 (3 - 2 u)). Offsets are turned into the coordinates of the object's frame as that is at rest,
/// also where it moves. A move stays in force: what is demolished and built again stands where it was moved.
///
/// Errors (usage unless said): an object that is not there; times that are negative, not finite or in the
/// wrong order; two activities of one object that start together under different profiles; drop or temporary
/// of what is there already; demolish, move or operate of what is not there; movements that overlap;
/// (bad_input) an object that already changes its look; a frame at rest that cannot be inverted, or is nested
/// as deeply as limits allow. On an error the scene is as it was.
[[nodiscard]] Result<ProfileResult> apply_profiles(Scene& scene, std::span<const Activity> activities,
                                                   const ProfileOptions& options);

/// How appearance along a curve becomes activities.
struct CurveActivities {
  Profile profile = Profile::appear;
  double duration_s = 0;     ///< from start to finish; 0: default_activity_s()
  glm::vec3 offset_m{0.0F};  ///< of `move`
};
/// A twentieth of the time that the curve takes: at any time about a twentieth of the objects is under way.
[[nodiscard]] double default_activity_s(const AppearanceInfo& info);

/// After assign_appearance: one activity for each of `objects` (ascending; empty: all) that has a visibility
/// track; it starts when the object would appear. So `construct` and `drop` begin at its cell's time,
/// `demolish` begins to take away what is there, `temporary` stays for the duration. Coherence measures the
/// same start (timeline/appearance.h).
[[nodiscard]] std::vector<Activity> activities_of_appearance(const Scene& scene, const CurveActivities& curve,
                                                             std::span<const ObjectId> objects = {});

/// apply_profiles() of the activities of an appearance: drops the visibility tracks that nothing names any
/// more and keeps info.appearance->hold_s after the last event.
[[nodiscard]] Result<ProfileResult> apply_curve_profiles(Scene& scene, std::span<const Activity> activities,
                                                         const ProfileOptions& options);

}  // namespace scenegen::timeline
