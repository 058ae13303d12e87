// Scene -> TimelineData: inverts "object names track" into "track fans out to objects" and sorts all keys
// that change something into one index by time.
#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <iterator>
#include <numeric>

#include "timeline/event_sort.h"
#include "timeline/timeline.h"
#include "timeline/timeline_data.h"

namespace scenegen::timeline {

namespace {

struct Pair {
  std::uint32_t list, item;
};

/// Counting sort of pairs into lists; keeps the order within a list.
template <class Pairs>
Lists to_lists(std::size_t list_count, const Pairs& for_each_pair) {
  Lists out;
  out.first.assign(list_count + 1, 0);
  for_each_pair([&](std::uint32_t list, std::uint32_t) { ++out.first[list + 1]; });
  std::partial_sum(out.first.begin(), out.first.end(), out.first.begin());
  out.items.resize(out.first.back());
  for_each_pair([&](std::uint32_t list, std::uint32_t item) { out.items[out.first[list]++] = item; });
  std::copy_backward(out.first.begin(), out.first.end() - 1, out.first.end());
  out.first[0] = 0;
  return out;
}

auto pairs_of(const std::vector<Pair>& pairs) {
  return [&pairs](const auto& visit) {
    for (const Pair& p : pairs) visit(p.list, p.item);
  };
}

class Compiler {
 public:
  explicit Compiler(const Scene& scene) : scene_(scene), out_(std::make_unique<TimelineData>()) {}

  std::unique_ptr<const TimelineData> run() {
    out_->duration_s = scene_.duration_s;
    copy_rest_state();
    compile_visibility();
    apply_first_keys();
    find_moving_frames();
    collect_key_tracks();
    sort_key_events();
    place_moving_objects();
    classify();
    list_times();
    return std::move(out_);
  }

 private:
  Keys keys(TrackId id) const {
    const Track& track = scene_.tracks[id.value];
    return {track.property, track.interpolation, width(track.property), scene_.times_s(id),
            scene_.values(id)};
  }

  void copy_rest_state() {
    out_->frame_from_object = scene_.objects.frame_from_object;
    out_->object_frame = scene_.objects.frame;
    out_->object_mesh = scene_.objects.mesh;
    for (const Material& m : scene_.materials) {
      out_->base_color.push_back(m.base_color);
      out_->emissive.push_back(m.emissive);
    }
    for (const Camera& c : scene_.cameras) out_->cameras.push_back({c.frame, c.frame_from_camera});
    for (const Frame& f : scene_.frames) local_.push_back(f.local);
  }

  // ---- Visibility

  void compile_visibility() {
    const auto& track_of = scene_.objects.visibility;
    std::vector<std::uint8_t> used(scene_.tracks.size(), 0);
    for (const TrackId id : track_of) {
      if (id.valid()) used[id.value] = 1;
    }
    VisibilityEvents& out = out_->visibility;
    compact_.assign(scene_.tracks.size(), kNone);
    starts_on_.assign(scene_.tracks.size(), 1);
    std::vector<TimedItem> events;
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i] != 0) add_visibility_track(i, events);
    }
    sort_by_time(events);
    out.time_s.reserve(events.size());
    out.track.reserve(events.size());
    for (const TimedItem& e : events) {
      out.time_s.push_back(e.time_s);
      out.track.push_back(e.item);
    }

    out.objects = to_lists(out.track_count(), [&](const auto& visit) {
      for (std::size_t o = 0; o < track_of.size(); ++o) {
        const std::uint32_t list = track_of[o].valid() ? compact_[track_of[o].value] : kNone;
        if (list != kNone) visit(list, static_cast<std::uint32_t>(o));
      }
    });
    out_->visible_at_start.assign((track_of.size() + 63) / 64, 0);
    for (std::size_t o = 0; o < track_of.size(); ++o) {
      const bool on = !track_of[o].valid() || starts_on_[track_of[o].value] != 0;
      out_->visible_at_start[o / 64] |= static_cast<std::uint64_t>(on) << (o % 64);
      out_->visible_count_at_start += static_cast<std::uint64_t>(on);
    }
  }

  void add_visibility_track(std::size_t i, std::vector<TimedItem>& events) {
    VisibilityEvents& out = out_->visibility;
    const auto times = scene_.times_s(TrackId(i));
    const auto values = scene_.values(TrackId(i));
    starts_on_[i] = static_cast<std::uint8_t>(values[0] != 0.0F);
    const auto track = static_cast<std::uint32_t>(out.track_count());
    const std::size_t before = events.size();
    for (std::size_t k = 1; k < times.size(); ++k) {
      if ((values[k] != 0.0F) == (values[k - 1] != 0.0F)) continue;
      events.push_back({times[k], track});
      out.flip_s.push_back(times[k]);
    }
    if (events.size() == before) return;  // never changes
    compact_[i] = track;
    out.on_at_start.push_back(starts_on_[i]);
    out.first_flip.push_back(out.flip_s.size());
    out.all_tracks_cost += 1 + std::bit_width(events.size() - before);
  }

  // ---- Other tracks

  /// "Before the first key the first value holds."
  void apply_first_keys() {
    for (const FrameTrack& f : scene_.frame_tracks) {
      const std::span<const float> v = keys(f.track).value(0);
      Transform& local = local_[f.frame.value];
      switch (scene_.tracks[f.track.value].property) {
        case Property::translation:
          local.translation_m = {v[0], v[1], v[2]};
          break;
        case Property::rotation:
          local.rotation = glm::quat(v[3], v[0], v[1], v[2]);
          break;
        default:
          local.scale = {v[0], v[1], v[2]};
      }
    }
    for (const ObjectMeshTrack& o : scene_.object_mesh_tracks) {
      out_->object_mesh[o.object.value] = MeshId(static_cast<std::uint64_t>(keys(o.track).value(0)[0]));
    }
    for (const MaterialTrack& m : scene_.material_tracks) {
      const std::span<const float> v = keys(m.track).value(0);
      if (scene_.tracks[m.track.value].property == Property::base_color) {
        out_->base_color[m.material.value] = {v[0], v[1], v[2], v[3]};
      } else {
        out_->emissive[m.material.value] = {v[0], v[1], v[2]};
      }
    }
  }

  void find_moving_frames() {
    const std::size_t count = scene_.frames.size();
    std::vector<std::uint8_t> driven(count, 0);
    for (const FrameTrack& f : scene_.frame_tracks) {
      if (!scene_.frames[f.frame.value].has_matrix && track_changes(f.track)) driven[f.frame.value] = 1;
    }
    out_->frame_slot.assign(count, kNone);
    out_->world_from_frame.reserve(count);
    std::vector<Pair> children;
    for (std::size_t i = 0; i < count; ++i) {
      const Frame& f = scene_.frames[i];
      const bool has_parent = f.parent.valid();
      const glm::mat4 local = f.has_matrix ? f.matrix : local_[i].matrix();
      out_->world_from_frame.push_back(has_parent ? out_->world_from_frame[f.parent.value] * local : local);
      const std::uint32_t parent_slot = has_parent ? out_->frame_slot[f.parent.value] : kNone;
      if (driven[i] == 0 && parent_slot == kNone) continue;
      const auto slot = static_cast<std::uint32_t>(out_->moving_frames.size());
      out_->frame_slot[i] = slot;
      MovingFrame moving;
      moving.frame = FrameId(i);
      moving.parent = parent_slot;
      if (has_parent && parent_slot == kNone) moving.still_parent = f.parent;
      if (f.has_matrix) {
        moving.matrix = static_cast<std::uint32_t>(out_->matrices.size());
        out_->matrices.push_back(f.matrix);
      }
      out_->moving_frames.push_back(moving);
      out_->moving_local.push_back(local_[i]);
      if (parent_slot != kNone) children.push_back({parent_slot, slot});
    }
    Lists lists = to_lists(out_->moving_frames.size(), pairs_of(children));
    for (std::size_t i = 0; i < lists.size(); ++i) {
      out_->moving_frames[i].first_child = static_cast<std::uint32_t>(lists.first[i]);
      out_->moving_frames[i].end_child = static_cast<std::uint32_t>(lists.first[i + 1]);
    }
    out_->children = std::move(lists.items);
  }

  bool track_changes(TrackId id) const {
    const Keys k = keys(id);
    for (std::size_t i = 0; i + 1 < k.times_s.size(); ++i) {
      if (is_event(k, i + 1)) return true;
    }
    return false;
  }

  /// Whether anything is different after key i from what it was before.
  static bool is_event(const Keys& k, std::size_t i) {
    const auto segment = static_cast<std::int32_t>(i);
    if (segment_changes(k, segment) || segment_changes(k, segment - 1)) return true;
    if (i == 0) return false;
    const auto now = k.value(i);
    return std::memcmp(now.data(), k.value(i - 1).data(), now.size_bytes()) != 0;
  }

  void collect_key_tracks() {
    std::fill(compact_.begin(), compact_.end(), kNone);
    for (const FrameTrack& f : scene_.frame_tracks) {
      const std::uint32_t slot = out_->frame_slot[f.frame.value];
      if (slot != kNone && !scene_.frames[f.frame.value].has_matrix) add_key_track(f.track, slot);
    }
    for (const ObjectMeshTrack& o : scene_.object_mesh_tracks) {
      out_->meshes_change |= add_key_track(o.track, o.object.value);
    }
    for (const MaterialTrack& m : scene_.material_tracks) add_key_track(m.track, m.material.value);
    place_targets();
  }

  void place_targets() {
    KeyEvents& out = out_->keys;
    Lists lists = to_lists(out.track_count(), pairs_of(targets_));
    for (std::size_t i = 0; i < lists.size(); ++i) {
      const auto list = lists[i];
      out.tracks[i].target_count = static_cast<std::uint32_t>(list.size());
      out.tracks[i].target = list.size() == 1 ? list[0] : static_cast<std::uint32_t>(lists.first[i]);
    }
    out.targets = std::move(lists.items);
  }

  /// False if the track never changes (and is left out).
  bool add_key_track(TrackId id, std::uint32_t target) {
    if (compact_[id.value] == kNone) {
      if (!track_changes(id)) return false;
      KeyEvents& out = out_->keys;
      const Keys k = keys(id);
      const auto track = static_cast<std::uint32_t>(out.track_count());
      compact_[id.value] = track;
      KeyEvents::KeyTrack compact{k.property, k.interpolation};
      compact.components = static_cast<std::uint8_t>(k.components);
      compact.floats_per_key = static_cast<std::uint8_t>(k.values.size() / k.times_s.size());
      compact.key_count = static_cast<std::uint32_t>(k.times_s.size());
      compact.floats = out.pool.size();
      out.tracks.push_back(compact);
      out.pool.insert(out.pool.end(), k.times_s.begin(), k.times_s.end());
      out.pool.insert(out.pool.end(), k.values.begin(), k.values.end());
      out.all_tracks_cost += 1 + std::bit_width(k.times_s.size());
      for (std::size_t i = 0; i < k.times_s.size(); ++i) {
        if (!is_event(k, i)) continue;
        const auto segment = static_cast<std::int32_t>(i);
        const int changes = (segment_changes(k, segment - 1) ? KeyEvents::before : 0) |
                            (segment_changes(k, segment) ? KeyEvents::after : 0);
        key_events_.push_back({k.times_s[i], static_cast<std::uint32_t>(entered_.size())});
        entered_.push_back({track, segment, static_cast<std::uint8_t>(changes)});
      }
    }
    targets_.push_back({compact_[id.value], target});
    return true;
  }

  void sort_key_events() {
    sort_by_time(key_events_);
    KeyEvents& out = out_->keys;
    for (const TimedItem& e : key_events_) {
      out.time_s.push_back(e.time_s);
      out.track.push_back(entered_[e.item].track);
      out.segment.push_back(entered_[e.item].segment);
      out.changes.push_back(entered_[e.item].changes);
    }
  }

  void place_moving_objects() {
    if (out_->moving_frames.empty()) return;
    const auto& frame_of = out_->object_frame;
    const Lists lists = to_lists(out_->moving_frames.size(), [&](const auto& visit) {
      for (std::size_t o = 0; o < frame_of.size(); ++o) {
        const std::uint32_t slot = frame_of[o].valid() ? out_->frame_slot[frame_of[o].value] : kNone;
        if (slot != kNone) visit(slot, static_cast<std::uint32_t>(o));
      }
    });
    for (std::size_t i = 0; i < lists.size(); ++i) {
      out_->moving_frames[i].first_object = static_cast<std::uint32_t>(lists.first[i]);
      out_->moving_frames[i].end_object = static_cast<std::uint32_t>(lists.first[i + 1]);
    }
    out_->object_slot.assign(frame_of.size(), kNone);
    out_->frame_objects.reserve(lists.items.size());
    for (const std::uint32_t o : lists.items) {
      out_->object_slot[o] = static_cast<std::uint32_t>(out_->frame_objects.size());
      out_->frame_objects.emplace_back(o);
    }
    out_->moving_objects = out_->frame_objects;
    std::sort(out_->moving_objects.begin(), out_->moving_objects.end());
  }

  // ---- What it amounts to

  void classify() {
    const std::size_t count = scene_.objects.size();
    std::vector<std::uint8_t> material_changes(scene_.materials.size(), 0);
    for (const MaterialTrack& m : scene_.material_tracks) {
      if (compact_[m.track.value] != kNone) material_changes[m.material.value] = 1;
    }
    std::vector<std::uint8_t> mesh_changes(scene_.meshes.size(), 0);
    for (std::size_t i = 0; i < mesh_changes.size(); ++i) {
      for (const Primitive& p : scene_.meshes[i].primitives) {
        if (p.material.valid() && material_changes[p.material.value] != 0) mesh_changes[i] = 1;
      }
    }
    out_->object_class.assign(count, ObjectClass::constant);
    for (std::size_t o = 0; o < count; ++o) {
      const bool shown_always = ((out_->visible_at_start[o / 64] >> (o % 64)) & 1) != 0;
      if (!shown_always || mesh_changes[out_->object_mesh[o].value] != 0) {
        out_->object_class[o] = ObjectClass::pseudo_dynamic;
      }
    }
    for (const std::uint32_t o : out_->visibility.objects.items) {
      out_->object_class[o] = ObjectClass::pseudo_dynamic;
    }
    for (const ObjectMeshTrack& o : scene_.object_mesh_tracks) {
      if (compact_[o.track.value] != kNone) out_->object_class[o.object.value] = ObjectClass::pseudo_dynamic;
    }
    for (const ObjectId o : out_->moving_objects) out_->object_class[o.value] = ObjectClass::dynamic;
    for (const ObjectClass c : out_->object_class) {
      ++(c == ObjectClass::constant         ? out_->classes.constant
         : c == ObjectClass::pseudo_dynamic ? out_->classes.pseudo_dynamic
                                            : out_->classes.dynamic);
    }
  }

  void list_times() {
    const VisibilityEvents& v = out_->visibility;
    for (std::size_t i = 0; i < v.time_s.size(); ++i) {
      if (out_->visibility_times_s.empty() || out_->visibility_times_s.back() != v.time_s[i]) {
        out_->visibility_times_s.push_back(v.time_s[i]);
        out_->visibility_changes.push_back(0);
      }
      out_->visibility_changes.back() += v.objects[v.track[i]].size();
    }
    std::merge(out_->visibility_times_s.begin(), out_->visibility_times_s.end(), out_->keys.time_s.begin(),
               out_->keys.time_s.end(), std::back_inserter(out_->event_times_s));
    out_->event_times_s.erase(std::unique(out_->event_times_s.begin(), out_->event_times_s.end()),
                              out_->event_times_s.end());
  }

  struct Entered {
    std::uint32_t track;
    std::int32_t segment;
    std::uint8_t changes;
  };

  const Scene& scene_;
  std::unique_ptr<TimelineData> out_;
  std::vector<std::uint32_t> compact_;   // scene track -> number in VisibilityEvents or KeyEvents
  std::vector<std::uint8_t> starts_on_;  // by scene track
  std::vector<Transform> local_;         // of frames, before the first key
  std::vector<Pair> targets_;            // (key track, target)
  std::vector<TimedItem> key_events_;    // item: index into entered_
  std::vector<Entered> entered_;
};

}  // namespace

std::shared_ptr<const Timeline> compile(const Scene& scene) {
  return std::make_shared<const Timeline>(Compiler(scene).run());
}

}  // namespace scenegen::timeline
