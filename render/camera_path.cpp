#include "render/camera_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string_view>

namespace scenegen::render {
namespace {

using nlohmann::json;
using Channels = std::array<double, 7>;

/// In the order of PathInterpolation.
constexpr std::array<std::string_view, 3> kInterpolations{"linear", "catmull-rom", "step"};

Channels channels(const CameraKey& k) {
  return {k.eye_m.x, k.eye_m.y, k.eye_m.z, k.target_m.x, k.target_m.y, k.target_m.z, k.yfov_rad};
}

std::optional<double> number(const json& object, const char* key) {
  const auto it = object.find(key);
  if (it == object.end() || !it->is_number()) return std::nullopt;
  const auto value = it->get<double>();
  constexpr double kMost = 1e9;  // metres or seconds; float positions mean nothing beyond it
  return std::isfinite(value) && std::abs(value) <= kMost ? std::optional(value) : std::nullopt;
}

std::optional<glm::dvec3> point(const json& object, const char* key) {
  const auto it = object.find(key);
  if (it == object.end() || !it->is_array() || it->size() != 3) return std::nullopt;
  glm::dvec3 p;
  for (int i = 0; i < 3; ++i) {
    const json& x = (*it)[static_cast<std::size_t>(i)];
    if (!x.is_number()) return std::nullopt;
    p[i] = x.get<double>();
    if (!std::isfinite(p[i]) || std::abs(p[i]) > 1e9) return std::nullopt;
  }
  return p;
}

/// A misspelt member would silently leave its default in force.
Result<void> check_members(const json& object, std::span<const std::string_view> known,
                           const std::string& where) {
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string names;
    for (const std::string_view name : known) names += (names.empty() ? "" : ", ") + std::string(name);
    return fail(ErrorKind::bad_input, where + "/" + key.substr(0, 40), "unknown member; one of: " + names);
  }
  return {};
}

Result<CameraKey> parse_key(const json& object, const std::string& where) {
  if (!object.is_object()) return fail(ErrorKind::bad_input, where, "must be an object");
  constexpr std::array<std::string_view, 4> kKnown{"time_s", "eye_m", "target_m", "yfov_rad"};
  if (Result<void> known = check_members(object, kKnown, where); !known) return forward_error(known);
  const auto time = number(object, "time_s");
  if (!time) return fail(ErrorKind::bad_input, where + "/time_s", "must be a number within +-1e9 s");
  const auto eye = point(object, "eye_m");
  if (!eye) return fail(ErrorKind::bad_input, where + "/eye_m", "must be three numbers within +-1e9 m");
  const auto target = point(object, "target_m");
  if (!target) return fail(ErrorKind::bad_input, where + "/target_m", "must be three numbers within +-1e9 m");
  if (*eye == *target) return fail(ErrorKind::bad_input, where + "/target_m", "must differ from eye_m");
  CameraKey key{*time, *eye, *target, 0.6};
  if (object.contains("yfov_rad")) {
    const auto fov = number(object, "yfov_rad");
    if (!fov || *fov < 0.01 || *fov > 3.0)
      return fail(ErrorKind::bad_input, where + "/yfov_rad", "must be a number from 0.01 to 3.0");
    key.yfov_rad = *fov;
  }
  return key;
}

}  // namespace

CameraKey CameraPath::at(double time_s) const {
  if (!(time_s > keys.front().time_s)) return keys.front();
  if (time_s >= keys.back().time_s) return keys.back();
  const auto next = std::upper_bound(keys.begin(), keys.end(), time_s,
                                     [](double t, const CameraKey& k) { return t < k.time_s; });
  const auto i = static_cast<std::size_t>(next - keys.begin()) - 1;
  const CameraKey& a = keys[i];
  if (interpolation == PathInterpolation::step) return a;
  const CameraKey& b = keys[i + 1];
  const double length = b.time_s - a.time_s;
  const double u = (time_s - a.time_s) / length;
  const Channels va = channels(a);
  const Channels vb = channels(b);
  Channels out{};
  for (std::size_t c = 0; c < out.size(); ++c) {
    if (interpolation == PathInterpolation::linear) {
      out[c] = va[c] + (vb[c] - va[c]) * u;
      continue;
    }
    // Hermite form; tangents over the neighbouring keys' times, one-sided at the ends.
    const auto slope = [&](std::size_t k) {
      const CameraKey& before = keys[k == 0 ? 0 : k - 1];
      const CameraKey& after = keys[std::min(k + 1, keys.size() - 1)];
      return (channels(after)[c] - channels(before)[c]) / (after.time_s - before.time_s);
    };
    const double u2 = u * u;
    const double u3 = u2 * u;
    out[c] = (2 * u3 - 3 * u2 + 1) * va[c] + (u3 - 2 * u2 + u) * length * slope(i) +
             (3 * u2 - 2 * u3) * vb[c] + (u3 - u2) * length * slope(i + 1);
  }
  return {time_s, {out[0], out[1], out[2]}, {out[3], out[4], out[5]}, std::clamp(out[6], 0.01, 3.0)};
}

View CameraPath::view(double time_s, float aspect) const {
  const CameraKey key = at(time_s);
  Lens lens;
  lens.yfov_rad = static_cast<float>(key.yfov_rad);
  lens.near_m = static_cast<float>(near_m);
  return make_view(look_at(glm::vec3(key.eye_m), glm::vec3(key.target_m)), lens, aspect);
}

std::string camera_path_json(const CameraPath& path) {
  using nlohmann::ordered_json;
  const auto list = [](const glm::dvec3& v) { return ordered_json{v.x, v.y, v.z}; };
  std::string out = "{\n  \"version\": 1,\n  \"interpolation\": \"";
  out += kInterpolations[static_cast<std::size_t>(path.interpolation)];
  out += "\",\n  \"near_m\": " + ordered_json(path.near_m).dump() + ",\n  \"keys\": [";
  for (const CameraKey& key : path.keys) {
    out += &key == &path.keys.front() ? "\n    " : ",\n    ";
    out += ordered_json{{"time_s", key.time_s},
                        {"eye_m", list(key.eye_m)},
                        {"target_m", list(key.target_m)},
                        {"yfov_rad", key.yfov_rad}}
               .dump();
  }
  return out + "\n  ]\n}\n";
}

Result<CameraPath> parse_camera_path(std::string_view text, const std::string& name) {
  const json document = json::parse(text, nullptr, false);
  if (document.is_discarded()) return fail(ErrorKind::bad_input, name, "is not JSON");
  if (!document.is_object()) return fail(ErrorKind::bad_input, name, "must be an object with /keys");
  constexpr std::array<std::string_view, 4> kKnown{"version", "interpolation", "near_m", "keys"};
  if (Result<void> known = check_members(document, kKnown, name + ": "); !known) return forward_error(known);
  if (document.contains("version") && document["version"] != 1)
    return fail(ErrorKind::bad_input, name + ": /version", "must be 1");
  CameraPath path;
  if (const auto it = document.find("interpolation"); it != document.end()) {
    const auto known = std::find(kInterpolations.begin(), kInterpolations.end(), *it);
    if (known == kInterpolations.end())
      return fail(ErrorKind::bad_input, name + ": /interpolation",
                  "must be \"linear\", \"catmull-rom\" or \"step\"");
    path.interpolation = static_cast<PathInterpolation>(known - kInterpolations.begin());
  }
  if (document.contains("near_m")) {
    const auto near = number(document, "near_m");
    if (!near || *near < 1e-4)
      return fail(ErrorKind::bad_input, name + ": /near_m", "must be a number from 0.0001");
    path.near_m = *near;
  }
  const auto keys = document.find("keys");
  if (keys == document.end() || !keys->is_array() || keys->empty())
    return fail(ErrorKind::bad_input, name + ": /keys", "must be a list of at least one key");
  for (std::size_t i = 0; i < keys->size(); ++i) {
    const std::string where = name + ": /keys/" + std::to_string(i);
    Result<CameraKey> key = parse_key((*keys)[i], where);
    if (!key) return forward_error(key);
    if (!path.keys.empty() && !(key->time_s > path.keys.back().time_s))
      return fail(ErrorKind::bad_input, where + "/time_s", "must be greater than the key's before it");
    path.keys.push_back(*key);
  }
  return path;
}

}  // namespace scenegen::render
