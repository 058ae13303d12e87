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
/// "appear", "construct", …; the error names the nearest one.
[[nodiscard]] Result<Profile> parse_profile(std::string_view text);

/// One thing that happens to one object. An object may have several (construct, move, demolish); they are
/// taken in order of start.
struct Activity {
  ObjectId object;
  Profile profile = Profile::appear;
  double start_s = 0, finish_s = 0;
  glm::vec3 offset_m{0.0F};  ///< of `move`, in the world (Y up)
};

enum class ColorForm : std::uint8_t {
  swap,     ///< STEP tracks over meshes that share geometry: plays in every viewer
  pointer,  ///< a material of its own per timeline, whose base colour is animated: may be LINEAR
};

struct ProfileOptions {
  ColorForm color = ColorForm::swap;
  std::array<glm::vec4, kProfileCount> highlight;  ///< linear RGBA by profile; alpha 0: no highlight
  double drop_height_m = 0;                        ///< 0: a tenth of the scene's height, at least one metre
  ProfileOptions();
};

/// What was added, for whoever writes it into a file that must keep the rest (scene/gltf/patch.h).
struct ProfileResult {
  std::size_t first_new_material = 0;
  /// For materials from first_new_material on: the material it copies but for its colour, or none.
  std::vector<MaterialId> copy_of;
};

/// Adds tracks, frames, meshes and materials to the ENDS of the scene's arrays; what stood there keeps its
/// place and content, but for Objects::visibility and Objects::frame of the objects that are named. Objects
/// with equal timelines share tracks, meshes and frames. Raises duration_s to the last finish (not beyond).
/// Errors (usage): an object that is named twice at one time with other profiles, times not finite.
[[nodiscard]] Result<ProfileResult> apply_profiles(Scene& scene, std::span<const Activity> activities,
                                                   const ProfileOptions& options);

}  // namespace scenegen::timeline
