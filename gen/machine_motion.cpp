// Tracks of machines. No libm but sqrt (correctly rounded everywhere): the same bytes on every machine.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gen/machine_shapes.h"
#include "gen/machines.h"
#include "gen/primitives.h"
#include "timeline/track_table.h"

namespace scenegen::gen {
namespace {

constexpr double kSpeed = 5.0;        // m/s of lorries, as long as that gives at most kMostLaps
constexpr double kMostLaps = 12;      // in the whole timeline: bounds the keys
constexpr std::size_t kGlances = 64;  // how often a crane looks where the work is
constexpr double kTwoPi = 6.28318530717958647693;

/// Rotation about y that turns +x towards (direction.x, 0, direction.y); x y z w.
glm::dvec4 turned_to(const glm::dvec2& direction) {
  const double c = direction.x, s = -direction.y;
  if (c > 0) {
    const double w = std::sqrt(0.5 * (1.0 + c));
    return {0, s / (2.0 * w), 0, w};
  }
  const double y = std::sqrt(0.5 * (1.0 - c)) * (s < 0 ? -1.0 : 1.0);
  return {0, y, 0, s / (2.0 * y)};
}

/// Keys of one track; those that float32 cannot tell from the one before are left out.
class Keys {
 public:
  void add(double time_s, const glm::dvec3& value) {
    if (accept(time_s)) push(value.x), push(value.y), push(value.z);
  }
  /// The nearer of the two quaternions that mean the same, so that players turn the short way.
  void add_rotation(double time_s, glm::dvec4 q) {
    if (!times_s_.empty() && glm::dot(q, last_) < 0) q = -q;
    if (!accept(time_s)) return;
    last_ = q;
    push(q.x), push(q.y), push(q.z), push(q.w);
  }
  [[nodiscard]] bool empty() const { return times_s_.empty(); }
  void give(Scene& scene, timeline::TrackSharing& tracks, FrameId frame, Property property) const {
    scene.frame_tracks.push_back({frame, tracks.add(property, Interpolation::linear, times_s_, values_)});
  }

 private:
  bool accept(double time_s) {
    const auto t = static_cast<float>(time_s);
    if (!times_s_.empty() && !(t > times_s_.back())) return false;
    times_s_.push_back(t);
    return true;
  }
  void push(double v) { values_.push_back(static_cast<float>(v) + 0.0F); }

  std::vector<float> times_s_, values_;
  glm::dvec4 last_{0};
};

// ---- Lorries

/// A loop as a closed polyline with directions, author's frame; distances from its first point.
class Road {
 public:
  explicit Road(const LorryLoop& loop) {
    const double r = loop.radius_m;
    const glm::dvec2 lo = loop.lo_m, hi = loop.hi_m;
    // Counter-clockwise: the beginning of each side, its direction and length.
    const std::array<glm::dvec2, 4> starts{
        {{lo.x + r, lo.y}, {hi.x, lo.y + r}, {hi.x - r, hi.y}, {lo.x, hi.y - r}}};
    const std::array<glm::dvec2, 4> ways{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
    for (std::size_t i = 0; i < 4; ++i) {
      const glm::dvec2 way = ways[i], left(-way.y, way.x);
      const double length_m = (i % 2 == 0 ? hi.x - lo.x : hi.y - lo.y) - 2 * r;
      const glm::dvec2 end = starts[i] + way * length_m;
      points_.push_back({starts[i], way, 0});
      points_.push_back({end, way, 0});
      for (std::uint64_t k = 1; k < kArc; ++k) {
        const SineCosine turn = of_turn(k, 4 * kArc);
        points_.push_back({end + r * (way * turn.sine + left * (1.0 - turn.cosine)),
                           way * turn.cosine + left * turn.sine, 0});
      }
    }
    if (loop.clockwise) {
      std::reverse(points_.begin(), points_.end());
      for (Point& p : points_) p.way = -p.way;
      std::rotate(points_.begin(), points_.begin() + kArc - 1, points_.end());  // a side first
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
      points_[i].from_m = length_m_;
      length_m_ += glm::distance(points_[i].at_m, points_[(i + 1) % points_.size()].at_m);
    }
  }

  struct Point {
    glm::dvec2 at_m, way;
    double from_m;
  };
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  [[nodiscard]] double length_m() const { return length_m_; }
  /// Where a lorry may start: on a side, at or behind `from_m`.
  [[nodiscard]] Point start(double from_m) const {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Point& a = points_[i];
      const Point& b = points_[(i + 1) % points_.size()];
      const double end_m = i + 1 == points_.size() ? length_m_ : b.from_m;
      if (from_m >= end_m) continue;
      if (a.way != b.way) return i + 1 == points_.size() ? points_[0] : b_or_next(i + 1);
      const double along_m = std::max(0.0, from_m - a.from_m);
      return {a.at_m + a.way * along_m, a.way, a.from_m + along_m};
    }
    return points_[0];
  }

 private:
  static constexpr std::size_t kArc = 4;  // pieces of a quarter turn

  /// The next beginning of a side from point i on.
  [[nodiscard]] Point b_or_next(std::size_t i) const {
    for (; i < points_.size(); ++i) {
      if (points_[i].way == points_[(i + 1) % points_.size()].way) return points_[i];
    }
    return points_[0];
  }

  std::vector<Point> points_;
  double length_m_ = 0;
};

glm::dvec2 y_up(const glm::dvec2& v) {
  return {v.x, -v.y};
}

void drive_lorry(Scene& scene, timeline::TrackSharing& tracks, const Lorry& lorry, const Road& road,
                 const MachinePlan& plan) {
  const double end_s = static_cast<double>(scene.duration_s);
  const double scale = static_cast<double>(plan.scale);
  const double laps = std::clamp(std::round(kSpeed * scale * end_s / road.length_m()), 1.0, kMostLaps);
  const double total_m = laps * road.length_m();
  const Road::Point begin = road.start(lorry.start * road.length_m());
  Keys places, turns;
  const auto key = [&](double time_s, const Road::Point& p) {
    const glm::dvec2 at = y_up(p.at_m);
    places.add(time_s, {at.x, 0, at.y});
    turns.add_rotation(time_s, turned_to(y_up(p.way)));
  };
  key(0, begin);
  for (double lap = 0; lap <= laps; ++lap) {
    for (const Road::Point& p : road.points()) {
      const double driven_m = lap * road.length_m() + p.from_m - begin.from_m;
      if (driven_m > 0 && driven_m < total_m) key(driven_m / total_m * end_s, p);
    }
  }
  key(end_s, begin);
  places.give(scene, tracks, lorry.body, Property::translation);
  turns.give(scene, tracks, lorry.body, Property::rotation);

  // A key every third of a turn: quaternions 60 degrees apart.
  const double third_m = kTwoPi * static_cast<double>(kWheelRadius) * scale / 3.0;
  Keys wheels;
  for (std::uint64_t k = 0; static_cast<double>(k) * third_m <= total_m; ++k) {
    const SineCosine half = of_turn(k, 6);
    wheels.add_rotation(static_cast<double>(k) * third_m / total_m * end_s, {0, 0, -half.sine, half.cosine});
  }
  for (const FrameId axle : lorry.axles) wheels.give(scene, tracks, axle, Property::rotation);
}

// ---- Cranes

/// What appears round one crane, in equal pieces of time.
struct Work {
  std::uint64_t count = 0;
  glm::dvec2 sum_m{0};  ///< of places relative to the crane, world x and z
  float top_m = 0;      ///< highest point of anything in reach that appears
};

struct CraneWork {
  std::vector<Work> pieces = std::vector<Work>(kGlances);
};

/// Objects go to the crane that is nearest, if it reaches them.
std::vector<CraneWork> find_work(const Scene& scene, const Machines& machines, double last_s,
                                 const timeline::ObjectStarts& starts, unsigned threads) {
  std::vector<CraneWork> work(machines.cranes.size());
  const std::vector<Box> boxes = object_bounds(scene, threads);
  for (std::size_t o = 0; o < boxes.size(); ++o) {
    const std::optional<float> start_s = starts.of(ObjectId(o));
    if (!start_s || !std::isfinite(*start_s) || boxes[o].empty()) continue;
    const double share = last_s > 0 ? static_cast<double>(*start_s) / last_s : 0;
    const auto piece = std::min(kGlances - 1, static_cast<std::size_t>(share * kGlances));
    const glm::vec3 at_m = boxes[o].centre();
    std::size_t nearest = 0;
    double nearest_m = std::numeric_limits<double>::infinity();
    glm::dvec2 to_m(0);
    for (std::size_t c = 0; c < work.size(); ++c) {
      const glm::vec3& top = machines.cranes[c].top_m;
      const glm::dvec2 way(static_cast<double>(at_m.x - top.x), static_cast<double>(at_m.z - top.z));
      const double distance_m = glm::length(way);
      if (distance_m <= static_cast<double>(machines.plan.reach_m) + 1.0) {
        float& highest = work[c].pieces[piece].top_m;
        highest = std::max(highest, boxes[o].hi.y);
      }
      if (distance_m < nearest_m) nearest = c, nearest_m = distance_m, to_m = way;
    }
    if (nearest_m > static_cast<double>(machines.plan.reach_m)) continue;
    Work& of = work[nearest].pieces[piece];
    ++of.count;
    of.sum_m += to_m;
  }
  return work;
}

/// Pieces of time in which there is enough to do, and where; smoothed a little.
struct Glance {
  std::size_t piece;
  glm::dvec2 at_m;
};
std::vector<Glance> glances_of(const CraneWork& work) {
  std::uint64_t all = 0, busy = 0;
  for (const Work& w : work.pieces) all += w.count, busy += w.count > 0 ? 1 : 0;
  std::vector<Glance> raw;
  for (std::size_t i = 0; i < kGlances; ++i) {
    const Work& w = work.pieces[i];
    // Few objects, displaced in time, make no work to turn to.
    if (w.count == 0 || w.count * busy * 4 < all) continue;
    const glm::dvec2 mean = w.sum_m / static_cast<double>(w.count);
    if (glm::length(mean) > 1e-3) raw.push_back({i, mean});
  }
  std::vector<Glance> out = raw;
  for (std::size_t i = 1; i + 1 < raw.size(); ++i) {
    const glm::dvec2 smooth = 0.25 * (raw[i - 1].at_m + 2.0 * raw[i].at_m + raw[i + 1].at_m);
    if (glm::length(smooth) > 1e-3) out[i].at_m = smooth;
  }
  return out;
}

void drive_crane(Scene& scene, timeline::TrackSharing& tracks, const Crane& crane, const CraneWork& work,
                 double last_s, const MachinePlan& plan) {
  const double scale = static_cast<double>(plan.scale), reach_m = static_cast<double>(plan.reach_m);
  std::vector<float> built_m{2.9F * plan.scale};  // highest point when a piece of time begins; above lorries
  for (const Work& piece : work.pieces) built_m.push_back(std::max(built_m.back(), piece.top_m));
  const double trolley_y = static_cast<double>(crane.top_m.y + kCraneTrolleyY * plan.scale);
  std::vector<Glance> glances = glances_of(work);
  if (glances.empty()) glances.push_back({0, {0.6 * reach_m, 0.0}});  // nothing to do

  Keys slew, trolley, hook, cable;
  const auto key = [&](double time_s, const Glance& glance, double above_m) {
    const double distance_m = glm::length(glance.at_m);
    const double cable_m = std::max(0.5 * scale, trolley_y - above_m - 2.0 * scale);
    slew.add_rotation(time_s, turned_to(glance.at_m / distance_m));
    trolley.add(time_s, {std::clamp(distance_m, 2.4 * scale, reach_m - 0.9 * scale),
                         static_cast<double>(kCraneTrolleyY) * scale, 0});
    hook.add(time_s, {0, -cable_m, 0});
    cable.add(time_s, {1, cable_m, 1});
  };
  for (std::size_t i = 0; i < glances.size(); ++i) {
    // The hook stays above all that will stand when it arrives at its next place.
    const std::size_t next = i + 1 < glances.size() ? glances[i + 1].piece + 1 : kGlances;
    const auto above_m = static_cast<double>(built_m[next]);
    if (i == 0) key(0, glances[0], static_cast<double>(built_m[glances[0].piece + 1]));
    key((static_cast<double>(glances[i].piece) + 0.5) * last_s / kGlances, glances[i], above_m);
  }
  slew.give(scene, tracks, crane.slew, Property::rotation);
  trolley.give(scene, tracks, crane.trolley, Property::translation);
  hook.give(scene, tracks, crane.hook, Property::translation);
  cable.give(scene, tracks, crane.cable, Property::scale);
}

}  // namespace

void drive_machines(Scene& scene, const Machines& machines, unsigned threads) {
  if (machines.plan.empty()) return;
  const timeline::ObjectStarts starts(scene);
  double last_s = 0;
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const std::optional<float> start_s = starts.of(ObjectId(o));
    if (start_s && std::isfinite(*start_s)) last_s = std::max(last_s, static_cast<double>(*start_s));
  }
  const std::vector<CraneWork> work = find_work(scene, machines, last_s, starts, threads);
  timeline::TrackSharing tracks(scene);
  for (std::size_t i = 0; i < machines.cranes.size(); ++i)
    drive_crane(scene, tracks, machines.cranes[i], work[i], last_s, machines.plan);
  std::vector<Road> roads;
  for (const LorryLoop& loop : machines.plan.loops) roads.emplace_back(loop);
  for (const Lorry& lorry : machines.lorries)
    drive_lorry(scene, tracks, lorry, roads[lorry.loop], machines.plan);
}

}  // namespace scenegen::gen
