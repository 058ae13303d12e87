#include "timeline/track_table.h"

#include <algorithm>

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

}  // namespace

void remove_visibility_tracks(Scene& scene) {
  std::fill(scene.objects.visibility.begin(), scene.objects.visibility.end(), TrackId());
  std::vector<TrackId> renumbered(scene.tracks.size());
  std::vector<Track> kept;
  PoolCompaction times;
  PoolCompaction values;
  for (std::size_t i = 0; i < scene.tracks.size(); ++i) {
    const Track& track = scene.tracks[i];
    if (track.property == Property::visibility) continue;
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
  for (FrameTrack& use : scene.frame_tracks) use.track = renumbered[use.track.value];
  for (ObjectMeshTrack& use : scene.object_mesh_tracks) use.track = renumbered[use.track.value];
  for (MaterialTrack& use : scene.material_tracks) use.track = renumbered[use.track.value];
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
