// What a dynamic scene is, as plain data: flat arrays joined by typed ids (D 2.3:
// S = <meshes, objects, materials, textures, vertex streams, viewpoint, t, transform / visibility / material
// timelines>). Metres, seconds, right-handed, Y up; texture origin top left, as in glTF. This is the
// authoring form: mutable, checked by scene/validate.h. timeline/compile.h turns its tracks into the
// immutable form that is played.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/id.h"
#include "scene/name_table.h"
#include "scene/transform.h"

namespace scenegen {

// ---- Geometry and appearance
// -------------------------------------------------------------------------------------

enum class Topology : std::uint8_t {
  points,
  lines,
  line_loop,
  line_strip,
  triangles,
  triangle_strip,
  triangle_fan
};

/// Vertex streams of one draw. `positions_m` has V entries; every other vertex stream has V entries or is
/// empty. `indices` empty means unindexed (V vertices drawn in order).
struct Geometry {
  Topology topology = Topology::triangles;
  std::vector<glm::vec3> positions_m;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec4> tangents;  ///< xyz, w = handedness of the bitangent
  std::array<std::vector<glm::vec2>, 2> texcoords;
  std::vector<glm::vec4> colors;  ///< linear RGBA
  std::vector<std::uint32_t> indices;

  [[nodiscard]] std::size_t vertex_count() const { return positions_m.size(); }
  /// Vertices fetched by one draw: indices when indexed.
  [[nodiscard]] std::size_t drawn_vertex_count() const {
    return indices.empty() ? positions_m.size() : indices.size();
  }
  [[nodiscard]] std::size_t triangle_count() const;
  [[nodiscard]] Box bounds() const;
  friend bool operator==(const Geometry&, const Geometry&) = default;
};

/// One draw of a mesh. The same geometry with other materials is other meshes with the same GeometryId.
struct Primitive {
  GeometryId geometry;
  MaterialId material;  ///< none: glTF's default material
  friend bool operator==(const Primitive&, const Primitive&) = default;
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
};

/// Encoded image (PNG, JPEG, …), kept as raw bytes until somebody draws it.
struct Image {
  std::string name;
  std::string mime_type;  ///< "image/png", "image/jpeg", …
  std::vector<std::uint8_t> bytes;
  friend bool operator==(const Image&, const Image&) = default;
};

/// glTF (= OpenGL) numbers, so that they pass through unchanged.
struct Sampler {
  int mag_filter = 0;  ///< 0 not given, 9728 NEAREST, 9729 LINEAR
  int min_filter = 0;  ///< 0 not given, 9728 … 9987
  int wrap_s = 10497;  ///< 10497 REPEAT, 33071 CLAMP_TO_EDGE, 33648 MIRRORED_REPEAT
  int wrap_t = 10497;
  friend bool operator==(const Sampler&, const Sampler&) = default;
};

struct Texture {
  ImageId image;  ///< none when the image is of a kind we do not read
  Sampler sampler;
  friend bool operator==(const Texture&, const Texture&) = default;
};

/// Use of a texture by a material, with KHR_texture_transform. uv' = T(offset) R(rotation) S(scale) uv.
struct TextureUse {
  TextureId texture;  ///< none: not textured
  std::uint32_t texcoord = 0;
  float strength = 1.0F;  ///< normalTexture.scale or occlusionTexture.strength
  glm::vec2 uv_offset{0.0F};
  float uv_rotation_rad = 0.0F;
  glm::vec2 uv_scale{1.0F};
  friend bool operator==(const TextureUse&, const TextureUse&) = default;
};

enum class AlphaMode : std::uint8_t { opaque, mask, blend };

/// glTF 2.0 metallic-roughness material (KHR_materials_unlit included). Colours are linear.
struct Material {
  std::string name;
  glm::vec4 base_color{1.0F};
  float metallic = 1.0F;
  float roughness = 1.0F;
  glm::vec3 emissive{0.0F};  ///< emissiveFactor * KHR_materials_emissive_strength
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5F;
  bool double_sided = false;
  bool unlit = false;
  TextureUse base_color_texture;
  TextureUse metallic_roughness_texture;
  TextureUse normal_texture;
  TextureUse occlusion_texture;
  TextureUse emissive_texture;
  friend bool operator==(const Material&, const Material&) = default;
};

// ---- Time
// --------------------------------------------------------------------------------------------------------

enum class Interpolation : std::uint8_t { step, linear, cubic_spline };

/// What a track drives. Width = floats per key value (cubic splines store in-tangent, value, out-tangent:
/// three times it).
enum class Property : std::uint8_t {
  visibility,   ///< of objects; width 1, 0 or 1; STEP
  translation,  ///< of a frame, m; width 3
  rotation,     ///< of a frame, unit quaternion x y z w; width 4; LINEAR is spherical
  scale,        ///< of a frame; width 3
  mesh,         ///< of an object: which MeshId it shows (material timelines by swapping); width 1, STEP
  base_color,   ///< of a material, linear RGBA; width 4
  emissive,     ///< of a material, linear RGB; width 3
};
[[nodiscard]] std::uint32_t width(Property property);

/// One curve of keys over time in seconds. Before the first key the first value holds, after the last key the
/// last. Tracks are shared: all objects that appear at one moment name the same visibility track.
struct Track {
  Property property = Property::visibility;
  Interpolation interpolation = Interpolation::step;
  std::uint32_t key_count = 0;
  std::uint64_t first_time = 0;   ///< into Scene::track_times_s
  std::uint64_t first_value = 0;  ///< into Scene::track_values
};

struct FrameTrack {
  FrameId frame;
  TrackId track;  ///< translation, rotation or scale; at most one of each per frame
};
struct ObjectMeshTrack {
  ObjectId object;
  TrackId track;  ///< Property::mesh
};
struct MaterialTrack {
  MaterialId material;
  TrackId track;  ///< base_color or emissive; at most one of each per material
};

// ---- Placement
// ---------------------------------------------------------------------------------------------------

/// A coordinate frame that objects, cameras or other frames hang on: present only where something moves or
/// where a chain of glTF nodes cannot be expressed by the object's own transform. A parent stands before its
/// children.
struct Frame {
  std::string name;
  FrameId parent;           ///< none: the world
  Transform local;          ///< parent_from_frame at rest; what FrameTracks replace component by component
  bool has_matrix = false;  ///< use `matrix` instead of `local`: not decomposable, cannot be animated
  glm::mat4 matrix{1.0F};
};

/// Column arrays, one entry an object (D: "mesh instance"); an object's identity is its index and its unique
/// name.
struct Objects {
  std::vector<Transform> frame_from_object;
  std::vector<FrameId> frame;  ///< none: the world
  std::vector<MeshId> mesh;
  std::vector<TrackId> visibility;  ///< none: always visible
  NameTable names;                  ///< unique, UTF-8

  [[nodiscard]] std::size_t size() const { return mesh.size(); }
  void reserve(std::size_t count, std::size_t name_bytes);
  ObjectId add(std::string_view name, MeshId mesh_id, const Transform& transform, FrameId frame_id = {});
};

struct Camera {
  std::string name;
  FrameId frame;                ///< none: the world
  Transform frame_from_camera;  ///< looks along -Z, Y up, as in glTF; scale is ignored
  bool orthographic = false;
  float yfov_rad = 0.8F;               ///< perspective
  float xmag_m = 1.0F, ymag_m = 1.0F;  ///< orthographic: half width and half height
  float znear_m = 0.1F;
  float zfar_m = 0.0F;  ///< 0: infinite
};

// ---- Where it comes from
// -----------------------------------------------------------------------------------------

/// How appearance times were given (METHODS 2, 5); written to asset.extras.scenegen.appearance so that
/// coherence can be measured again from the file alone. Cells, order and curve axes are in the author's frame
/// (Z up).
struct AppearanceInfo {
  std::string curve;          ///< "hilbert", "morton", "row-prime"
  std::string curve_variant;  ///< "skilling-2004" for hilbert, else equal to curve
  std::string order;          ///< "+x+y+z"
  glm::uvec3 cells{1};
  Box grid_z_up_m;  ///< the box that the cells divide
  double interval_s = 0;
  double hold_s = 0;
  double coherence_given = 1;
  double coherence_measured = 1;
  std::uint64_t displaced_objects = 0;
  std::uint64_t timed_objects = 0;  ///< objects that were given a time; the others are always visible
  std::uint64_t moments = 0;        ///< distinct appearance times
  double locality_cells =
      0;  ///< DESIGN 5: mean longest side of the box round 512 consecutive cells of a 32^3 grid
};

/// A task of a schedule, kept so that players can show what is being worked at.
struct CalendarTask {
  std::string id, name;
  std::string type;  ///< canonical profile name: "construct", "demolish", …
  double start_s = 0, finish_s = 0;
};

/// How the timeline's seconds are dates: t seconds are `start` + t / seconds_per_day days. Written to
/// asset.extras.scenegen.calendar.
struct Calendar {
  std::string start;  ///< ISO 8601 without zone: "2024-03-01" or "2024-03-01T08:00:00"
  double seconds_per_day = 1;
  std::vector<CalendarTask> tasks;
};

struct SceneInfo {
  std::string generator;  ///< "scenegen 0.1.0"; of a foreign file: its asset.generator
  std::string copyright;  ///< asset.copyright, kept in all that is made of the file
  std::optional<std::uint64_t> seed;
  std::vector<std::string>
      arguments;  ///< canonical: everything that decides the content, nothing that does not
  std::optional<AppearanceInfo> appearance;
  std::optional<Calendar> calendar;
};

// ---- The scene
// ---------------------------------------------------------------------------------------------------

struct Scene {
  std::vector<Geometry> geometries;
  std::vector<Mesh> meshes;
  std::vector<Image> images;
  std::vector<Texture> textures;
  std::vector<Material> materials;

  std::vector<Frame> frames;
  Objects objects;
  std::vector<Camera> cameras;

  std::vector<Track> tracks;
  std::vector<float> track_times_s;  ///< strictly increasing within a track
  std::vector<float> track_values;
  std::vector<FrameTrack> frame_tracks;
  std::vector<ObjectMeshTrack> object_mesh_tracks;
  std::vector<MaterialTrack> material_tracks;
  float duration_s = 0;  ///< length of the timeline: at least the last key

  SceneInfo info;

  [[nodiscard]] std::span<const float> times_s(TrackId id) const;
  /// key_count * width floats (three times that for cubic splines).
  [[nodiscard]] std::span<const float> values(TrackId id) const;
  /// Copies the keys into the pools. `values` has times.size() * width floats (cubic splines three times
  /// that).
  TrackId add_track(Property property, Interpolation interpolation, std::span<const float> times,
                    std::span<const float> values);
};

/// world_from_frame of every frame at rest (t before every key), in Scene::frames order.
[[nodiscard]] std::vector<glm::mat4> rest_frame_matrices(const Scene& scene);
/// world_from_object at rest; `frames` from rest_frame_matrices().
[[nodiscard]] glm::mat4 rest_world_from_object(const Scene& scene, std::span<const glm::mat4> frames,
                                               ObjectId id);
/// Box of each mesh in its own coordinates, in Scene::meshes order; empty for a mesh without positions.
[[nodiscard]] std::vector<Box> mesh_bounds(const Scene& scene);
/// World box of every object at rest.
[[nodiscard]] std::vector<Box> object_bounds(const Scene& scene, unsigned threads = 1);

}  // namespace scenegen
