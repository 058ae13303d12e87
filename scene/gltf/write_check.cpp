#include "scene/gltf/write_check.h"

#include <simdjson.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string_view>

namespace scenegen::gltf {

namespace {

/// True for finite numbers: exponent bits not all set. Folded over many numbers, one branch in all.
class Finite {
 public:
  void add(float v) { sum_ += v * 0.0F; }  // 0 or NaN
  void add(const glm::vec3& v) { add(v.x), add(v.y), add(v.z); }
  void add(const glm::vec4& v) { add(v.x), add(v.y), add(v.z), add(v.w); }
  void add(const Transform& t) {
    add(t.translation_m);
    add(glm::vec4(t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w));
    add(t.scale);
  }
  void add(std::span<const float> values) {
    for (const float v : values) add(v);
  }
  [[nodiscard]] bool ok() const { return sum_ == 0.0F; }

 private:
  float sum_ = 0.0F;
};

std::string item(std::string_view list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

tl::unexpected<Error> not_finite(std::string where) {
  return fail(ErrorKind::bad_input, std::move(where),
              "a number is not finite; glTF has no NaN and no infinity");
}

bool is_utf8(std::string_view text) {
  return simdjson::validate_utf8(text.data(), text.size());
}

tl::unexpected<Error> not_utf8(std::string where) {
  return fail(ErrorKind::bad_input, std::move(where), "the name is not UTF-8");
}

template <class Vector>
std::span<const float> as_floats(const std::vector<Vector>& v) {
  return {reinterpret_cast<const float*>(v.data()), v.size() * sizeof(Vector) / sizeof(float)};
}

Result<void> check_geometries(const Scene& scene) {
  std::vector<std::uint8_t> used(scene.geometries.size(), 0);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (scene.meshes[m].primitives.empty())
      return fail(ErrorKind::bad_input, item("meshes", m), "no primitives; a glTF mesh has at least one");
    for (const Primitive& p : scene.meshes[m].primitives) used[p.geometry.value] = 1;
  }
  for (std::size_t g = 0; g < scene.geometries.size(); ++g) {
    const Geometry& geometry = scene.geometries[g];
    if (used[g] != 0 && geometry.positions_m.empty())
      return fail(ErrorKind::bad_input, item("geometries", g), "no vertices");
    Finite finite;
    finite.add(as_floats(geometry.positions_m));
    finite.add(as_floats(geometry.normals));
    finite.add(as_floats(geometry.tangents));
    finite.add(as_floats(geometry.texcoords[0]));
    finite.add(as_floats(geometry.texcoords[1]));
    finite.add(as_floats(geometry.colors));
    if (!finite.ok()) return not_finite(item("geometries", g));
  }
  return {};
}

Result<void> check_materials(const Scene& scene) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    Finite finite;
    finite.add(m.base_color);
    finite.add(m.emissive);
    finite.add(m.metallic);
    finite.add(m.roughness);
    finite.add(m.alpha_cutoff);
    for (const TextureUse* use : {&m.base_color_texture, &m.metallic_roughness_texture, &m.normal_texture,
                                  &m.occlusion_texture, &m.emissive_texture}) {
      finite.add(use->strength);
      finite.add(use->uv_rotation_rad);
      finite.add(glm::vec4(use->uv_offset.x, use->uv_offset.y, use->uv_scale.x, use->uv_scale.y));
    }
    if (!finite.ok()) return not_finite(item("materials", i));
  }
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    if (scene.images[i].bytes.empty()) return fail(ErrorKind::bad_input, item("images", i), "no bytes");
    if (image_mime_type(scene.images[i]).empty())
      return fail(ErrorKind::bad_input, item("images", i),
                  "kind '" + scene.images[i].mime_type +
                      "'; glTF holds image/png, image/jpeg, image/webp, image/ktx2");
  }
  return {};
}

Result<void> check_objects(const Scene& scene) {
  const Objects& objects = scene.objects;
  assert(objects.frame.size() == objects.size() && objects.visibility.size() == objects.size());
  assert(objects.names.size() == objects.size() && objects.frame_from_object.size() == objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    Finite finite;
    finite.add(objects.frame_from_object[i]);
    if (!finite.ok()) return not_finite(item("objects", i) + " " + std::string(objects.names[i]));
    if (!is_utf8(objects.names[i])) return not_utf8(item("objects", i));
  }
  return {};
}

Result<void> check_frames_and_cameras(const Scene& scene) {
  for (std::size_t i = 0; i < scene.frames.size(); ++i) {
    const Frame& frame = scene.frames[i];
    Finite finite;
    finite.add(frame.local);
    if (frame.has_matrix) {
      for (int c = 0; c < 4; ++c) finite.add(frame.matrix[c]);
    }
    if (!finite.ok()) return not_finite(item("frames", i) + " " + frame.name);
    if (!is_utf8(frame.name)) return not_utf8(item("frames", i));
  }
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    const Camera& c = scene.cameras[i];
    Finite finite;
    finite.add(c.frame_from_camera);
    finite.add(glm::vec4(c.yfov_rad, c.xmag_m, c.ymag_m, c.znear_m));
    finite.add(c.zfar_m);
    if (!finite.ok()) return not_finite(item("cameras", i) + " " + c.name);
    if (!is_utf8(c.name)) return not_utf8(item("cameras", i));
  }
  return {};
}

Result<void> check_tracks(const Scene& scene) {
  for (std::size_t i = 0; i < scene.tracks.size(); ++i) {
    if (scene.tracks[i].key_count == 0) return fail(ErrorKind::bad_input, item("tracks", i), "no keys");
    Finite finite;
    finite.add(scene.times_s(TrackId(i)));
    finite.add(scene.values(TrackId(i)));
    if (!finite.ok()) return not_finite(item("tracks", i));
    if (scene.times_s(TrackId(i)).front() < 0.0F)
      return fail(ErrorKind::bad_input, item("tracks", i), "a key before t = 0; glTF times are >= 0");
  }
  Finite finite;
  finite.add(scene.duration_s);
  if (!finite.ok() || scene.duration_s < 0.0F)
    return fail(ErrorKind::bad_input, "duration_s", "must be finite and >= 0");
  return {};
}

Result<void> check_names(const Scene& scene) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i)
    if (!is_utf8(scene.meshes[i].name)) return not_utf8(item("meshes", i));
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    if (!is_utf8(scene.materials[i].name)) return not_utf8(item("materials", i));
  for (std::size_t i = 0; i < scene.images.size(); ++i)
    if (!is_utf8(scene.images[i].name)) return not_utf8(item("images", i));
  for (const std::string& argument : scene.info.arguments)
    if (!is_utf8(argument)) return fail(ErrorKind::bad_input, "info.arguments", "an argument is not UTF-8");
  return {};
}

Result<void> check_info(const Scene& scene) {
  if (!is_utf8(scene.info.copyright)) return not_utf8("info.copyright");
  if (!scene.info.appearance) return {};
  const AppearanceInfo& a = *scene.info.appearance;
  Finite finite;
  finite.add(a.grid_z_up_m.lo);
  finite.add(a.grid_z_up_m.hi);
  for (const double v : {a.interval_s, a.hold_s, a.coherence_given, a.coherence_measured, a.locality_cells})
    finite.add(std::isfinite(v) ? 0.0F : NAN);
  if (!finite.ok()) return not_finite("info.appearance");
  if (!is_utf8(a.curve) || !is_utf8(a.curve_variant) || !is_utf8(a.order)) return not_utf8("info.appearance");
  return {};
}

}  // namespace

std::string image_mime_type(const Image& image) {
  const std::string_view head(reinterpret_cast<const char*>(image.bytes.data()),
                              std::min<std::size_t>(image.bytes.size(), 12));
  std::string type = image.mime_type;
  if (type.empty()) {
    if (head.starts_with("\x89PNG")) type = "image/png";
    if (head.starts_with("\xFF\xD8\xFF")) type = "image/jpeg";
    if (head.starts_with("RIFF") && head.ends_with("WEBP")) type = "image/webp";
    if (head.starts_with("\xABKTX 20")) type = "image/ktx2";
  }
  const bool known =
      type == "image/png" || type == "image/jpeg" || type == "image/webp" || type == "image/ktx2";
  return known ? type : std::string();
}

Result<void> check_writable(const Scene& scene) {
  for (const auto check : {check_geometries, check_materials, check_objects, check_frames_and_cameras,
                           check_tracks, check_names, check_info}) {
    if (Result<void> result = check(scene); !result) return result;
  }
  return {};
}

Result<void> check_patchable(const Scene& scene) {
  for (const auto check : {check_frames_and_cameras, check_tracks, check_names, check_info}) {
    if (Result<void> result = check(scene); !result) return result;
  }
  return {};
}

}  // namespace scenegen::gltf
