// Upkeep of a scene's table of tracks.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "scene/scene.h"

namespace scenegen::timeline {

constexpr double kLongest = 1e38;  // s; float32 ends at 3.4e38

/// Makes every object always visible: forgets all visibility tracks, drops them from the table with the keys
/// that no other track uses, and renumbers what names the tracks that stay.
void remove_visibility_tracks(Scene& scene);

/// Drops tracks that nothing names with the keys that no other track uses, and renumbers what names the
/// others.
void remove_unused_tracks(Scene& scene);

/// The tracks of a scene as they were read, for gltf::patch(), which tells by their numbers what the file has
/// already. Steps that drop and renumber tracks may come between the two calls; what stood in the lists of
/// frame, mesh and material tracks must still stand first in them.
class TracksAsRead {
 public:
  explicit TracksAsRead(const Scene& scene);
  /// Puts them in front of the table again; those that were added since follow, those that the objects,
  /// frames and materials had since then keep their numbers as read.
  void restore(Scene& scene) const;

 private:
  std::vector<Track> tracks_;
  std::vector<float> times_s_, values_;
  std::vector<FrameTrack> frame_tracks_;
  std::vector<ObjectMeshTrack> object_mesh_tracks_;
  std::vector<MaterialTrack> material_tracks_;
};

/// Adds tracks to a scene, each content once. Visibility tracks that stood in the scene are used too.
class TrackSharing {
 public:
  explicit TrackSharing(Scene& scene);
  /// As Scene::add_track, or a track of equal content.
  TrackId add(Property property, Interpolation interpolation, std::span<const float> times_s,
              std::span<const float> values);

 private:
  void remember(TrackId id);

  Scene& scene_;
  std::unordered_multimap<std::uint64_t, TrackId> by_hash_;  // looked up, never walked
};

/// When the object is first visible: none if never; 0 if it is visible before its first key (also without a
/// visibility track).
[[nodiscard]] std::optional<float> first_appearance_s(const Scene& scene, ObjectId object);

/// When something first happens to objects, as profiles (timeline/profiles.h) write it: what is hidden at
/// first starts when it appears, what is there starts when its look changes or it goes away, whichever is
/// first.
class ObjectStarts {
 public:
  explicit ObjectStarts(const Scene& scene);
  /// None: it has neither a visibility track nor a look that changes. Infinity: it never appears.
  [[nodiscard]] std::optional<float> of(ObjectId object) const;

 private:
  struct Visibility {
    bool there_at_start = true;
    float change_s = 0;  ///< infinity: never
  };
  const Scene& scene_;
  std::vector<Visibility> visibility_;  // by track
  std::vector<float> look_change_s_;    // by object; infinity: never; empty when no look changes
};

}  // namespace scenegen::timeline
