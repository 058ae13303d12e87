#include "timeline/track_table.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <limits>

#include "scene/random.h"

namespace scenegen::timeline {
namespace {

/// Keeps of a pool only given pieces of it, in their order; pieces may overlap (tracks may share keys).
class PoolCompaction {
 public:
  void keep(std::uint64_t begin, std::uint64_t count) {
    if (count > 0) pieces_.push_back({begin, begin + count, 0});
  }
  void compact(std::vector<float>& pool) {
    std::sort(pieces_.begin(), pieces_.end(),
              [](const Piece& a, const Piece& b) { return a.begin < b.begin; });
    std::vector<Piece> merged;
    for (const Piece& piece : pieces_) {
      if (!merged.empty() && piece.begin <= merged.back().end) {
        merged.back().end = std::max(merged.back().end, piece.end);
      } else {
        merged.push_back(piece);
      }
    }
    std::uint64_t size = 0;
    for (Piece& piece : merged) {
      piece.moved_to = size;
      std::copy(pool.begin() + static_cast<std::ptrdiff_t>(piece.begin),
                pool.begin() + static_cast<std::ptrdiff_t>(piece.end),
                pool.begin() + static_cast<std::ptrdiff_t>(size));
      size += piece.end - piece.begin;
    }
    pool.resize(size);
    pieces_ = std::move(merged);
  }
  /// Where the entry at `old` of a kept piece is after compact().
  [[nodiscard]] std::uint64_t moved(std::uint64_t old) const {
    const auto after =
        std::upper_bound(pieces_.begin(), pieces_.end(), old,
                         [](std::uint64_t at, const Piece& piece) { return at < piece.begin; });
    return after == pieces_.begin() ? 0 : std::prev(after)->moved_to + (old - std::prev(after)->begin);
  }

 private:
  struct Piece {
    std::uint64_t begin, end, moved_to;
  };
  std::vector<Piece> pieces_;
};

/// Keeps the tracks that `stays` says, in their order. Visibility that names another one becomes none.
void keep_tracks(Scene& scene, const std::vector<bool>& stays) {
  std::vector<TrackId> renumbered(scene.tracks.size());
  std::vector<Track> kept;
  PoolCompaction times;
  PoolCompaction values;
  for (std::size_t i = 0; i < scene.tracks.size(); ++i) {
    if (!stays[i]) continue;
    const Track& track = scene.tracks[i];
    times.keep(track.first_time, track.key_count);
    values.keep(track.first_value, scene.values(TrackId(i)).size());
    renumbered[i] = TrackId(kept.size());
    kept.push_back(track);
  }
  if (kept.size() == scene.tracks.size()) return;
  times.compact(scene.track_times_s);
  values.compact(scene.track_values);
  for (Track& track : kept) {
    track.first_time = times.moved(track.first_time);
    track.first_value = values.moved(track.first_value);
  }
  scene.tracks = std::move(kept);
  for (TrackId& id : scene.objects.visibility) {
    if (id.valid()) id = renumbered[id.value];
  }
  for (FrameTrack& use : scene.frame_tracks) use.track = renumbered[use.track.value];
  for (ObjectMeshTrack& use : scene.object_mesh_tracks) use.track = renumbered[use.track.value];
  for (MaterialTrack& use : scene.material_tracks) use.track = renumbered[use.track.value];
}

std::uint64_t hash_of(const Track& track, std::span<const float> times_s, std::span<const float> values) {
  std::uint64_t hash = mix64((std::uint64_t{static_cast<std::uint8_t>(track.property)} << 8) |
                             static_cast<std::uint8_t>(track.interpolation));
  for (const float time_s : times_s) hash = mix64(hash ^ std::bit_cast<std::uint32_t>(time_s));
  for (const float value : values) hash = mix64(hash ^ std::bit_cast<std::uint32_t>(value));
  return hash;
}

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

constexpr float kNoChange = std::numeric_limits<float>::infinity();

/// The first key whose value differs from the one before.
float first_change_s(const Scene& scene, TrackId id) {
  const std::span<const float> times_s = scene.times_s(id), values = scene.values(id);
  const std::size_t floats = values.size() / times_s.size();
  for (std::size_t k = 1; k < times_s.size(); ++k) {
    if (!same_bits(values.subspan(k * floats, floats), values.subspan((k - 1) * floats, floats)))
      return times_s[k];
  }
  return kNoChange;
}

}  // namespace

ObjectStarts::ObjectStarts(const Scene& scene) : scene_(scene), visibility_(scene.tracks.size()) {
  for (std::size_t i = 0; i < visibility_.size(); ++i) {
    if (scene.tracks[i].property != Property::visibility) continue;
    const TrackId id(i);
    visibility_[i] = {scene.values(id).front() != 0.0F, first_change_s(scene, id)};
  }
  if (scene.object_mesh_tracks.empty() && scene.material_tracks.empty()) return;
  look_change_s_.assign(scene.objects.size(), kNoChange);
  if (!scene.material_tracks.empty()) {
    std::vector<float> of_material(scene.materials.size(), kNoChange),
        of_mesh(scene.meshes.size(), kNoChange);
    for (const MaterialTrack& use : scene.material_tracks) {
      float& change_s = of_material[use.material.value];
      change_s = std::min(change_s, first_change_s(scene, use.track));
    }
    for (std::size_t i = 0; i < of_mesh.size(); ++i) {
      for (const Primitive& p : scene.meshes[i].primitives) {
        if (p.material.valid()) of_mesh[i] = std::min(of_mesh[i], of_material[p.material.value]);
      }
    }
    for (std::size_t i = 0; i < look_change_s_.size(); ++i)
      look_change_s_[i] = of_mesh[scene.objects.mesh[i].value];
  }
  for (const ObjectMeshTrack& use : scene.object_mesh_tracks) {
    float& change_s = look_change_s_[use.object.value];
    change_s = std::min(change_s, first_change_s(scene, use.track));
  }
}

std::optional<float> ObjectStarts::of(ObjectId object) const {
  const TrackId track = scene_.objects.visibility[object.value];
  const float look_s = look_change_s_.empty() ? kNoChange : look_change_s_[object.value];
  if (!track.valid()) return look_s == kNoChange ? std::nullopt : std::optional(look_s);
  const Visibility& visibility = visibility_[track.value];
  return visibility.there_at_start ? std::min(look_s, visibility.change_s) : visibility.change_s;
}

void remove_visibility_tracks(Scene& scene) {
  std::fill(scene.objects.visibility.begin(), scene.objects.visibility.end(), TrackId());
  std::vector<bool> stays(scene.tracks.size());
  for (std::size_t i = 0; i < stays.size(); ++i) stays[i] = scene.tracks[i].property != Property::visibility;
  keep_tracks(scene, stays);
}

void remove_unused_tracks(Scene& scene) {
  std::vector<bool> stays(scene.tracks.size());
  for (const TrackId id : scene.objects.visibility) {
    if (id.valid()) stays[id.value] = true;
  }
  for (const FrameTrack& use : scene.frame_tracks) stays[use.track.value] = true;
  for (const ObjectMeshTrack& use : scene.object_mesh_tracks) stays[use.track.value] = true;
  for (const MaterialTrack& use : scene.material_tracks) stays[use.track.value] = true;
  keep_tracks(scene, stays);
}

TracksAsRead::TracksAsRead(const Scene& scene)
    : tracks_(scene.tracks),
      times_s_(scene.track_times_s),
      values_(scene.track_values),
      frame_tracks_(scene.frame_tracks),
      object_mesh_tracks_(scene.object_mesh_tracks),
      material_tracks_(scene.material_tracks) {}

void TracksAsRead::restore(Scene& scene) const {
  if (tracks_.empty()) return;
  const std::size_t shift = tracks_.size();
  for (Track& track : scene.tracks) {
    track.first_time += times_s_.size();
    track.first_value += values_.size();
  }
  scene.tracks.insert(scene.tracks.begin(), tracks_.begin(), tracks_.end());
  scene.track_times_s.insert(scene.track_times_s.begin(), times_s_.begin(), times_s_.end());
  scene.track_values.insert(scene.track_values.begin(), values_.begin(), values_.end());
  for (TrackId& id : scene.objects.visibility) {
    if (id.valid()) id = TrackId(id.value + shift);
  }
  const auto renumber = [shift](const auto& as_read, auto& uses) {
    assert(uses.size() >= as_read.size());
    std::copy(as_read.begin(), as_read.end(), uses.begin());
    for (std::size_t i = as_read.size(); i < uses.size(); ++i)
      uses[i].track = TrackId(uses[i].track.value + shift);
  };
  renumber(frame_tracks_, scene.frame_tracks);
  renumber(object_mesh_tracks_, scene.object_mesh_tracks);
  renumber(material_tracks_, scene.material_tracks);
}

TrackSharing::TrackSharing(Scene& scene) : scene_(scene) {
  for (std::size_t i = 0; i < scene.tracks.size(); ++i) {
    if (scene.tracks[i].property == Property::visibility) remember(TrackId(i));
  }
}

TrackId TrackSharing::add(Property property, Interpolation interpolation, std::span<const float> times_s,
                          std::span<const float> values) {
  const auto [begin, end] = by_hash_.equal_range(hash_of({property, interpolation}, times_s, values));
  for (auto it = begin; it != end; ++it) {
    const Track& track = scene_.tracks[it->second.value];
    if (track.property == property && track.interpolation == interpolation &&
        same_bits(scene_.times_s(it->second), times_s) && same_bits(scene_.values(it->second), values)) {
      return it->second;
    }
  }
  const TrackId id = scene_.add_track(property, interpolation, times_s, values);
  remember(id);
  return id;
}

void TrackSharing::remember(TrackId id) {
  by_hash_.emplace(hash_of(scene_.tracks[id.value], scene_.times_s(id), scene_.values(id)), id);
}

std::optional<float> first_appearance_s(const Scene& scene, ObjectId object) {
  const TrackId track = scene.objects.visibility[object.value];
  if (!track.valid()) return 0.0F;
  const std::span<const float> values = scene.values(track);
  const auto first = std::find_if(values.begin(), values.end(), [](float v) { return v != 0.0F; });
  if (first == values.end()) return std::nullopt;
  return first == values.begin() ? 0.0F
                                 : scene.times_s(track)[static_cast<std::size_t>(first - values.begin())];
}

}  // namespace scenegen::timeline
