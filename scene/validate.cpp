#include "scene/validate.h"

#include <simdjson.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <unordered_set>

#include "scene/limits.h"

namespace scenegen {

namespace {

// docs/FORMAT.md 6.
enum Rule : int {
  columns = 1,
  ids = 2,
  names = 3,
  finite = 4,
  unit_rotation = 5,
  streams = 6,
  keys = 7,
  targets = 8,
  frames = 9,
  duration = 10,
  materials = 11,
  cameras = 12,
  appearance = 13
};

template <int N>
bool all_finite(const glm::vec<N, float, glm::defaultp>& v) {
  for (int i = 0; i < N; ++i) {
    if (!std::isfinite(v[i])) return false;
  }
  return true;
}

template <class Vector>
bool all_finite(const std::vector<Vector>& stream) {
  return std::all_of(stream.begin(), stream.end(), [](const Vector& v) { return all_finite(v); });
}

bool all_finite(const glm::quat& q) {
  return std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z) && std::isfinite(q.w);
}

bool is_unit(double x, double y, double z, double w) {
  return std::abs(x * x + y * y + z * z + w * w - 1.0) <= 1e-3;
}

class Checker {
 public:
  Checker(const Scene& scene, std::size_t most) : scene_(scene), most_(most) {}

  std::vector<Finding> run() {
    check_columns();
    check_geometries();
    check_meshes();
    check_materials();
    check_tracks();
    check_frames();
    check_objects();
    check_names();
    check_cameras();
    check_targets();
    check_info();
    return std::move(findings_);
  }

 private:
  void add(Rule rule, std::string where, std::string what) {
    if (findings_.size() < most_) findings_.push_back({rule, std::move(where), std::move(what)});
  }
  [[nodiscard]] bool full() const { return findings_.size() >= most_; }
  static std::string at(std::string_view array, std::size_t i) {
    return std::string(array) + "[" + std::to_string(i) + "]";
  }
  std::string object(std::size_t i) const {
    std::string out = at("objects", i);
    if (i < scene_.objects.names.size()) out.append(" ").append(scene_.objects.names[i]);
    return out;
  }
  template <class Tag>
  void check_id(Id<Tag> id, std::size_t count, bool may_be_none, const std::string& where,
                std::string_view kind) {
    if (!id.valid() && may_be_none) return;
    if (!id.valid()) return add(ids, where, "no " + std::string(kind));
    if (id.value >= count) {
      add(ids, where, std::string(kind) + " " + std::to_string(id.value) + " of " + std::to_string(count));
    }
  }
  void check_transform(const Transform& t, const std::string& where) {
    if (!all_finite(t.translation_m) || !all_finite(t.scale) || !all_finite(t.rotation)) {
      add(finite, where, "a transform that is not finite");
    } else if (!is_unit(t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w)) {
      add(unit_rotation, where, "a rotation that is not of unit length");
    }
  }

  void check_columns();
  void check_geometries();
  void check_meshes();
  void check_use(const TextureUse& use, const std::string& where);
  void check_materials();
  void check_tracks();
  void check_track_values(std::size_t i);
  void check_frames();
  void check_objects();
  void check_names();
  void check_cameras();
  bool check_track(TrackId id, std::initializer_list<Property> allowed, const std::string& where);
  void check_targets();
  void check_info();

  const Scene& scene_;
  std::size_t most_;
  std::vector<Finding> findings_;
  std::size_t object_count_ = 0;  ///< that can be looked at safely
  std::vector<bool> readable_;    ///< tracks whose keys lie within the pools
};

void Checker::check_columns() {
  const Objects& o = scene_.objects;
  const std::size_t n = o.size();
  const auto same = [&](std::size_t count, std::string_view column) {
    if (count != n)
      add(columns, "objects",
          std::string(column) + " has " + std::to_string(count) + " entries, mesh " + std::to_string(n));
  };
  same(o.frame_from_object.size(), "frame_from_object");
  same(o.frame.size(), "frame");
  same(o.visibility.size(), "visibility");
  same(o.names.size(), "names");
  if (n > limits::kMaxObjects) add(columns, "objects", "more than " + std::to_string(limits::kMaxObjects));
  object_count_ = std::min({n, o.frame_from_object.size(), o.frame.size(), o.visibility.size()});
}

void Checker::check_geometries() {
  for (std::size_t i = 0; i < scene_.geometries.size() && !full(); ++i) {
    const Geometry& g = scene_.geometries[i];
    const std::string where = at("geometries", i);
    const std::size_t vertices = g.vertex_count();
    const auto stream = [&](std::size_t count, std::string_view name) {
      if (count == 0 || count == vertices) return;
      add(streams, where,
          std::string(name) + " has " + std::to_string(count) + " entries, positions_m " +
              std::to_string(vertices));
    };
    stream(g.normals.size(), "normals");
    stream(g.tangents.size(), "tangents");
    stream(g.texcoords[0].size(), "texcoords[0]");
    stream(g.texcoords[1].size(), "texcoords[1]");
    stream(g.colors.size(), "colors");
    if (g.topology > Topology::triangle_fan) add(streams, where, "no such topology");
    const auto bad =
        std::find_if(g.indices.begin(), g.indices.end(), [&](std::uint32_t v) { return v >= vertices; });
    if (bad != g.indices.end()) {
      add(streams, where, "index " + std::to_string(*bad) + " of " + std::to_string(vertices) + " vertices");
    }
    const bool ok = all_finite(g.positions_m) && all_finite(g.normals) && all_finite(g.tangents) &&
                    all_finite(g.texcoords[0]) && all_finite(g.texcoords[1]) && all_finite(g.colors);
    if (!ok) add(finite, where, "vertices that are not finite");
  }
}

void Checker::check_meshes() {
  for (std::size_t i = 0; i < scene_.meshes.size() && !full(); ++i) {
    for (const Primitive& primitive : scene_.meshes[i].primitives) {
      const std::string where = at("meshes", i);
      check_id(primitive.geometry, scene_.geometries.size(), false, where, "geometry");
      check_id(primitive.material, scene_.materials.size(), true, where, "material");
    }
  }
  for (std::size_t i = 0; i < scene_.textures.size() && !full(); ++i) {
    check_id(scene_.textures[i].image, scene_.images.size(), true, at("textures", i), "image");
  }
}

void Checker::check_use(const TextureUse& use, const std::string& where) {
  check_id(use.texture, scene_.textures.size(), true, where, "texture");
  if (use.texcoord > 1) add(materials, where, "texcoord " + std::to_string(use.texcoord) + " of 2");
  const bool ok = std::isfinite(use.strength) && all_finite(use.uv_offset) && all_finite(use.uv_scale) &&
                  std::isfinite(use.uv_rotation_rad);
  if (!ok) add(finite, where, "a texture use that is not finite");
}

void Checker::check_materials() {
  const auto within = [](float v, float lo, float hi) { return v >= lo && v <= hi; };
  for (std::size_t i = 0; i < scene_.materials.size() && !full(); ++i) {
    const Material& m = scene_.materials[i];
    const std::string where = at("materials", i) + " " + m.name;
    for (int c = 0; c < 4; ++c) {
      if (!within(m.base_color[c], 0, 1)) add(materials, where, "base_color outside 0 ... 1");
    }
    if (!within(m.metallic, 0, 1)) add(materials, where, "metallic outside 0 ... 1");
    if (!within(m.roughness, 0, 1)) add(materials, where, "roughness outside 0 ... 1");
    if (!all_finite(m.emissive) || glm::any(glm::lessThan(m.emissive, glm::vec3(0)))) {
      add(materials, where, "emissive negative or not finite");
    }
    if (!(m.alpha_cutoff >= 0) || !std::isfinite(m.alpha_cutoff))
      add(materials, where, "alpha_cutoff negative or not finite");
    if (m.alpha_mode > AlphaMode::blend) add(materials, where, "no such alpha mode");
    check_use(m.base_color_texture, where);
    check_use(m.metallic_roughness_texture, where);
    check_use(m.normal_texture, where);
    check_use(m.occlusion_texture, where);
    check_use(m.emissive_texture, where);
  }
}

void Checker::check_tracks() {
  readable_.assign(scene_.tracks.size(), false);
  for (std::size_t i = 0; i < scene_.tracks.size() && !full(); ++i) {
    const Track& track = scene_.tracks[i];
    const std::string where = at("tracks", i);
    if (width(track.property) == 0 || track.interpolation > Interpolation::cubic_spline) {
      add(keys, where, "no such property or interpolation");
      continue;
    }
    if (track.key_count == 0) {
      add(keys, where, "no keys");
      continue;
    }
    const std::uint64_t floats = std::uint64_t{track.key_count} * width(track.property) *
                                 (track.interpolation == Interpolation::cubic_spline ? 3 : 1);
    const std::uint64_t times = scene_.track_times_s.size();
    const std::uint64_t values = scene_.track_values.size();
    if (track.first_time > times || track.key_count > times - track.first_time ||
        track.first_value > values || floats > values - track.first_value) {
      add(keys, where, "keys outside track_times_s or track_values");
      continue;
    }
    readable_[i] = true;
    check_track_values(i);
  }
}

void Checker::check_track_values(std::size_t i) {
  const Track& track = scene_.tracks[i];
  const std::string where = at("tracks", i);
  const auto times = scene_.times_s(TrackId(i));
  const auto values = scene_.values(TrackId(i));
  for (std::size_t k = 0; k < times.size(); ++k) {
    const bool increases = k == 0 ? times[k] >= 0 : times[k] > times[k - 1];
    if (increases && std::isfinite(times[k])) continue;
    add(keys, where,
        "times must be finite, not negative and strictly increasing; key " + std::to_string(k) + " is not");
    break;
  }
  if (std::isfinite(times.back()) && times.back() > scene_.duration_s)
    add(duration, where, "a key behind duration_s");
  if (!std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); })) {
    return add(finite, where, "values that are not finite");
  }
  const bool boolean = track.property == Property::visibility;
  const bool mesh = track.property == Property::mesh;
  if ((boolean || mesh) && track.interpolation != Interpolation::step)
    return add(keys, where, "must be STEP");
  for (std::size_t k = 0; k < values.size() && (boolean || mesh); ++k) {
    if (boolean && values[k] != 0 && values[k] != 1) return add(keys, where, "visibility must be 0 or 1");
    const auto count = static_cast<float>(scene_.meshes.size());
    if (mesh && !(values[k] >= 0 && values[k] < count && values[k] == std::floor(values[k]))) {
      return add(ids, where, "no such mesh at key " + std::to_string(k));
    }
  }
  if (track.property != Property::rotation) return;
  const bool cubic = track.interpolation == Interpolation::cubic_spline;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const float* const q = &values[cubic ? 12 * k + 4 : 4 * k];
    if (!is_unit(q[0], q[1], q[2], q[3]))
      return add(unit_rotation, where, "key " + std::to_string(k) + " is not of unit length");
  }
}

void Checker::check_frames() {
  std::vector<std::uint32_t> depth(scene_.frames.size(), 1);
  for (std::size_t i = 0; i < scene_.frames.size() && !full(); ++i) {
    const Frame& frame = scene_.frames[i];
    const std::string where = at("frames", i) + " " + frame.name;
    if (frame.parent.valid() && frame.parent.value >= i) {
      add(frames, where, "its parent does not stand before it");
    } else if (frame.parent.valid()) {
      depth[i] = depth[frame.parent.value] + 1;
      if (depth[i] == limits::kMaxNodeDepth + 1)
        add(frames, where, "nested deeper than " + std::to_string(limits::kMaxNodeDepth));
    }
    check_transform(frame.local, where);
    for (int c = 0; c < 4; ++c) {
      if (!all_finite(frame.matrix[c])) add(finite, where, "a matrix that is not finite");
    }
  }
}

void Checker::check_objects() {
  for (std::size_t i = 0; i < object_count_ && !full(); ++i) {
    const MeshId mesh = scene_.objects.mesh[i];
    const FrameId frame = scene_.objects.frame[i];
    const TrackId track = scene_.objects.visibility[i];
    if (!mesh.valid() || mesh.value >= scene_.meshes.size())
      check_id(mesh, scene_.meshes.size(), false, object(i), "mesh");
    if (frame.valid() && frame.value >= scene_.frames.size())
      check_id(frame, scene_.frames.size(), true, object(i), "frame");
    if (track.valid() && (track.value >= scene_.tracks.size() ||
                          scene_.tracks[track.value].property != Property::visibility)) {
      check_track(track, {Property::visibility}, object(i));
    }
    const Transform& t = scene_.objects.frame_from_object[i];
    const bool good = all_finite(t.translation_m) && all_finite(t.scale) &&
                      is_unit(t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w);
    if (!good) check_transform(t, object(i));
  }
}

void Checker::check_names() {
  const NameTable& table = scene_.objects.names;
  std::unordered_set<std::string_view> seen;
  seen.reserve(table.size());
  for (std::size_t i = 0; i < table.size() && !full(); ++i) {
    const std::string_view name = table[i];
    if (name.empty()) add(names, at("objects", i), "no name");
    if (!simdjson::validate_utf8(name)) add(names, at("objects", i), "a name that is not UTF-8");
    if (!seen.insert(name).second) add(names, object(i), "a name that another object has");
  }
}

void Checker::check_cameras() {
  for (std::size_t i = 0; i < scene_.cameras.size() && !full(); ++i) {
    const Camera& camera = scene_.cameras[i];
    const std::string where = at("cameras", i) + " " + camera.name;
    check_id(camera.frame, scene_.frames.size(), true, where, "frame");
    check_transform(camera.frame_from_camera, where);
    const bool far_ok = camera.zfar_m == 0 ? !camera.orthographic : camera.zfar_m > camera.znear_m;
    const bool near_ok = camera.orthographic ? camera.znear_m >= 0 : camera.znear_m > 0;
    if (!near_ok || !far_ok || !std::isfinite(camera.znear_m) || !std::isfinite(camera.zfar_m)) {
      add(Rule::cameras, where, "znear must be positive and zfar greater, or 0 for none");
    }
    const bool lens = camera.orthographic ? std::isfinite(camera.xmag_m) && std::isfinite(camera.ymag_m) &&
                                                camera.xmag_m != 0 && camera.ymag_m != 0
                                          : camera.yfov_rad > 0 && camera.yfov_rad < 3.14159265F;
    if (!lens) add(Rule::cameras, where, "yfov must lie between 0 and pi, xmag and ymag must not be 0");
  }
}

bool Checker::check_track(TrackId id, std::initializer_list<Property> allowed, const std::string& where) {
  if (!id.valid() || id.value >= scene_.tracks.size()) {
    check_id(id, scene_.tracks.size(), false, where, "track");
    return false;
  }
  const Property property = scene_.tracks[id.value].property;
  if (std::find(allowed.begin(), allowed.end(), property) != allowed.end()) return true;
  add(targets, where, "track " + std::to_string(id.value) + " drives another property");
  return false;
}

void Checker::check_targets() {
  std::unordered_set<std::uint64_t> seen;
  const auto once = [&](std::uint64_t target, TrackId track, const std::string& where) {
    const auto property = static_cast<std::uint64_t>(scene_.tracks[track.value].property);
    if (!seen.insert((target << 8) | property).second) add(targets, where, "two tracks for one property");
  };
  for (std::size_t i = 0; i < scene_.frame_tracks.size() && !full(); ++i) {
    const FrameTrack& use = scene_.frame_tracks[i];
    const std::string where = at("frame_tracks", i);
    check_id(use.frame, scene_.frames.size(), false, where, "frame");
    if (!check_track(use.track, {Property::translation, Property::rotation, Property::scale}, where))
      continue;
    once(use.frame.value, use.track, where);
    if (use.frame.value < scene_.frames.size() && scene_.frames[use.frame.value].has_matrix) {
      add(targets, where, "a frame with a matrix cannot be animated");
    }
  }
  for (std::size_t i = 0; i < scene_.material_tracks.size() && !full(); ++i) {
    const MaterialTrack& use = scene_.material_tracks[i];
    const std::string where = at("material_tracks", i);
    check_id(use.material, scene_.materials.size(), false, where, "material");
    if (check_track(use.track, {Property::base_color, Property::emissive}, where))
      once(use.material.value, use.track, where);
  }
  for (std::size_t i = 0; i < scene_.object_mesh_tracks.size() && !full(); ++i) {
    const ObjectMeshTrack& use = scene_.object_mesh_tracks[i];
    const std::string where = at("object_mesh_tracks", i);
    check_id(use.object, scene_.objects.size(), false, where, "object");
    if (check_track(use.track, {Property::mesh}, where)) once(use.object.value, use.track, where);
  }
}

void Checker::check_info() {
  if (!(scene_.duration_s >= 0) || !std::isfinite(scene_.duration_s))
    add(duration, "duration_s", "negative or not finite");
  if (scene_.info.seed && *scene_.info.seed > limits::kMaxSeed)
    add(appearance, "info.seed", "beyond 2^53 - 1");
  if (!scene_.info.appearance) return;
  const AppearanceInfo& info = *scene_.info.appearance;
  const auto axis_ok = [](std::uint32_t n) { return n >= 1 && n <= limits::kMaxCellsPerAxis; };
  if (!axis_ok(info.cells.x) || !axis_ok(info.cells.y) || !axis_ok(info.cells.z)) {
    add(appearance, "info.appearance.cells", "outside 1 ... " + std::to_string(limits::kMaxCellsPerAxis));
  }
  const bool ok = std::isfinite(info.interval_s) && std::isfinite(info.hold_s) &&
                  std::isfinite(info.coherence_given) && std::isfinite(info.coherence_measured) &&
                  std::isfinite(info.locality_cells);
  if (!ok) add(appearance, "info.appearance", "numbers that are not finite");
}

}  // namespace

std::vector<Finding> validate(const Scene& scene, std::size_t most) {
  return Checker(scene, most).run();
}

}  // namespace scenegen
