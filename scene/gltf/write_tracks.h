// Which accessors and samplers the animation needs: every distinct set of times, of values, and pair of both
// once.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/gltf/write_dedup.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// A track as the file has it: with a key at t = 0 and one at the end of the timeline, which repeat its first
/// and last value.
struct FileKeys {
  std::uint32_t count = 0;  ///< keys in the file
  std::uint32_t own = 0;    ///< keys of the track
  bool leading = false;     ///< a key at 0 was added
  bool closing = false;     ///< a key at the end was added

  FileKeys() = default;
  FileKeys(const Scene& scene, TrackId track);
  /// The track's key that file key k shows.
  [[nodiscard]] std::uint32_t source(std::uint32_t k) const {
    if (leading) k = k == 0 ? 0 : k - 1;
    return k < own ? k : own - 1;
  }
};

/// Time of file key `k`.
[[nodiscard]] float file_time_s(const Scene& scene, TrackId track, const FileKeys& keys, std::uint32_t k);

/// Interpolation in the file: a cubic spline of one key is a step.
[[nodiscard]] Interpolation file_interpolation(const Scene& scene, TrackId track);

/// Value floats of a track as the file has them (keys x width, cubic splines keys x 3 x width), divided by
/// `divisor`.
template <class Put>
void for_each_file_value(const Scene& scene, TrackId track, float divisor, const Put& put);

enum class OutputKind : std::uint8_t {
  bytes,  ///< UNSIGNED_BYTE SCALAR, 0 or 1
  scale,  ///< FLOAT VEC3, (0,0,0) or the scale while shown
  values  ///< FLOAT, the track's values
};

/// When something is shown: a visibility track, or the keys of a mesh track at which it shows `look`.
struct Pattern {
  TrackId track;
  MeshId look;  ///< none: a visibility track
  [[nodiscard]] bool shown(const Scene& scene, std::uint32_t source_key) const;
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
  explicit AnimationPlanner(const Scene& scene);

  /// Samplers (indices into AnimationPlan::samplers) of a visibility track, or of one look of a mesh track.
  std::uint32_t pointer_sampler(TrackId track);
  std::uint32_t scale_sampler(const Pattern& pattern, const glm::vec3& shown);
  /// Sampler of a translation, rotation, scale, base_color or emissive track.
  std::uint32_t value_sampler(TrackId track, float divisor);

  AnimationPlan take() && { return std::move(plan_); }

 private:
  std::uint32_t input_of(TrackId track);
  std::uint32_t pattern_of(const Pattern& pattern);
  std::uint32_t sampler_of(const AnimationSampler& sampler);

  const Scene& scene_;
  AnimationPlan plan_;
  Dedup inputs_, patterns_, byte_outputs_, scale_outputs_, value_outputs_, samplers_;
  std::vector<std::uint8_t> ever_shown_;         // by pattern
  std::vector<std::uint32_t> input_of_track_;    // kUnknown until asked
  std::vector<std::uint32_t> pattern_of_track_;  // of visibility tracks
};

template <class Put>
void for_each_file_value(const Scene& scene, TrackId track, float divisor, const Put& put) {
  const FileKeys keys(scene, track);
  const std::span<const float> values = scene.values(track);
  const std::uint32_t w = width(scene.tracks[track.value].property);
  const bool is_spline = scene.tracks[track.value].interpolation == Interpolation::cubic_spline;
  const bool as_spline = file_interpolation(scene, track) == Interpolation::cubic_spline;
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
