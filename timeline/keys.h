// The value of one track at one time.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "scene/scene.h"

namespace scenegen::timeline {

/// Keys of one track. Segment k runs from key k (inclusive) to key k + 1; segment -1 lies before the first
/// key, the last one never ends.
struct Keys {
  Property property = Property::visibility;
  Interpolation interpolation = Interpolation::step;
  std::uint32_t components = 0;  ///< width(property)
  std::span<const float> times_s;
  std::span<const float> values;

  /// Values of key k as they stand in the track (of cubic splines: the middle one of three).
  [[nodiscard]] std::span<const float> value(std::size_t k) const;
};

/// The segment that holds `time_s`: number of keys with time <= time_s, less one. Float32 key times are
/// compared as the doubles they are.
[[nodiscard]] std::int32_t segment_at(std::span<const float> times_s, double time_s);

/// Whether the value varies within segment k: neither STEP, nor between equal keys (with zero tangents), nor
/// before the first or after the last key.
[[nodiscard]] bool segment_changes(const Keys& keys, std::int32_t k);

/// Value of key `segment` (of the first key for -1): what holds everywhere in a segment that does not change.
[[nodiscard]] glm::vec4 key_value(const Keys& keys, std::int32_t segment);

/// Value at `time_s`, which lies in `segment`, where segment_changes(); `components` of it are meaningful. At
/// the key it is the key's own value, bit for bit. glTF 2.0 appendix C: LINEAR rotations are spherical along
/// the shortest path and normalised; CUBICSPLINE is Hermite with tangents scaled by the segment's length,
/// rotations normalised.
[[nodiscard]] glm::vec4 interpolate(const Keys& keys, std::int32_t segment, double time_s);

}  // namespace scenegen::timeline
