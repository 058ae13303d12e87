#include "scene/gltf/write_tracks.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace scenegen::gltf {

TrackId FileTracks::combine(TrackId visibility, TrackId looks) {
  if (!looks.valid()) return visibility;
  if (!visibility.valid()) return looks;
  const auto [found, fresh] = known_.emplace(std::pair(visibility, looks), TrackId());
  if (!fresh) return found->second;
  const std::span<const float> when[2] = {scene_.times_s(visibility), scene_.times_s(looks)};
  const std::span<const float> what[2] = {scene_.values(visibility), scene_.values(looks)};
  std::vector<float> times, values;
  std::size_t next[2] = {0, 0};  // keys at or before `now`
  while (next[0] < when[0].size() || next[1] < when[1].size()) {
    const bool first =
        next[1] == when[1].size() || (next[0] < when[0].size() && when[0][next[0]] <= when[1][next[1]]);
    const float now = first ? when[0][next[0]] : when[1][next[1]];
    float current[2] = {0, 0};
    for (int i = 0; i < 2; ++i) {
      if (next[i] < when[i].size() && when[i][next[i]] == now) ++next[i];
      current[i] = what[i][next[i] == 0 ? 0 : next[i] - 1];  // the first value holds before its key
    }
    times.push_back(now);
    values.push_back(current[0] != 0.0F ? current[1] : kHidden);
  }
  const TrackId made = combined_.add_track(Property::mesh, Interpolation::step, times, values);
  return found->second = TrackId(scene_.tracks.size() + made.value);
}

FileKeys::FileKeys(const FileTracks& tracks, TrackId track) {
  const std::span<const float> times = tracks.times_s(track);
  own = static_cast<std::uint32_t>(times.size());
  leading = times.front() > 0.0F;
  closing = times.back() < tracks.end_s();
  count = own + (leading ? 1U : 0U) + (closing ? 1U : 0U);
}

float file_time_s(const FileTracks& tracks, TrackId track, const FileKeys& keys, std::uint32_t k) {
  if (keys.leading && k == 0) return 0.0F;
  if (keys.closing && k == keys.count - 1) return tracks.end_s();
  return tracks.times_s(track)[keys.source(k)];
}

Interpolation file_interpolation(const FileTracks& tracks, TrackId track) {
  const Interpolation in_scene = tracks[track].interpolation;
  if (in_scene != Interpolation::cubic_spline) return in_scene;
  return FileKeys(tracks, track).count < 2 ? Interpolation::step : in_scene;
}

bool Pattern::shown(const FileTracks& tracks, std::uint32_t source_key) const {
  const float value = tracks.values(track)[source_key];
  return look.valid() ? value == static_cast<float>(look.value) : value != 0.0F;
}

namespace {
constexpr std::uint32_t kUnknown = Dedup::kMissing;

std::uint64_t hash_floats(std::span<const float> values, std::uint64_t seed) {
  return fast_hash(values.data(), values.size_bytes(), seed);
}

std::vector<float> file_values(const FileTracks& tracks, const ValueOutput& output) {
  std::vector<float> values;
  for_each_file_value(tracks, output.track, output.divisor, [&](float v) { values.push_back(v); });
  return values;
}

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}
}  // namespace

AnimationPlanner::AnimationPlanner(const FileTracks& tracks)
    : tracks_(tracks), input_of_track_(tracks.size(), kUnknown), pattern_of_track_(tracks.size(), kUnknown) {}

std::uint32_t AnimationPlanner::input_of(TrackId track) {
  std::uint32_t& known = input_of_track_[track.value];
  if (known != kUnknown) return known;
  const FileKeys keys(tracks_, track);
  std::uint64_t hash = keys.count;
  for (std::uint32_t k = 0; k < keys.count; ++k) {
    const float time_s = file_time_s(tracks_, track, keys, k);
    hash = fast_hash(&time_s, sizeof time_s, hash);
  }
  bool is_new = false;
  known = inputs_.add(
      hash,
      [&](std::uint32_t i) {
        const FileKeys other(tracks_, plan_.inputs[i]);
        if (other.count != keys.count) return false;
        for (std::uint32_t k = 0; k < keys.count; ++k) {
          if (file_time_s(tracks_, plan_.inputs[i], other, k) != file_time_s(tracks_, track, keys, k))
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
  const FileKeys keys(tracks_, pattern.track);
  std::uint64_t hash = keys.count;
  bool ever_shown = false;
  for (std::uint32_t k = 0; k < keys.count; ++k) {
    const bool shown = pattern.shown(tracks_, keys.source(k));
    ever_shown = ever_shown || shown;
    hash = hash * 0x100000001b3ULL + (shown ? 2 : 1);  // FNV's prime
  }
  bool is_new = false;
  const std::uint32_t index = patterns_.add(
      fast_hash(&hash, sizeof hash),
      [&](std::uint32_t i) {
        const Pattern& other = plan_.patterns[i];
        const FileKeys other_keys(tracks_, other.track);
        if (other_keys.count != keys.count) return false;
        for (std::uint32_t k = 0; k < keys.count; ++k) {
          if (pattern.shown(tracks_, keys.source(k)) != other.shown(tracks_, other_keys.source(k)))
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

std::uint32_t AnimationPlanner::pointer_sampler(const Pattern& pattern_wanted) {
  const std::uint32_t pattern = pattern_of(pattern_wanted);
  bool is_new = false;
  const std::uint32_t output = byte_outputs_.add(
      fast_hash(&pattern, sizeof pattern), [&](std::uint32_t i) { return plan_.byte_outputs[i] == pattern; },
      is_new);
  if (is_new) plan_.byte_outputs.push_back(pattern);
  return sampler_of({input_of(pattern_wanted.track), output, OutputKind::bytes, Interpolation::step});
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
  const std::vector<float> values = file_values(tracks_, wanted);
  // Equal numbers of another width are another accessor.
  const std::uint32_t w = width(tracks_[track].property);
  bool is_new = false;
  const std::uint32_t output = value_outputs_.add(
      hash_floats(values, w),
      [&](std::uint32_t i) {
        const ValueOutput& other = plan_.value_outputs[i];
        return width(tracks_[other.track].property) == w && same_bits(file_values(tracks_, other), values);
      },
      is_new);
  if (is_new) plan_.value_outputs.push_back(wanted);
  return sampler_of({input_of(track), output, OutputKind::values, file_interpolation(tracks_, track)});
}

}  // namespace scenegen::gltf
