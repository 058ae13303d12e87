#include "scene/gltf/write_tracks.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace scenegen::gltf {

FileKeys::FileKeys(const Scene& scene, TrackId track) {
  const std::span<const float> times = scene.times_s(track);
  own = static_cast<std::uint32_t>(times.size());
  leading = times.front() > 0.0F;
  closing = times.back() < scene.duration_s;
  count = own + (leading ? 1U : 0U) + (closing ? 1U : 0U);
}

float file_time_s(const Scene& scene, TrackId track, const FileKeys& keys, std::uint32_t k) {
  if (keys.leading && k == 0) return 0.0F;
  if (keys.closing && k == keys.count - 1) return scene.duration_s;
  return scene.times_s(track)[keys.source(k)];
}

Interpolation file_interpolation(const Scene& scene, TrackId track) {
  const Interpolation in_scene = scene.tracks[track.value].interpolation;
  if (in_scene != Interpolation::cubic_spline) return in_scene;
  return FileKeys(scene, track).count < 2 ? Interpolation::step : in_scene;
}

bool Pattern::shown(const Scene& scene, std::uint32_t source_key) const {
  const float value = scene.values(track)[source_key];
  return look.valid() ? value == static_cast<float>(look.value) : value != 0.0F;
}

namespace {
constexpr std::uint32_t kUnknown = Dedup::kMissing;

std::uint64_t hash_floats(std::span<const float> values, std::uint64_t seed) {
  return fast_hash(values.data(), values.size_bytes(), seed);
}

std::vector<float> file_values(const Scene& scene, const ValueOutput& output) {
  std::vector<float> values;
  for_each_file_value(scene, output.track, output.divisor, [&](float v) { values.push_back(v); });
  return values;
}

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}
}  // namespace

AnimationPlanner::AnimationPlanner(const Scene& scene)
    : scene_(scene),
      input_of_track_(scene.tracks.size(), kUnknown),
      pattern_of_track_(scene.tracks.size(), kUnknown) {}

std::uint32_t AnimationPlanner::input_of(TrackId track) {
  std::uint32_t& known = input_of_track_[track.value];
  if (known != kUnknown) return known;
  const FileKeys keys(scene_, track);
  std::uint64_t hash = keys.count;
  for (std::uint32_t k = 0; k < keys.count; ++k) {
    const float time_s = file_time_s(scene_, track, keys, k);
    hash = fast_hash(&time_s, sizeof time_s, hash);
  }
  bool is_new = false;
  known = inputs_.add(
      hash,
      [&](std::uint32_t i) {
        const FileKeys other(scene_, plan_.inputs[i]);
        if (other.count != keys.count) return false;
        for (std::uint32_t k = 0; k < keys.count; ++k) {
          if (file_time_s(scene_, plan_.inputs[i], other, k) != file_time_s(scene_, track, keys, k))
            return false;
        }
        return true;
      },
      is_new);
  if (is_new) plan_.inputs.push_back(track);
  return known;
}

std::uint32_t AnimationPlanner::pattern_of(const Pattern& pattern) {
  std::uint32_t* known = pattern.look.valid() ? nullptr : &pattern_of_track_[pattern.track.value];
  if (known != nullptr && *known != kUnknown) return *known;
  const FileKeys keys(scene_, pattern.track);
  std::uint64_t hash = keys.count;
  bool ever_shown = false;
  for (std::uint32_t k = 0; k < keys.count; ++k) {
    const bool shown = pattern.shown(scene_, keys.source(k));
    ever_shown = ever_shown || shown;
    hash = hash * 0x100000001b3ULL + (shown ? 2 : 1);  // FNV's prime
  }
  bool is_new = false;
  const std::uint32_t index = patterns_.add(
      fast_hash(&hash, sizeof hash),
      [&](std::uint32_t i) {
        const Pattern& other = plan_.patterns[i];
        const FileKeys other_keys(scene_, other.track);
        if (other_keys.count != keys.count) return false;
        for (std::uint32_t k = 0; k < keys.count; ++k) {
          if (pattern.shown(scene_, keys.source(k)) != other.shown(scene_, other_keys.source(k)))
            return false;
        }
        return true;
      },
      is_new);
  if (is_new) {
    plan_.patterns.push_back(pattern);
    ever_shown_.push_back(ever_shown ? 1 : 0);
  }
  if (known != nullptr) *known = index;
  return index;
}

std::uint32_t AnimationPlanner::sampler_of(const AnimationSampler& sampler) {
  const std::uint64_t key[2] = {
      std::uint64_t{sampler.input} << 32 | sampler.output,
      static_cast<std::uint64_t>(sampler.kind) << 8 | static_cast<std::uint64_t>(sampler.interpolation)};
  bool is_new = false;
  const std::uint32_t index = samplers_.add(
      fast_hash(key, sizeof key),
      [&](std::uint32_t i) {
        const AnimationSampler& other = plan_.samplers[i];
        return other.input == sampler.input && other.output == sampler.output && other.kind == sampler.kind &&
               other.interpolation == sampler.interpolation;
      },
      is_new);
  if (is_new) plan_.samplers.push_back(sampler);
  return index;
}

std::uint32_t AnimationPlanner::pointer_sampler(TrackId track) {
  const std::uint32_t pattern = pattern_of({track, {}});
  bool is_new = false;
  const std::uint32_t output = byte_outputs_.add(
      fast_hash(&pattern, sizeof pattern), [&](std::uint32_t i) { return plan_.byte_outputs[i] == pattern; },
      is_new);
  if (is_new) plan_.byte_outputs.push_back(pattern);
  return sampler_of({input_of(track), output, OutputKind::bytes, Interpolation::step});
}

std::uint32_t AnimationPlanner::scale_sampler(const Pattern& pattern, const glm::vec3& shown) {
  const std::uint32_t pattern_index = pattern_of(pattern);
  // What is never shown is all zeros, whatever its own scale.
  const ScaleOutput wanted{pattern_index, ever_shown_[pattern_index] != 0 ? shown : glm::vec3(0.0F)};
  static_assert(sizeof wanted == 16);  // no padding: hashed as bytes
  bool is_new = false;
  const std::uint32_t output = scale_outputs_.add(
      fast_hash(&wanted, sizeof wanted),
      [&](std::uint32_t i) { return std::memcmp(&plan_.scale_outputs[i], &wanted, sizeof wanted) == 0; },
      is_new);
  if (is_new) plan_.scale_outputs.push_back(wanted);
  return sampler_of({input_of(pattern.track), output, OutputKind::scale, Interpolation::step});
}

std::uint32_t AnimationPlanner::value_sampler(TrackId track, float divisor) {
  const ValueOutput wanted{track, divisor};
  const std::vector<float> values = file_values(scene_, wanted);
  // Equal numbers of another width are another accessor.
  const std::uint32_t w = width(scene_.tracks[track.value].property);
  bool is_new = false;
  const std::uint32_t output = value_outputs_.add(
      hash_floats(values, w),
      [&](std::uint32_t i) {
        const ValueOutput& other = plan_.value_outputs[i];
        return width(scene_.tracks[other.track.value].property) == w &&
               same_bits(file_values(scene_, other), values);
      },
      is_new);
  if (is_new) plan_.value_outputs.push_back(wanted);
  return sampler_of({input_of(track), output, OutputKind::values, file_interpolation(scene_, track)});
}

}  // namespace scenegen::gltf
