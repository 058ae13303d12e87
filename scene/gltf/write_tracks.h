// Which accessors and samplers the animation needs: every distinct set of times, of values, and pair of both
// once.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "scene/gltf/write_dedup.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// The tracks of the scene and, behind them, the ones that only files have: a visibility track and a mesh
/// track in one, for objects that share both (look by look; docs/FORMAT.md 5).
class FileTracks {
 public:
  /// Value of a combined track while nothing is shown; else it is a mesh, as in mesh tracks.
  static constexpr float kHidden = -1.0F;

  explicit FileTracks(const Scene& scene) : scene_(scene) {}

  /// The combined track, made once for each pair; the other one itself where one is none.
  TrackId combine(TrackId visibility, TrackId looks);

  [[nodiscard]] std::size_t size() const { return scene_.tracks.size() + combined_.tracks.size(); }
  [[nodiscard]] std::span<const float> times_s(TrackId id) const { return owner(id).times_s(local(id)); }
  [[nodiscard]] std::span<const float> values(TrackId id) const { return owner(id).values(local(id)); }
  [[nodiscard]] const Track& operator[](TrackId id) const { return owner(id).tracks[local(id).value]; }
  [[nodiscard]] float end_s() const { return scene_.duration_s; }

 private:
  [[nodiscard]] bool is_own(TrackId id) const { return id.value >= scene_.tracks.size(); }
  [[nodiscard]] const Scene& owner(TrackId id) const { return is_own(id) ? combined_ : scene_; }
  [[nodiscard]] TrackId local(TrackId id) const {
    return is_own(id) ? TrackId(id.value - scene_.tracks.size()) : id;
  }

  const Scene& scene_;
  Scene combined_;  // only its tracks
  std::map<std::pair<TrackId, TrackId>, TrackId> known_;
};

/// A track as the file has it: with a key at t = 0 and one at the end of the timeline, which repeat its first
/// and last value.
struct FileKeys {
  std::uint32_t count = 0;  ///< keys in the file
  std::uint32_t own = 0;    ///< keys of the track
  bool leading = false;     ///< a key at 0 was added
  bool closing = false;     ///< a key at the end was added

  FileKeys() = default;
  FileKeys(const FileTracks& tracks, TrackId track);
  /// The track's key that file key k shows.
  [[nodiscard]] std::uint32_t source(std::uint32_t k) const {
    if (leading) k = k == 0 ? 0 : k - 1;
    return k < own ? k : own - 1;
  }
};

/// Time of file key `k`.
[[nodiscard]] float file_time_s(const FileTracks& tracks, TrackId track, const FileKeys& keys,
                                std::uint32_t k);

/// Interpolation in the file: a cubic spline of one key is a step.
[[nodiscard]] Interpolation file_interpolation(const FileTracks& tracks, TrackId track);

/// Value floats of a track as the file has them (keys x width, cubic splines keys x 3 x width), divided by
/// `divisor`.
template <class Put>
void for_each_file_value(const FileTracks& tracks, TrackId track, float divisor, const Put& put);

enum class OutputKind : std::uint8_t {
  bytes,  ///< UNSIGNED_BYTE SCALAR, 0 or 1
  scale,  ///< FLOAT VEC3, (0,0,0) or the scale while shown
  values  ///< FLOAT, the track's values
};

/// When something is shown: a visibility track, or the keys of a mesh track (or of a combined one) at which
/// it shows `look`.
struct Pattern {
  TrackId track;
  MeshId look;  ///< none: a visibility track
  [[nodiscard]] bool shown(const FileTracks& tracks, std::uint32_t source_key) const;
};

struct ScaleOutput {
  std::uint32_t pattern = 0;
  glm::vec3 shown{1.0F};
};

struct ValueOutput {
  TrackId track;
  float divisor = 1.0F;
};

struct AnimationSampler {
  std::uint32_t input = 0;   ///< into AnimationPlan::inputs
  std::uint32_t output = 0;  ///< into the list of its kind
  OutputKind kind = OutputKind::bytes;
  Interpolation interpolation = Interpolation::step;
};

/// Each entry names one track that stands for all with the same content.
struct AnimationPlan {
  std::vector<TrackId> inputs;
  std::vector<Pattern> patterns;
  std::vector<std::uint32_t> byte_outputs;  ///< patterns
  std::vector<ScaleOutput> scale_outputs;
  std::vector<ValueOutput> value_outputs;
  std::vector<AnimationSampler> samplers;
};

/// Makes the plan, in the order in which it is asked; memory grows with what is distinct.
class AnimationPlanner {
 public:
  explicit AnimationPlanner(const FileTracks& tracks);

  /// Samplers (indices into AnimationPlan::samplers) of a visibility track, or of one look of a mesh track.
  std::uint32_t pointer_sampler(const Pattern& pattern);
  std::uint32_t scale_sampler(const Pattern& pattern, const glm::vec3& shown);
  /// Sampler of a translation, rotation, scale, base_color or emissive track.
  std::uint32_t value_sampler(TrackId track, float divisor);

  AnimationPlan take() && { return std::move(plan_); }

 private:
  std::uint32_t input_of(TrackId track);
  std::uint32_t pattern_of(const Pattern& pattern);
  std::uint32_t sampler_of(const AnimationSampler& sampler);

  const FileTracks& tracks_;
  AnimationPlan plan_;
  Dedup inputs_, patterns_, byte_outputs_, scale_outputs_, value_outputs_, samplers_;
  std::vector<std::uint8_t> ever_shown_;         // by pattern
  std::vector<std::uint32_t> input_of_track_;    // kUnknown until asked
  std::vector<std::uint32_t> pattern_of_track_;  // of visibility tracks
};

template <class Put>
void for_each_file_value(const FileTracks& tracks, TrackId track, float divisor, const Put& put) {
  const FileKeys keys(tracks, track);
  const std::span<const float> values = tracks.values(track);
  const std::uint32_t w = width(tracks[track].property);
  const bool is_spline = tracks[track].interpolation == Interpolation::cubic_spline;
  const bool as_spline = file_interpolation(tracks, track) == Interpolation::cubic_spline;
  for (std::uint32_t k = 0; k < keys.count; ++k) {
    const std::uint32_t source = keys.source(k);
    const bool added = (keys.leading && k == 0) || (keys.closing && k == keys.count - 1);
    for (std::uint32_t part = as_spline ? 0 : 1; part < (as_spline ? 3U : 2U); ++part) {
      // Flat towards the added keys, so that the first and the last value hold as they do in the scene.
      const bool flat = part != 1 && (added || (keys.leading && k == 1 && part == 0) ||
                                      (keys.closing && k == keys.count - 2 && part == 2));
      const std::size_t at = is_spline ? (std::size_t{source} * 3 + part) * w : std::size_t{source} * w;
      for (std::uint32_t c = 0; c < w; ++c) put(flat ? 0.0F : values[at + c] / divisor);
    }
  }
}

}  // namespace scenegen::gltf
