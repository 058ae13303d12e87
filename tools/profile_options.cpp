#include "tools/profile_options.h"

#include <algorithm>

#include "scene/color.h"
#include "scene/transform.h"

namespace scenegen::tools {

namespace {

using timeline::ColorForm;
using timeline::kProfileCount;
using timeline::Profile;

constexpr const char* kNone = "none";

std::string spell_highlight(std::size_t profile, const glm::vec4& color) {
  return std::string(name(static_cast<Profile>(profile))) + "=" + (color.w > 0 ? spell_color(color) : kNone);
}

std::string default_highlights() {
  const timeline::ProfileOptions defaults;
  std::string out;
  for (std::size_t i = 0; i < kProfileCount; ++i) {
    if (defaults.highlight[i].w > 0)
      out += (out.empty() ? "" : ", ") + spell_highlight(i, defaults.highlight[i]);
  }
  return out;
}

Result<void> parse_highlight(std::string_view text, timeline::ProfileOptions& target) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) {
    return fail(ErrorKind::usage, "", "'" + std::string(text) + "' is not of the form PROFILE=#rrggbb");
  }
  std::vector<std::string> names;
  for (const auto& [word, profile] : profile_choices()) names.push_back(word);
  const std::string_view profile = text.substr(0, equals), color = text.substr(equals + 1);
  const auto found = std::find(names.begin(), names.end(), profile);
  if (found == names.end()) return fail(ErrorKind::usage, "", unknown_word("profile", profile, names));
  const auto index = static_cast<std::size_t>(found - names.begin());
  const auto kind = static_cast<Profile>(index);
  if (kind == Profile::appear || kind == Profile::neutral)
    return fail(ErrorKind::usage, "", names[index] + " takes no time, so it cannot be highlighted");
  if (color == kNone) {
    target.highlight[index] = glm::vec4(0.0F);
    return {};
  }
  const Result<glm::vec4> parsed = parse_color(color);
  if (!parsed) return fail(ErrorKind::usage, "", parsed.error().what + ", nor the word none");
  target.highlight[index] = *parsed;
  return {};
}

/// "construct=#43b05c,move=none"; what is not named keeps its default.
Value highlight_value(timeline::ProfileOptions& target) {
  return {Value::Kind::text, "LIST", "PROFILE=#rrggbb, #rrggbbaa or none; separated by commas",
          [&target](std::string_view text) -> Result<void> {
            timeline::ProfileOptions fresh;
            for (std::size_t begin = 0; begin <= text.size();) {
              const std::size_t end = std::min(text.find(',', begin), text.size());
              if (auto r = parse_highlight(text.substr(begin, end - begin), fresh); !r) return r;
              begin = end + 1;
            }
            target.highlight = fresh.highlight;
            return {};
          },
          [&target] {
            const timeline::ProfileOptions defaults;
            std::string out;
            for (std::size_t i = 0; i < kProfileCount; ++i) {
              if (target.highlight[i] == defaults.highlight[i]) continue;
              out += (out.empty() ? "" : ",") + spell_highlight(i, target.highlight[i]);
            }
            return out;
          }};
}

/// A number of which 0 stands for a default in words.
Value real_or_default(double& target, double least, double most, std::string form) {
  Value value = real_value(target, least, most, std::move(form));
  value.spell = [&target] { return target == 0 ? std::string() : shortest(target); };
  return value;
}

/// "10,0,-2.5"
Value offset_value(glm::dvec3& target) {
  constexpr double kFar = 1e6;
  return {Value::Kind::text, "X,Y,Z", "each -1000000 to 1000000 m",
          [&target](std::string_view text) -> Result<void> {
            glm::dvec3 offset_m{};
            std::size_t begin = 0;
            for (int i = 0; i < 3; ++i) {
              const std::size_t end = std::min(text.find(',', begin), text.size());
              if ((end == text.size()) != (i == 2))
                return fail(ErrorKind::usage, "", "'" + std::string(text) + "' is not of the form X,Y,Z");
              auto part = parse_real(text.substr(begin, end - begin), -kFar, kFar);
              if (!part) return forward_error(part);
              offset_m[i] = *part;
              begin = end + 1;
            }
            target = offset_m;
            return {};
          },
          [&target] { return shortest(target.x) + "," + shortest(target.y) + "," + shortest(target.z); }};
}

}  // namespace

std::vector<std::pair<std::string, Profile>> profile_choices() {
  std::vector<std::pair<std::string, Profile>> out;
  for (std::size_t i = 0; i < kProfileCount; ++i) {
    const auto profile = static_cast<Profile>(i);
    out.emplace_back(name(profile), profile);
  }
  return out;
}

void add_profile_options(Options& options, ProfileRequest& r, ProfileSource source) {
  constexpr double kLongest = 1e6;  // s
  options.group("Profile");
  if (source == ProfileSource::curve) {
    options.add(
        "--profile", choice_value<Profile>(r.profile, profile_choices(), "NAME"),
        "what happens to an object at its time: it just appears; construct: highlighted while it is "
        "built; demolish: it was there and goes away; temporary: there for a while; drop: comes down "
        "into its place; move: goes by --move-offset; operate: highlighted for a while; neutral: as appear",
        Role::content);
    options.add("--profile-duration", real_or_default(r.duration_s, 1e-6, kLongest, "S"),
                "seconds that it takes", Role::content, "a twentieth of the time that the curve takes");
  }
  options.add("--highlight", highlight_value(r.options), "colors while something happens, by profile",
              Role::content, default_highlights());
  options.add("--color",
              choice_value<ColorForm>(r.options.color,
                                      {{"swap", ColorForm::swap}, {"pointer", ColorForm::pointer}}, "HOW"),
              "how highlights are written: swapped meshes play everywhere; pointer animates a copy of the "
              "material (KHR_animation_pointer), whose texture stays",
              Role::content);
  options.add("--drop-height", real_or_default(r.options.drop_height_m, 1e-3, 1e6, "M"),
              "metres that objects come down from", Role::content,
              "a tenth of the scene's height, at least 1");
  options.add("--move-offset", offset_value(r.move_z_up_m), "metres that objects move by, z is up",
              Role::content);
}

std::vector<Conflict> profile_conflicts(const ProfileRequest& r, std::span<const Profile> used) {
  const auto uses = [&](Profile profile) {
    return std::find(used.begin(), used.end(), profile) != used.end();
  };
  const timeline::ProfileOptions defaults;
  bool lasts = false, lit = false, changed = false, changed_others = false;
  std::string names;
  for (std::size_t i = 0; i < kProfileCount; ++i) {
    const auto profile = static_cast<Profile>(i);
    const bool differs = r.options.highlight[i] != defaults.highlight[i];
    if (!uses(profile)) changed_others = changed_others || differs;
    if (!uses(profile)) continue;
    names += (names.empty() ? "" : ", ") + std::string(name(profile));
    lasts = lasts || (profile != Profile::appear && profile != Profile::neutral);
    lit = lit || r.options.highlight[i].w > 0;
    changed = changed || differs;
  }
  const std::string why = "has no effect with --profile " + names;
  std::vector<Conflict> out;
  if (!lasts) out.push_back({"--profile-duration", why});
  if (!changed && (!lit || changed_others)) out.push_back({"--highlight", why});
  if (!lit) out.push_back({"--color", why + (lasts ? ", which is not highlighted" : "")});
  if (!uses(Profile::drop)) out.push_back({"--drop-height", why});
  if (!uses(Profile::move)) out.push_back({"--move-offset", why});
  return out;
}

timeline::CurveActivities curve_activities(const ProfileRequest& r) {
  return {r.profile, r.duration_s, y_up_from_z_up(glm::vec3(r.move_z_up_m))};
}

}  // namespace scenegen::tools
