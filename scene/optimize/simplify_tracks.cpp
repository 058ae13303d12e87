#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "scene/optimize/equal.h"
#include "scene/optimize/steps.h"

namespace scenegen::optimizing {

namespace {

/// A track on its own.
struct Curve {
  Property property = Property::visibility;
  Interpolation interpolation = Interpolation::step;
  std::vector<float> times_s, values;

  [[nodiscard]] std::size_t key_count() const { return times_s.size(); }
  [[nodiscard]] std::size_t stride() const {
    return width(property) * (interpolation == Interpolation::cubic_spline ? 3U : 1U);
  }
  [[nodiscard]] bool constant() const { return key_count() == 1; }
  [[nodiscard]] bool same_values(std::size_t a, std::size_t b) const {
    return std::memcmp(&values[a * stride()], &values[b * stride()], stride() * sizeof(float)) == 0;
  }
};

Curve curve_of(const Scene& scene, TrackId id) {
  const Track& track = scene.tracks[id.value];
  const auto times = scene.times_s(id), values = scene.values(id);
  return {track.property, track.interpolation, {times.begin(), times.end()}, {values.begin(), values.end()}};
}

void keep_keys(Curve& curve, const std::vector<std::uint8_t>& keep) {
  const std::size_t stride = curve.stride();
  std::size_t next = 0;
  for (std::size_t k = 0; k < keep.size(); ++k) {
    if (keep[k] == 0) continue;
    curve.times_s[next] = curve.times_s[k];
    std::copy_n(curve.values.begin() + static_cast<std::ptrdiff_t>(k * stride), stride,
                curve.values.begin() + static_cast<std::ptrdiff_t>(next * stride));
    ++next;
  }
  curve.times_s.resize(next);
  curve.values.resize(next * stride);
}

/// A spline that stays at one value becomes a single step.
void simplify_spline(Curve& curve) {
  const std::size_t w = width(curve.property);
  for (std::size_t k = 0; k < curve.key_count() && !curve.constant();
       ++k) {  // one key: tangents lead nowhere
    const float* const key = &curve.values[k * 3 * w];
    const auto zero = [](float v) { return v == 0.0F; };
    if (!std::all_of(key, key + w, zero) || !std::all_of(key + 2 * w, key + 3 * w, zero)) return;
    if (!std::equal(key + w, key + 2 * w, &curve.values[w])) return;
  }
  curve.values = {curve.values.begin() + static_cast<std::ptrdiff_t>(w),
                  curve.values.begin() + static_cast<std::ptrdiff_t>(2 * w)};
  curve.times_s = {0.0F};
  curve.interpolation = Interpolation::step;
}

/// The same function of time with as few keys as that takes.
void simplify(Curve& curve) {
  if (curve.interpolation == Interpolation::cubic_spline) return simplify_spline(curve);
  const std::size_t count = curve.key_count();
  const bool step = curve.interpolation == Interpolation::step;
  std::vector<std::uint8_t> keep(count, 0);
  for (std::size_t k = 0; k < count; ++k) {
    const bool differs_before = k > 0 && !curve.same_values(k - 1, k);
    const bool differs_after = k + 1 < count && !curve.same_values(k, k + 1);
    keep[k] = differs_before || (!step && differs_after) || (step && k == 0) ? 1 : 0;
  }
  if (std::find(keep.begin(), keep.end(), 1) == keep.end()) keep[0] = 1;  // LINEAR and constant
  keep_keys(curve, keep);
  if (curve.constant()) curve.interpolation = Interpolation::step;
  if (curve.interpolation == Interpolation::step) curve.times_s[0] = 0.0F;  // its value holds before it too
}

std::vector<std::uint8_t> used_tracks(const Scene& scene) {
  std::vector<std::uint8_t> used(scene.tracks.size(), 0);
  const auto use = [&](TrackId id) {
    if (id.valid()) used[id.value] = 1;
  };
  for (const TrackId id : scene.objects.visibility) use(id);
  for (const FrameTrack& t : scene.frame_tracks) use(t.track);
  for (const ObjectMeshTrack& t : scene.object_mesh_tracks) use(t.track);
  for (const MaterialTrack& t : scene.material_tracks) use(t.track);
  return used;
}

void put_at_rest(const Curve& curve, Frame& frame) {
  const std::vector<float>& v = curve.values;
  if (curve.property == Property::translation) frame.local.translation_m = {v[0], v[1], v[2]};
  if (curve.property == Property::rotation) frame.local.rotation = glm::quat(v[3], v[0], v[1], v[2]);
  if (curve.property == Property::scale) frame.local.scale = {v[0], v[1], v[2]};
}

/// Tracks may overshoot what a material at rest may be (rule 11 of docs/FORMAT.md).
bool fits_at_rest(const Curve& curve) {
  const float most = curve.property == Property::base_color ? 1.0F : std::numeric_limits<float>::max();
  return std::all_of(curve.values.begin(), curve.values.end(),
                     [&](float v) { return v >= 0.0F && v <= most; });
}

void put_at_rest(const Curve& curve, Material& material) {
  const std::vector<float>& v = curve.values;
  if (curve.property == Property::base_color) material.base_color = {v[0], v[1], v[2], v[3]};
  if (curve.property == Property::emissive) material.emissive = {v[0], v[1], v[2]};
}

/// Erases the uses whose track is constant and whose value put(use, curve) could keep.
template <class Use, class Put>
void settle_constant(std::vector<Use>& uses, const std::vector<Curve>& curves, const Put& put) {
  std::erase_if(uses, [&](const Use& use) {
    const Curve& curve = curves[use.track.value];
    return curve.constant() && put(use, curve);
  });
}

void settle_constants(Scene& scene, const std::vector<Curve>& curves) {
  for (TrackId& id : scene.objects.visibility) {
    if (id.valid() && curves[id.value].constant() && curves[id.value].values[0] != 0.0F) id = TrackId();
  }
  settle_constant(scene.frame_tracks, curves, [&](const FrameTrack& use, const Curve& curve) {
    put_at_rest(curve, scene.frames[use.frame.value]);
    return true;
  });
  settle_constant(scene.object_mesh_tracks, curves, [&](const ObjectMeshTrack& use, const Curve& curve) {
    scene.objects.mesh[use.object.value] = MeshId(static_cast<std::uint64_t>(curve.values[0]));
    return true;
  });
  settle_constant(scene.material_tracks, curves, [&](const MaterialTrack& use, const Curve& curve) {
    if (fits_at_rest(curve)) put_at_rest(curve, scene.materials[use.material.value]);
    return fits_at_rest(curve);
  });
}

std::uint64_t hash_of(const Curve& curve) {
  ContentHash hash;
  hash.mix(static_cast<std::uint64_t>(curve.property) << 8 | static_cast<std::uint64_t>(curve.interpolation));
  hash.add(curve.times_s);
  hash.add(curve.values);
  return hash.value();
}

bool equal(const Curve& a, const Curve& b) {
  const auto same = [](const std::vector<float>& x, const std::vector<float>& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(float)) == 0;
  };
  return a.property == b.property && a.interpolation == b.interpolation && same(a.times_s, b.times_s) &&
         same(a.values, b.values);
}

}  // namespace

void simplify_tracks(Scene& scene, OptimizeReport& report) {
  std::vector<Curve> curves(scene.tracks.size());
  std::vector<std::uint8_t> used = used_tracks(scene);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    if (used[i] == 0) continue;
    curves[i] = curve_of(scene, TrackId(i));
    simplify(curves[i]);
    report.idle_keys += scene.tracks[i].key_count - curves[i].key_count();
  }
  settle_constants(scene, curves);
  const std::vector<std::uint8_t> used_before = std::exchange(used, used_tracks(scene));
  std::vector<std::uint32_t> in_use;  // the others would all have one hash
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    if (used[i] != 0) in_use.push_back(i);
  }
  const auto first = first_equals(
      static_cast<std::uint32_t>(in_use.size()), [&](std::uint32_t k) { return hash_of(curves[in_use[k]]); },
      [&](std::uint32_t a, std::uint32_t b) { return equal(curves[in_use[a]], curves[in_use[b]]); });
  scene.tracks.clear();
  scene.track_times_s.clear();
  scene.track_values.clear();
  std::vector<std::uint32_t> moved(curves.size(), kNone);
  for (std::size_t i = 0; i < curves.size(); ++i)
    report.constant_tracks += used_before[i] != 0 && used[i] == 0 ? 1 : 0;
  for (std::size_t k = 0; k < in_use.size(); ++k) {
    const std::uint32_t i = in_use[k];
    if (first[k] != k) {
      moved[i] = moved[in_use[first[k]]];
      ++report.equal_tracks;
      continue;
    }
    moved[i] =
        scene.add_track(curves[i].property, curves[i].interpolation, curves[i].times_s, curves[i].values)
            .value;
  }
  for (TrackId& id : scene.objects.visibility) renumber(id, moved);
  for (FrameTrack& t : scene.frame_tracks) renumber(t.track, moved);
  for (ObjectMeshTrack& t : scene.object_mesh_tracks) renumber(t.track, moved);
  for (MaterialTrack& t : scene.material_tracks) renumber(t.track, moved);
}

}  // namespace scenegen::optimizing
