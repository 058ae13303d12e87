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
  std::vector<float> time_s;  ///< ascending
  std::vector<std::uint32_t> track;
  std::vector<std::int32_t> segment;
  struct KeyTrack {
    Property property = Property::translation;
    Interpolation interpolation = Interpolation::step;
    std::uint32_t key_count = 0;
    std::uint64_t first_key = 0;    ///< into key_s and changes_after
    std::uint64_t first_value = 0;  ///< into values
    std::uint64_t value_count = 0;
  };
  std::vector<KeyTrack> tracks;
  std::vector<float> key_s, values;
  std::vector<std::uint8_t> changes_after;  ///< segment_changes() of the segment after each key
  Lists targets;                            ///< moving frame slots, objects or materials, by property
  std::uint64_t all_tracks_cost = 0;

  [[nodiscard]] std::size_t track_count() const { return tracks.size(); }
  [[nodiscard]] Keys keys(std::size_t i) const {
    const KeyTrack& t = tracks[i];
    return {t.property, t.interpolation, std::span(key_s).subspan(t.first_key, t.key_count),
            std::span(values).subspan(t.first_value, t.value_count)};
  }
  [[nodiscard]] bool changes(std::size_t i, std::int32_t segment_of_i) const {
    return segment_of_i >= 0 &&
           changes_after[tracks[i].first_key + static_cast<std::uint64_t>(segment_of_i)] != 0;
  }
};

/// A frame that moves or hangs on one that does. Its slot is its place among these, parents first.
struct MovingFrame {
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  FrameId frame;
  std::uint32_t parent = kNone;  ///< slot; none: parent_world does not move
  bool has_parent = false;       ///< moving or not
  glm::mat4 parent_world{1.0F};  ///< before the first key
  Transform local;               ///< before the first key
  bool has_matrix = false;       ///< then `matrix` stands instead of `local`
  glm::mat4 matrix{1.0F};
};

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
  Lists children;                          ///< slots of the frames that hang on each moving frame
  Lists frame_objects;                     ///< places in moving_objects of what hangs on each moving frame
  std::vector<ObjectId> moving_objects;    ///< ascending
  std::vector<std::uint32_t> object_slot;  ///< place in moving_objects, or kNone; empty if none moves

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
