// Scenes of every kind of track at random, for property tests: frames in hierarchies (some by matrix), shared
// tracks, coinciding keys, keys that change nothing, cubic splines, mesh and material tracks.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/random.h"
#include "scene/scene.h"

namespace scenegen::timeline::test {

class RandomScene {
 public:
  explicit RandomScene(std::uint64_t seed) : random_(seed, "random scene") {}

  Scene make(std::size_t objects = 150, std::size_t frames = 12) {
    scene_ = Scene{};
    scene_.duration_s = 8.0F;
    add_meshes();
    add_frames(frames);
    add_objects(objects);
    for (std::uint32_t m = 0; m < scene_.materials.size(); ++m) {
      if (chance(2)) scene_.material_tracks.push_back({MaterialId(m), track(Property::base_color)});
      if (chance(2)) scene_.material_tracks.push_back({MaterialId(m), track(Property::emissive)});
    }
    scene_.cameras.resize(3);
    for (std::size_t i = 0; i < 3; ++i) {
      scene_.cameras[i].name = "camera_" + std::to_string(i);
      scene_.cameras[i].frame_from_camera = transform();
      if (i > 0 && frames > 0) scene_.cameras[i].frame = FrameId(below(frames));
    }
    return std::move(scene_);
  }

  /// Objects of few kinds, each with `most` fellows at most and one at least: on the same frame, with the
  /// same visibility, looks and mesh.
  Scene make_kinds(std::size_t kinds, std::size_t most) {
    scene_ = Scene{};
    scene_.duration_s = 8.0F;
    add_meshes();
    add_frames(2);
    std::vector<TrackId> shown, looks;
    for (int i = 0; i < 4; ++i) shown.push_back(add_track(Property::visibility));
    for (int i = 0; i < 3; ++i) looks.push_back(add_track(Property::mesh));
    std::vector<std::size_t> kind_of;
    for (std::size_t k = 0; k < kinds; ++k) kind_of.insert(kind_of.end(), 2 + below(most), k);
    for (std::size_t i = kind_of.size(); i > 1; --i) std::swap(kind_of[i - 1], kind_of[below(i)]);
    const auto one_of = [](const auto& ids, std::size_t n) { return n < ids.size() ? ids[n] : TrackId(); };
    for (std::size_t i = 0; i < kind_of.size(); ++i) {
      // kinds differ in the digits of their number
      std::size_t rest = kind_of[i];
      const auto digit = [&](std::size_t base) {
        const std::size_t out = rest % base;
        rest /= base;
        return out;
      };
      const TrackId look = one_of(looks, digit(4));
      const TrackId visible = one_of(shown, digit(5));
      const std::size_t frame = digit(3);
      const ObjectId id = scene_.objects.add("object_" + std::to_string(i), MeshId(digit(4)), transform(),
                                             frame < 2 ? FrameId(frame) : FrameId());
      scene_.objects.visibility[id.value] = visible;
      if (look.valid()) scene_.object_mesh_tracks.push_back({id, look});
    }
    return std::move(scene_);
  }

  std::uint64_t below(std::uint64_t n) { return random_.below(next_++, n); }
  float unit() { return random_.unit(next_++); }
  float in(float lo, float hi) { return lo + (hi - lo) * unit(); }
  bool chance(std::uint64_t n) { return below(n) == 0; }

 private:
  void add_meshes() {
    for (std::uint64_t i = 0; i < 4; ++i) {
      Material m;
      m.name = "material_" + std::to_string(i);
      m.base_color = {unit(), unit(), unit(), 1.0F};
      scene_.materials.push_back(m);
      Geometry g;
      for (int v = 0; v < 3; ++v) g.positions_m.push_back({in(-1, 1), in(-1, 1), in(-1, 1)});
      scene_.geometries.push_back(g);
      scene_.meshes.push_back({"mesh_" + std::to_string(i), {{GeometryId(i), MaterialId(i)}}});
    }
  }

  void add_frames(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      Frame f;
      f.name = "frame_" + std::to_string(i);
      if (i > 0 && !chance(3)) f.parent = FrameId(below(i));
      f.local = transform();
      if (chance(5)) {
        f.has_matrix = true;
        f.matrix = f.local.matrix();
        f.matrix[1][0] += 0.25F;  // sheared: not decomposable
      }
      scene_.frames.push_back(f);
      if (f.has_matrix) continue;
      if (chance(2)) scene_.frame_tracks.push_back({FrameId(i), track(Property::translation)});
      if (chance(2)) scene_.frame_tracks.push_back({FrameId(i), track(Property::rotation)});
      if (chance(3)) scene_.frame_tracks.push_back({FrameId(i), track(Property::scale)});
    }
  }

  void add_objects(std::size_t count) {
    std::vector<TrackId> shared;
    for (int i = 0; i < 10; ++i) shared.push_back(add_track(Property::visibility));
    for (std::size_t i = 0; i < count; ++i) {
      FrameId frame;
      if (!scene_.frames.empty() && !chance(3)) frame = FrameId(below(scene_.frames.size()));
      const ObjectId id =
          scene_.objects.add("object_" + std::to_string(i), MeshId(below(4)), transform(), frame);
      if (!chance(4)) scene_.objects.visibility[id.value] = shared[below(shared.size())];
      if (chance(6)) scene_.object_mesh_tracks.push_back({id, track(Property::mesh)});
    }
  }

  Transform transform() {
    return {{in(-9, 9), in(-9, 9), in(-9, 9)}, quaternion(), {in(0.5F, 2), in(0.5F, 2), 1}};
  }

  glm::quat quaternion() { return glm::normalize(glm::quat(in(-1, 1), in(-1, 1), in(-1, 1), in(0.1F, 1))); }

  /// One made before, if the same kind comes up again by chance: tracks are shared.
  TrackId track(Property property) {
    if (chance(3)) {
      for (std::size_t i = 0; i < scene_.tracks.size(); ++i) {
        if (scene_.tracks[i].property == property) return TrackId(i);
      }
    }
    return add_track(property);
  }

  TrackId add_track(Property property) {
    const bool steps = property == Property::visibility || property == Property::mesh;
    const auto interpolation = steps ? Interpolation::step : static_cast<Interpolation>(below(3));
    std::vector<float> times;
    float t = chance(2) ? 0.0F : 0.25F * static_cast<float>(below(6));
    for (std::uint64_t i = 0, n = 1 + below(6); i < n; ++i) {
      times.push_back(t);
      t += 0.25F * static_cast<float>(1 + below(5));
    }
    std::vector<float> values;
    std::vector<float> last;
    for (std::size_t k = 0; k < times.size(); ++k) {
      if (last.empty() || !chance(3)) last = value(property);
      const bool cubic = interpolation == Interpolation::cubic_spline;
      if (cubic) append_tangent(values, last.size());
      values.insert(values.end(), last.begin(), last.end());
      if (cubic) append_tangent(values, last.size());
    }
    return scene_.add_track(property, interpolation, times, values);
  }

  void append_tangent(std::vector<float>& values, std::size_t width) {
    const bool zero = chance(2);
    for (std::size_t i = 0; i < width; ++i) values.push_back(zero ? 0.0F : in(-0.3F, 0.3F));
  }

  std::vector<float> value(Property property) {
    switch (property) {
      case Property::visibility:
        return {static_cast<float>(below(2))};
      case Property::mesh:
        return {static_cast<float>(below(4))};
      case Property::rotation: {
        const glm::quat q = chance(4) ? -quaternion() : quaternion();
        return {q.x, q.y, q.z, q.w};
      }
      case Property::scale:
        return {in(0.5F, 2), in(0.5F, 2), in(0.5F, 2)};
      case Property::base_color:
        return {unit(), unit(), unit(), unit()};
      default:
        return {in(-5, 5), in(-5, 5), in(-5, 5)};
    }
  }

  Random random_;
  std::uint64_t next_ = 0;
  Scene scene_;
};

}  // namespace scenegen::timeline::test
