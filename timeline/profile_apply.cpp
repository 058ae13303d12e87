// Activities -> plans (profile_plan.h) -> tracks, frames, meshes and materials.
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "scene/limits.h"
#include "scene/random.h"
#include "timeline/profile_looks.h"
#include "timeline/profile_plan.h"
#include "timeline/profiles.h"
#include "timeline/track_table.h"

namespace scenegen::timeline {
namespace {

/// An object with its activities, in order of start.
struct Actor {
  ObjectId object;
  std::uint32_t timeline = 0;  ///< equal for objects with equal activities
  std::size_t first = 0, count = 0;
};

std::uint64_t pair_key(std::uint32_t a, std::uint32_t b) {
  return (std::uint64_t{a} << 32) | b;
}

std::string object_name(const Scene& scene, ObjectId object) {
  return "object '" + std::string(scene.objects.names[object.value]) + "'";
}

Result<void> check_activity(const Scene& scene, const Activity& activity) {
  if (activity.object.value >= scene.objects.size()) {
    return fail(
        ErrorKind::usage, "activities",
        "no object " + std::to_string(activity.object.value) + " of " + std::to_string(scene.objects.size()));
  }
  const bool timed = activity.start_s >= 0 && activity.start_s <= kLongest &&
                     activity.finish_s >= activity.start_s && activity.finish_s <= kLongest;
  const bool ignored = activity.profile == Profile::appear || activity.profile == Profile::neutral;
  const bool ok = ignored ? activity.start_s >= 0 && activity.start_s <= kLongest : timed;
  const glm::vec3& o = activity.offset_m;
  const bool placed = std::isfinite(o.x) && std::isfinite(o.y) && std::isfinite(o.z);
  if (ok && placed) return {};
  return fail(ErrorKind::usage, object_name(scene, activity.object),
              std::string(name(activity.profile)) + " from " + std::to_string(activity.start_s) + " to " +
                  std::to_string(activity.finish_s) +
                  " s: times must be 0 to 1e+38 s and not end before they start, offsets finite");
}

ActivitySpan span_of(const Activity& activity) {
  ActivitySpan span{activity.profile, static_cast<float>(activity.start_s),
                    static_cast<float>(activity.finish_s)};
  if (activity.profile == Profile::appear || activity.profile == Profile::neutral)
    span.finish_s = span.start_s;
  if (activity.profile == Profile::move) span.offset_m = activity.offset_m + 0.0F;  // -0 is 0
  return span;
}

std::uint64_t hash_of(std::span<const ActivitySpan> spans) {
  std::uint64_t hash = spans.size();
  const auto add = [&hash](float a, float b) {
    hash = mix64(hash ^ pair_key(std::bit_cast<std::uint32_t>(a), std::bit_cast<std::uint32_t>(b)));
  };
  for (const ActivitySpan& span : spans) {
    add(span.start_s, span.finish_s);
    hash ^= static_cast<std::uint64_t>(span.profile);
    if (span.profile != Profile::move) continue;
    add(span.offset_m.x, span.offset_m.y);
    add(span.offset_m.z, 0.0F);
  }
  return hash;
}

class ProfileApplier {
 public:
  ProfileApplier(Scene& scene, const ProfileOptions& options) : scene_(scene), options_(options) {}

  Result<ProfileResult> run(std::span<const Activity> activities) {
    if (auto r = gather(activities); !r) return forward_error(r);
    if (auto r = plan(); !r) return forward_error(r);
    if (auto r = check_frames(); !r) return forward_error(r);
    ProfileLooks looks(scene_, options_);
    for (const Actor& actor : actors_) {
      if (plans_[actor.timeline].looks.empty()) continue;
      if (auto r = looks.check(actor.object); !r) {
        r.error().where = object_name(scene_, actor.object);
        return forward_error(r);
      }
    }
    return apply(looks);  // nothing fails any more
  }

 private:
  /// actors_ by ascending object, spans_ in order of start, finish and mention.
  Result<void> gather(std::span<const Activity> activities) {
    std::vector<std::uint32_t> order(activities.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto before = [&](std::uint32_t i, std::uint32_t k) {
      const Activity &a = activities[i], &b = activities[k];
      if (a.object != b.object) return a.object < b.object;
      const ActivitySpan x = span_of(a), y = span_of(b);
      return x.start_s != y.start_s ? x.start_s < y.start_s : x.finish_s < y.finish_s;
    };
    for (const Activity& activity : activities) {
      if (auto r = check_activity(scene_, activity); !r) return r;
    }
    if (!std::is_sorted(order.begin(), order.end(), before))
      std::stable_sort(order.begin(), order.end(), before);
    spans_.reserve(order.size());
    for (const std::uint32_t i : order) {
      if (actors_.empty() || actors_.back().object != activities[i].object) {
        actors_.push_back({activities[i].object, 0, spans_.size(), 0});
      }
      ++actors_.back().count;
      spans_.push_back(span_of(activities[i]));
    }
    return {};
  }

  [[nodiscard]] std::span<const ActivitySpan> spans(const Actor& actor) const {
    return std::span(spans_).subspan(actor.first, actor.count);
  }

  /// One plan for all objects whose activities are equal.
  Result<void> plan() {
    std::unordered_multimap<std::uint64_t, std::uint32_t> by_hash;  // looked up, never walked
    const float drop_height_m = drop_height();
    for (Actor& actor : actors_) {
      const std::span<const ActivitySpan> own = spans(actor);
      const std::uint64_t hash = hash_of(own);
      const auto [begin, end] = by_hash.equal_range(hash);
      const auto known = std::find_if(begin, end, [&](const auto& entry) {
        return std::ranges::equal(own, spans(first_of_[entry.second]));
      });
      if (known != end) {
        actor.timeline = known->second;
        continue;
      }
      Result<ObjectPlan> made = plan_object(own, options_, drop_height_m);
      if (!made) {
        made.error().where = object_name(scene_, actor.object);
        return forward_error(made);
      }
      actor.timeline = static_cast<std::uint32_t>(plans_.size());
      by_hash.emplace(hash, actor.timeline);
      plans_.push_back(std::move(*made));
      first_of_.push_back(actor);
    }
    return {};
  }

  [[nodiscard]] float drop_height() const {
    if (options_.drop_height_m > 0) return static_cast<float>(options_.drop_height_m);
    const bool drops = std::any_of(spans_.begin(), spans_.end(),
                                   [](const ActivitySpan& s) { return s.profile == Profile::drop; });
    if (!drops) return 0;
    Box bounds;
    for (const Box& box : object_bounds(scene_)) bounds.add(box);
    return std::max(1.0F, bounds.empty() ? 0.0F : 0.1F * bounds.size().y);
  }

  // ---- Frames

  /// Turns offsets in the world into offsets in the frames that objects hang on.
  Result<void> check_frames() {
    const std::vector<glm::mat4> world_from_frame = rest_frame_matrices(scene_);
    frame_from_world_.assign(scene_.frames.size(), glm::dmat3(1.0));
    std::vector<std::uint32_t> depth(scene_.frames.size(), 1);
    std::vector<bool> usable(scene_.frames.size());
    for (std::size_t i = 0; i < scene_.frames.size(); ++i) {
      const FrameId parent = scene_.frames[i].parent;
      if (parent.valid()) depth[i] = depth[parent.value] + 1;
      frame_from_world_[i] = glm::inverse(glm::dmat3(world_from_frame[i]));
      usable[i] = true;
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) usable[i] = usable[i] && std::abs(frame_from_world_[i][c][r]) < 1e30;
      }
    }
    for (const Actor& actor : actors_) {
      const FrameId frame = scene_.objects.frame[actor.object.value];
      if (plans_[actor.timeline].way.empty() || !frame.valid()) continue;
      const bool fits = depth[frame.value] < limits::kMaxNodeDepth;
      if (fits && usable[frame.value]) continue;
      return fail(ErrorKind::bad_input, object_name(scene_, actor.object),
                  "cannot be moved: its frame '" + scene_.frames[frame.value].name + "' " +
                      (fits ? "is flat at rest (a scale of 0)"
                            : "is nested " + std::to_string(limits::kMaxNodeDepth) + " deep"));
    }
    return {};
  }

  FrameId frame_of(const Actor& actor) {
    const FrameId parent = scene_.objects.frame[actor.object.value];
    const auto [known, fresh] = frame_of_timeline_.try_emplace(pair_key(actor.timeline, parent.value));
    if (!fresh) return known->second;
    std::vector<float> times_s, values;
    for (const WayKey& key : plans_[actor.timeline].way) {
      times_s.push_back(key.time_s);
      const glm::dvec3 world(key.offset_m);
      const glm::vec3 local(parent.valid() ? frame_from_world_[parent.value] * world : world);
      for (int i = 0; i < 3; ++i) values.push_back(local[i] + 0.0F);
    }
    const TrackId track = tracks_->add(Property::translation, Interpolation::linear, times_s, values);
    const auto [shared, first] = frame_of_track_.try_emplace(pair_key(track.value, parent.value));
    if (first) {
      shared->second = FrameId(scene_.frames.size());
      Frame frame;
      frame.name = way_name(actor);
      frame.parent = parent;
      scene_.frames.push_back(std::move(frame));
      scene_.frame_tracks.push_back({shared->second, track});
    }
    known->second = shared->second;
    return shared->second;
  }

  /// "drop_12": what moves it first, and a number.
  std::string way_name(const Actor& actor) {
    const auto own = spans(actor);
    const bool drops = std::any_of(own.begin(), own.end(),
                                   [](const ActivitySpan& span) { return span.profile == Profile::drop; });
    return std::string(name(drops ? Profile::drop : Profile::move)) + "_" + std::to_string(frame_count_++);
  }

  // ---- Visibility, and all together

  TrackId visibility_of(const ObjectPlan& plan) {
    if (plan.there_at_start && plan.visibility_flip_s.empty()) return {};
    std::vector<float> times_s{0.0F}, values{plan.there_at_start ? 1.0F : 0.0F};
    for (const float flip_s : plan.visibility_flip_s) {
      times_s.push_back(flip_s);
      values.push_back(1.0F - values.back());
    }
    return tracks_->add(Property::visibility, Interpolation::step, times_s, values);
  }

  ProfileResult apply(ProfileLooks& looks) {
    TrackSharing tracks(scene_);
    tracks_ = &tracks;
    looks.begin(tracks);
    std::vector<TrackId> visibility;
    visibility.reserve(plans_.size());
    for (const ObjectPlan& plan : plans_) {
      visibility.push_back(plan.keeps_visibility ? TrackId() : visibility_of(plan));
    }
    for (const Actor& actor : actors_) {
      const ObjectPlan& plan = plans_[actor.timeline];
      const std::size_t object = actor.object.value;
      if (!plan.keeps_visibility) scene_.objects.visibility[object] = visibility[actor.timeline];
      if (!plan.looks.empty()) looks.give(actor.object, actor.timeline, plan.looks);
      if (!plan.way.empty()) scene_.objects.frame[object] = frame_of(actor);
    }
    for (const ActivitySpan& span : spans_) scene_.duration_s = std::max(scene_.duration_s, span.finish_s);
    return std::move(looks).result();
  }

  Scene& scene_;
  const ProfileOptions& options_;
  TrackSharing* tracks_ = nullptr;
  std::vector<ActivitySpan> spans_;
  std::vector<Actor> actors_;
  std::vector<ObjectPlan> plans_;  // by timeline
  std::vector<Actor> first_of_;    // by timeline: an object that has it
  std::vector<glm::dmat3> frame_from_world_;
  std::unordered_map<std::uint64_t, FrameId> frame_of_timeline_;  // (timeline, parent)
  std::unordered_map<std::uint64_t, FrameId> frame_of_track_;     // (translation track, parent)
  std::uint64_t frame_count_ = 0;
};

}  // namespace

Result<ProfileResult> apply_profiles(Scene& scene, std::span<const Activity> activities,
                                     const ProfileOptions& options) {
  return ProfileApplier(scene, options).run(activities);
}

}  // namespace scenegen::timeline
