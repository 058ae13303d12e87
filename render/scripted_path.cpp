#include "render/scripted_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace scenegen::render {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr std::array<std::string_view, 5> kNames{"fixed", "orbit", "walk", "fly", "cuts"};

constexpr double kYfovRad = 0.6;
constexpr double kTanHalfFov = 0.30933624960962325;  // tan(0.3)
constexpr double kAspect = 16.0 / 9.0;
constexpr double kMargin = 0.93;  // share of the picture that the scene may take

/// What the paths are laid out in.
struct Stage {
  Box framed_m;  ///< everything but the ground
  dvec3 centre_m{0.0};
  dvec3 half_m{1.0};
  double floor_m = 0;
  double radius_m = 1;
  double length_s = kStillPathS;
};

Stage stage_of(std::span<const Box> boxes, double duration_s) {
  Stage out;
  out.framed_m = framed_bounds(boxes);
  if (out.framed_m.empty()) out.framed_m = {glm::vec3(-1.0F), glm::vec3(1.0F)};
  out.centre_m = dvec3(out.framed_m.centre());
  out.half_m = 0.5 * dvec3(out.framed_m.size());
  // What is flat or thin still needs room round it.
  const double widest = std::max({out.half_m.x, out.half_m.y, out.half_m.z, 1e-3});
  out.half_m = glm::max(out.half_m, dvec3(0.1 * widest));
  out.floor_m = static_cast<double>(out.framed_m.lo.y);
  out.radius_m = glm::length(out.half_m);
  if (duration_s > 0) out.length_s = duration_s;
  return out;
}

/// A place in the box: x and z from -1 to 1 over its sides, y from 0 at the floor to 1 at the top.
dvec3 at(const Stage& s, double x, double y, double z) {
  return {s.centre_m.x + x * s.half_m.x, s.floor_m + 2 * y * s.half_m.y, s.centre_m.z + z * s.half_m.z};
}

/// How far along `to_eye` (unit) from the centre the box fits into a picture of 16:9.
double framing_distance(const Stage& s, const dvec3& to_eye) {
  const dvec3 right = glm::normalize(glm::cross(dvec3(0, 1, 0), to_eye));
  const dvec3 up = glm::cross(to_eye, right);
  const double ty = kMargin * kTanHalfFov;
  double out = 0;
  for (int k = 0; k < 8; ++k) {
    const dvec3 q = s.half_m * dvec3((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1);
    const double z = glm::dot(q, to_eye);
    out = std::max(
        {out, std::abs(glm::dot(q, up)) / ty + z, std::abs(glm::dot(q, right)) / (ty * kAspect) + z});
  }
  return out;
}

CameraKey overview(const Stage& s, double time_s, const dvec3& direction) {
  const dvec3 to_eye = glm::normalize(direction);
  return {time_s, s.centre_m + to_eye * framing_distance(s, to_eye), s.centre_m, kYfovRad};
}

CameraPath fixed(const Stage& s) {
  return {PathInterpolation::catmull_rom, 0.05, {overview(s, 0, {0.62, 0.5, 1.0})}};
}

/// One turn, 24 keys; all of the scene in view, from 24 degrees above.
CameraPath orbit(const Stage& s) {
  constexpr std::array kCosine{1.0, 0.9659258262890683, 0.8660254037844386, 0.7071067811865476,
                               0.5, 0.25881904510252074};  // of 0, 15, … 75 degrees
  constexpr double kRise = 0.445;
  constexpr int kKeys = 24;
  CameraPath path;
  std::vector<dvec3> directions;
  double distance = 0;
  for (int i = 0; i <= kKeys; ++i) {
    const auto cosine = [&](int k) {  // of k times 15 degrees
      k = ((k % 24) + 24) % 24;
      const int q = k % 6;
      switch (k / 6) {
        case 0:
          return kCosine[static_cast<std::size_t>(q)];
        case 1:
          return q == 0 ? 0.0 : -kCosine[static_cast<std::size_t>(6 - q)];
        case 2:
          return -kCosine[static_cast<std::size_t>(q)];
        default:
          return q == 0 ? 0.0 : kCosine[static_cast<std::size_t>(6 - q)];
      }
    };
    const int at_15 = i + 2;  // begins in front, a little to the right
    directions.push_back(glm::normalize(dvec3(cosine(at_15 - 6), kRise, cosine(at_15))));
    distance = std::max(distance, framing_distance(s, directions.back()));
  }
  for (int i = 0; i <= kKeys; ++i) {
    path.keys.push_back({s.length_s * i / kKeys,
                         s.centre_m + distance * directions[static_cast<std::size_t>(i)], s.centre_m,
                         kYfovRad});
  }
  return path;
}

/// A straight way through the scene, parallel to x or z.
struct Street {
  bool along_x = false;
  double offset_m = 0;  ///< z of one along x, x of one along z
};

constexpr int kLanes = 65;  // odd: one of them is the middle

/// Lane in the middle of the widest run of lanes with the fewest hits; of equally wide ones the nearest to
/// the middle.
int best_lane(const std::array<std::uint32_t, kLanes>& hits) {
  const std::uint32_t fewest = *std::min_element(hits.begin(), hits.end());
  int best = 0;
  int widest = 0;
  for (int lane = 0; lane < kLanes;) {
    int end = lane;
    while (end < kLanes && hits[static_cast<std::size_t>(end)] == fewest) ++end;
    const int middle = (lane + end - 1) / 2;
    const bool nearer = std::abs(middle - kLanes / 2) < std::abs(best - kLanes / 2);
    if (end - lane > widest || (end > lane && end - lane == widest && nearer)) {
      widest = end - lane;
      best = middle;
    }
    lane = std::max(end, lane + 1);
  }
  return best;
}

/// The one with the fewest boxes in it at the height of a person, in the inner half of the scene.
Street street_of(const Stage& s, std::span<const Box> boxes, double eye_m) {
  const double low = s.floor_m + 0.2 * eye_m;
  const double high = s.floor_m + 1.2 * eye_m;
  const double half_width = 0.4 * eye_m;
  Street best;
  std::uint32_t best_hits = 0xFFFFFFFFU;
  for (const bool along_x : {false, true}) {
    const double middle = along_x ? s.centre_m.z : s.centre_m.x;
    const double reach = 0.5 * (along_x ? s.half_m.z : s.half_m.x);
    const auto offset_of = [&](int lane) { return middle + reach * (2.0 * lane / (kLanes - 1) - 1); };
    std::array<std::uint32_t, kLanes> hits{};
    for (const Box& b : boxes) {
      if (b.empty() || static_cast<double>(b.hi.y) < low || static_cast<double>(b.lo.y) > high) continue;
      const double lo = static_cast<double>(along_x ? b.lo.z : b.lo.x) - half_width;
      const double hi = static_cast<double>(along_x ? b.hi.z : b.hi.x) + half_width;
      for (int lane = 0; lane < kLanes; ++lane)
        hits[static_cast<std::size_t>(lane)] += offset_of(lane) > lo && offset_of(lane) < hi ? 1 : 0;
    }
    const int lane = best_lane(hits);
    if (hits[static_cast<std::size_t>(lane)] >= best_hits) continue;
    best_hits = hits[static_cast<std::size_t>(lane)];
    best = {along_x, offset_of(lane)};
  }
  return best;
}

/// Along a street to its end, there a turn on the heel, and back.
CameraPath walk(const Stage& s, std::span<const Box> boxes) {
  const double eye_m = std::min(1.7, 0.6 * s.half_m.y);
  const Street street = street_of(s, boxes, eye_m);
  const double half = street.along_x ? s.half_m.x : s.half_m.z;
  const double middle = street.along_x ? s.centre_m.x : s.centre_m.z;
  const double y = s.floor_m + eye_m;
  // `along`: 1 is the side from which the walk begins (+x or +z).
  const auto place = [&](double along, double aside, double height) {
    const double a = middle + along;
    return street.along_x ? dvec3(a, height, street.offset_m + aside)
                          : dvec3(street.offset_m + aside, height, a);
  };
  const double begin = half + 2 * eye_m + 0.1 * half;
  const double end = -0.6 * half;
  const double ahead = 0.5 * half + 2 * eye_m;
  CameraPath path;
  path.interpolation = PathInterpolation::linear;
  constexpr double kYfov = 0.9;
  const auto add = [&](double share, double along, const dvec2& look) {
    path.keys.push_back(
        {s.length_s * share, place(along, 0, y), place(along + look.x, look.y, y + 0.15 * ahead), kYfov});
  };
  add(0, begin, {-ahead, 0});
  add(0.45, end, {-ahead, 0});
  add(0.475, end, {-0.7 * ahead, 0.7 * ahead});
  add(0.5, end, {0, ahead});
  add(0.525, end, {0.7 * ahead, 0.7 * ahead});
  add(0.55, end, {ahead, 0});
  add(1, 0.3 * half, {ahead, 0});
  return path;
}

/// From an overview down to just above the tops, in a bow over the middle, and out on another side.
CameraPath fly(const Stage& s) {
  CameraPath path;
  const auto add = [&](double share, const dvec3& eye, const dvec3& target) {
    path.keys.push_back(
        {s.length_s * share, at(s, eye.x, eye.y, eye.z), at(s, target.x, target.y, target.z), 0.7});
  };
  path.keys.push_back(overview(s, 0, {0.62, 0.5, 1.0}));
  add(0.2, {0.95, 1.5, 1.1}, {0, 0.4, 0});
  add(0.35, {0.4, 1.15, 0.5}, {-0.3, 0.4, -0.3});
  add(0.5, {-0.3, 1.1, -0.3}, {-0.9, 0.4, -0.1});
  add(0.65, {-0.9, 1.15, 0.3}, {-0.3, 0.3, 0.6});
  add(0.8, {-0.2, 1.2, 0.95}, {0.4, 0.3, 0.2});
  add(1, {1.4, 1.6, 0.7}, {0, 0.3, 0});
  return path;
}

/// Six places, held in turn.
CameraPath cuts(const Stage& s, std::span<const Box> boxes) {
  CameraPath path;
  path.interpolation = PathInterpolation::step;
  const CameraPath on_foot = walk(s, boxes);
  const auto held = [&](int i) { return s.length_s * i / 6; };
  const auto seen_from = [&](int i, CameraKey key) {
    key.time_s = held(i);
    path.keys.push_back(key);
  };
  path.keys.push_back(overview(s, held(0), {0.62, 0.5, 1.0}));
  seen_from(1, on_foot.keys.front());
  path.keys.push_back(overview(s, held(2), {-1.0, 0.8, -0.4}));
  path.keys.push_back({held(3), at(s, -1.2, 0.6, 1.2), at(s, 0.2, 0.3, -0.2), 0.7});
  seen_from(4, on_foot.keys[on_foot.keys.size() - 2]);
  path.keys.push_back(overview(s, held(5), {0.1, 1.0, 0.1}));
  return path;
}

void round_lengths(CameraPath& path, double radius_m) {
  const double grains = radius_m >= 1.0 ? 1e3 : radius_m >= 1e-3 ? 1e6 : 1e9;  // a metre
  for (CameraKey& key : path.keys) {
    for (dvec3* v : {&key.eye_m, &key.target_m}) {
      for (int i = 0; i < 3; ++i) (*v)[i] = std::round((*v)[i] * grains) / grains;
    }
  }
}

}  // namespace

std::span<const std::string_view> scripted_path_names() {
  return kNames;
}

std::optional<CameraPath> scripted_path(std::string_view name, std::span<const Box> object_bounds_m,
                                        double duration_s) {
  const Stage s = stage_of(object_bounds_m, duration_s);
  std::optional<CameraPath> path;
  if (name == "fixed") path = fixed(s);
  if (name == "orbit") path = orbit(s);
  if (name == "walk") path = walk(s, object_bounds_m);
  if (name == "fly") path = fly(s);
  if (name == "cuts") path = cuts(s, object_bounds_m);
  if (!path) return path;
  path->near_m = std::clamp(1e-3 * s.radius_m, 1e-4, 0.05);
  round_lengths(*path, s.radius_m);
  return path;
}

}  // namespace scenegen::render
