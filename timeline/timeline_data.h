// What a Timeline holds: filled by compile(), walked by players. Everything here concerns only what changes:
// tracks that nobody names, and keys that change nothing, are gone.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scene/scene.h"
#include "timeline/keys.h"
#include "timeline/timeline.h"

namespace scenegen::timeline {

/// Lists of lists in one array: list i is items[first[i]] … items[first[i + 1] - 1].
struct Lists {
  std::vector<std::uint64_t> first{0};
  std::vector<std::uint32_t> items;

  [[nodiscard]] std::size_t size() const { return first.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t i) const {
    return std::span(items).subspan(first[i], first[i + 1] - first[i]);
  }
};

/// Visibility: a track is a bit at the start and the times at which it flips.
struct VisibilityEvents {
  std::vector<float> time_s;  ///< ascending
  std::vector<std::uint32_t> track;
  std::vector<std::uint64_t> first_flip{0};  ///< flips of track v: flip_s[first_flip[v]] … [v + 1]
  std::vector<float> flip_s;
  std::vector<std::uint8_t> on_at_start;  ///< by track
  Lists objects;                          ///< of each track, ascending
  std::uint64_t all_tracks_cost = 0;  ///< events that a walk may pass before evaluating all tracks is cheaper

  [[nodiscard]] std::size_t track_count() const { return on_at_start.size(); }
};

/// All other tracks. At event i track[i] enters segment[i] (and was in segment[i] - 1 before).
struct KeyEvents {
  struct KeyTrack {
    Property property = Property::translation;
    Interpolation interpolation = Interpolation::step;
    std::uint8_t components = 0;      ///< width(property)
    std::uint8_t floats_per_key = 0;  ///< of values
    std::uint32_t key_count = 0;
    std::uint32_t target_count = 0;
    std::uint32_t target = 0;  ///< the only one, or the first in `targets`; see target_list()
    std::uint64_t floats = 0;  ///< into `pool`: times, then values
  };
  enum Changes : std::uint8_t { before = 1, after = 2 };

  std::vector<float> time_s;  ///< ascending
  std::vector<std::uint32_t> track;
  std::vector<std::int32_t> segment;
  std::vector<std::uint8_t> changes;  ///< whether the segments before and after the event change with time
  std::vector<KeyTrack> tracks;
  std::vector<float> pool;
  std::vector<std::uint32_t> targets;  ///< moving frame slots, objects or materials, by property
  std::uint64_t all_tracks_cost = 0;

  [[nodiscard]] std::size_t track_count() const { return tracks.size(); }
  [[nodiscard]] Keys keys(const KeyTrack& t) const {
    const float* times = pool.data() + t.floats;
    const float* values = times + t.key_count;
    return {t.property,
            t.interpolation,
            t.components,
            {times, t.key_count},
            {values, std::size_t{t.key_count} * t.floats_per_key}};
  }
  [[nodiscard]] std::span<const std::uint32_t> target_list(const KeyTrack& t) const {
    if (t.target_count == 1) return {&t.target, 1};
    return std::span(targets).subspan(t.target, t.target_count);
  }
};

/// A frame that moves or hangs on one that does. Its slot is its place among these, parents first.
struct MovingFrame {
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  FrameId frame;
  std::uint32_t parent = kNone;  ///< slot
  FrameId still_parent;          ///< its parent if that never moves; neither: the world
  std::uint32_t matrix = kNone;  ///< into TimelineData::matrices: stands instead of the transform
  std::uint32_t first_child = 0, end_child = 0;    ///< into TimelineData::children
  std::uint32_t first_object = 0, end_object = 0;  ///< into TimelineData::frame_objects
};
constexpr std::uint32_t kNone = MovingFrame::kNone;

struct TimelineData {
  double duration_s = 0;

  // Objects
  std::vector<Transform> frame_from_object;
  std::vector<FrameId> object_frame;
  std::vector<MeshId> object_mesh;  ///< before the first key
  std::vector<ObjectClass> object_class;
  ClassCounts classes;
  std::vector<std::uint64_t> visible_at_start;  ///< a bit an object
  std::uint64_t visible_count_at_start = 0;

  // Motion
  std::vector<glm::mat4> world_from_frame;  ///< of every frame, before the first key
  std::vector<std::uint32_t> frame_slot;    ///< into moving_frames, or kNone
  std::vector<MovingFrame> moving_frames;
  std::vector<Transform> moving_local;  ///< of each moving frame, before the first key
  std::vector<glm::mat4> matrices;
  std::vector<std::uint32_t> children;     ///< slots, ascending by parent
  std::vector<ObjectId> frame_objects;     ///< all moving objects, by frame
  std::vector<ObjectId> moving_objects;    ///< the same, ascending
  std::vector<std::uint32_t> object_slot;  ///< place in frame_objects, or kNone; empty if none moves

  // Materials and cameras
  std::vector<glm::vec4> base_color;  ///< before the first key
  std::vector<glm::vec3> emissive;
  struct CameraPlace {
    FrameId frame;
    Transform frame_from_camera;
  };
  std::vector<CameraPlace> cameras;

  VisibilityEvents visibility;
  KeyEvents keys;
  bool meshes_change = false;

  std::vector<float> event_times_s, visibility_times_s;
  std::vector<std::uint64_t> visibility_changes;
};

}  // namespace scenegen::timeline
