#include "tests/support/synthetic_scene.h"

#include <array>
#include <string>

namespace scenegen::testing {

namespace {

/// 4 x 4 RGB, checkered.
constexpr std::uint8_t kCheckerPng[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x04, 0x08, 0x02, 0x00, 0x00, 0x00, 0x26, 0x93, 0x09, 0x29, 0x00,
    0x00, 0x00, 0x18, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x88, 0xb2, 0xd1, 0x38, 0x61, 0xa3, 0x01,
    0x21, 0x19, 0xe0, 0x2c, 0x20, 0xc9, 0x80, 0x53, 0x06, 0x00, 0x94, 0xf3, 0x0f, 0x51, 0x94, 0x52, 0x83,
    0x19, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
};

/// Box of side 1 round the origin, 36 vertices, unindexed.
Geometry box() {
  Geometry g;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      glm::vec3 normal(0.0F), u(0.0F), v(0.0F);
      normal[axis] = side;
      u[(axis + 1) % 3] = side;
      v[(axis + 2) % 3] = 1.0F;
      constexpr std::array<glm::vec2, 6> kCorners{{{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}}};
      for (const glm::vec2& c : kCorners) {
        g.positions_m.push_back(0.5F * (normal + c.x * u + c.y * v));
        g.normals.push_back(normal);
      }
    }
  }
  return g;
}

/// Indexed quad with every vertex stream.
Geometry quad() {
  Geometry g;
  g.positions_m = {{0, 0, 0}, {1.1F, 0, 0}, {1.1F, 0.7F, 0}, {0, 0.7F, 0}};
  g.normals.assign(4, {0, 0, 1});
  g.tangents.assign(4, {1, 0, 0, -1});
  g.texcoords[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  g.texcoords[1] = {{0, 0.5F}, {0.5F, 0.5F}, {0.5F, 0}, {0, 0}};
  g.colors = {{1, 1, 1, 1}, {0.5F, 1, 1, 1}, {1, 0.5F, 1, 1}, {1, 1, 0.5F, 1}};
  g.indices = {0, 1, 2, 0, 2, 3};
  return g;
}

Geometry line() {
  Geometry g;
  g.topology = Topology::line_strip;
  g.positions_m = {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  return g;
}

void add_materials(Scene& scene) {
  scene.images.push_back({"checker", "image/png", {std::begin(kCheckerPng), std::end(kCheckerPng)}});
  scene.images.push_back({"told by its bytes", "", {std::begin(kCheckerPng), std::end(kCheckerPng)}});
  scene.textures.push_back({ImageId(0), {9728, 9987, 33071, 33648}});
  scene.textures.push_back({ImageId(1), {}});
  scene.materials.resize(8);
  std::vector<Material>& m = scene.materials;
  m[0].name = "brick";
  m[0].base_color = {0.7F, 0.3F, 0.2F, 1.0F};
  m[0].metallic = 0.0F;
  m[0].roughness = 0.85F;
  m[1].name = "plaster \"rough\"";
  m[1].metallic = 0.0F;
  m[1].base_color_texture = {TextureId(0), 1, 1.0F, {0.25F, 0.1F}, 0.5F, {2.0F, 3.0F}};
  m[1].normal_texture = {TextureId(1), 0, 0.4F, {}, 0.0F, glm::vec2(1.0F)};
  m[1].occlusion_texture = {TextureId(1), 0, 0.7F, {}, 0.0F, glm::vec2(1.0F)};
  m[1].metallic_roughness_texture = {TextureId(1), 0, 1.0F, {}, 0.0F, glm::vec2(1.0F)};
  m[1].emissive_texture = {TextureId(0), 0, 1.0F, {}, 0.0F, {0.5F, 0.5F}};
  m[2].name = "glass";
  m[2].base_color = {0.6F, 0.8F, 0.9F, 0.3F};
  m[2].alpha_mode = AlphaMode::blend;
  m[2].double_sided = true;
  m[3].name = "leaf";
  m[3].alpha_mode = AlphaMode::mask;
  m[3].alpha_cutoff = 0.3F;
  m[4].name = "lamp";
  m[4].emissive = {6.0F, 5.0F, 1.1F};
  m[5].name = "sign";
  m[5].unlit = true;
  m[6].name = "changing colour";  // default colour: written all the same, a pointer needs it
  m[7].name = "";
}

void add_meshes(Scene& scene) {
  scene.geometries = {box(), quad(), line()};
  const auto mesh = [&](const char* name, std::vector<Primitive> primitives) {
    scene.meshes.push_back({name, std::move(primitives)});
  };
  mesh("brick", {{GeometryId(0), MaterialId(0)}});
  mesh("pane", {{GeometryId(1), MaterialId(2)}});
  mesh("poster", {{GeometryId(1), MaterialId(1)}, {GeometryId(0), MaterialId(4)}});
  mesh("wire", {{GeometryId(2), MaterialId(5)}});
  mesh("brick, changing", {{GeometryId(0), MaterialId(6)}});
  mesh("", {{GeometryId(0), MaterialId(7)}});
  mesh("default material", {{GeometryId(1), MaterialId()}});
}

void add_frames(Scene& scene) {
  const auto frame = [&](const char* name, FrameId parent, glm::vec3 at) {
    Frame f;
    f.name = name;
    f.parent = parent;
    f.local.translation_m = at;
    scene.frames.push_back(f);
    return FrameId(scene.frames.size() - 1);
  };
  const FrameId crane = frame("crane", {}, {10, 0, 0});
  const FrameId hook = frame("hook", crane, {0, 5, 0});
  const FrameId door = frame("brick_0", {}, {0, 0, 8});  // an object has this name
  const FrameId placed = frame("", {}, {});
  scene.frames[placed.value].has_matrix = true;
  scene.frames[placed.value].matrix = glm::mat4(1.0F);
  scene.frames[placed.value].matrix[3][0] = 0.25F;

  const float half = 0.70710677F;
  const float turn_times[] = {1.0F, 3.0F}, turn[] = {0, 0, 0, 1, 0, half, 0, half};
  scene.frame_tracks.push_back(
      {crane, scene.add_track(Property::rotation, Interpolation::linear, turn_times, turn)});
  const float lift_times[] = {0.5F, 2.0F, 4.0F};
  const float lift[] = {9, 9, 9, 0, 5, 0, 0, 1, 0, 0, 1, 0, 0, 3, 0, 0, -1, 0, 0, -1, 0, 0, 5, 0, 7, 7, 7};
  scene.frame_tracks.push_back(
      {hook, scene.add_track(Property::translation, Interpolation::cubic_spline, lift_times, lift)});
  const float slide_times[] = {0.0F, 1.5F, 6.0F}, slide[] = {1, 1, 1, 0.5F, 1, 1, 0.25F, 1, 1};
  scene.frame_tracks.push_back(
      {door, scene.add_track(Property::scale, Interpolation::step, slide_times, slide)});
  const float still_times[] = {0.0F}, still[] = {0, 0, 0, 0, 0, 8, 0, 0, 0};
  scene.frame_tracks.push_back(
      {door, scene.add_track(Property::translation, Interpolation::cubic_spline, still_times, still)});
}

TrackId appear_at(Scene& scene, float time_s) {
  const float times[] = {0.0F, time_s}, values[] = {0, 1};
  return scene.add_track(Property::visibility, Interpolation::step, times, values);
}

void add_objects(Scene& scene) {
  std::vector<TrackId> tracks;
  for (int i = 0; i < 4; ++i) tracks.push_back(appear_at(scene, 0.5F * static_cast<float>(i + 1)));
  tracks.push_back(appear_at(scene, 1.0F));  // equal to tracks[1]
  const float temporary_times[] = {0.75F, 2.25F, 3.0F}, temporary[] = {0, 1, 0};
  tracks.push_back(scene.add_track(Property::visibility, Interpolation::step, temporary_times, temporary));
  const float never_times[] = {0.0F}, never[] = {0};
  tracks.push_back(scene.add_track(Property::visibility, Interpolation::step, never_times, never));
  const float at_end_times[] = {1.0F, 6.0F}, at_end[] = {1, 0};
  tracks.push_back(scene.add_track(Property::visibility, Interpolation::step, at_end_times, at_end));

  for (std::uint32_t i = 0; i < 64; ++i) {
    Transform t;
    t.translation_m = {0.6F * static_cast<float>(i % 8), 0.3F * static_cast<float>(i / 8), 0.1F};
    t.scale = i % 3 == 0 ? glm::vec3(1.0F) : glm::vec3(0.5F, 0.25F, i % 3 == 1 ? 0.25F : 0.2F);
    if (i % 5 == 0) t.rotation = glm::quat(0.70710677F, 0.0F, 0.70710677F, 0.0F);
    const ObjectId id = scene.objects.add("brick_" + std::to_string(i), MeshId(i / 32), t);
    if (i % 4 != 3) scene.objects.visibility[id.value] = tracks[i / 4 % tracks.size()];
  }
  const auto add = [&](std::string_view name, MeshId mesh, TrackId track, FrameId frame, glm::vec3 scale) {
    const ObjectId id = scene.objects.add(name, mesh, {{1, 2, 3}, {1, 0, 0, 0}, scale}, frame);
    scene.objects.visibility[id.value] = track;
    return id;
  };
  const glm::vec3 one(1.0F);
  add("appear_4", MeshId(2), {}, {}, one);  // a group would like this name
  add("static_mesh_0", MeshId(3), tracks[5], {}, one);
  add("Haus \"Süd\"\\\t日本", MeshId(4), tracks[0], {}, {-1, 1, 1});
  add("nothing", MeshId(5), tracks[0], {}, glm::vec3(0.0F));
  add("load", MeshId(0), tracks[2], FrameId(1), {2, 1, 1});
  add("load/visible", MeshId(6), {}, FrameId(1), one);
  add("flat load", MeshId(0), tracks[2], FrameId(0), glm::vec3(0.0F));
  add("leaning", MeshId(0), {}, FrameId(3), one);
  add("door", MeshId(1), tracks[7], FrameId(2), one);

  const float look_times[] = {0.0F, 1.0F, 2.0F, 5.0F}, looks[] = {0, 4, 5, 0};
  const TrackId look = scene.add_track(Property::mesh, Interpolation::step, look_times, looks);
  const float late_times[] = {3.0F}, late[] = {4};
  const TrackId late_look = scene.add_track(Property::mesh, Interpolation::step, late_times, late);
  scene.object_mesh_tracks.push_back({add("painted wall", MeshId(0), tracks[1], {}, {3, 2, 0.1F}), look});
  scene.object_mesh_tracks.push_back({add("painted load", MeshId(5), {}, FrameId(1), one), look});
  scene.object_mesh_tracks.push_back({add("painted late", MeshId(1), tracks[6], {}, one), late_look});
}

void add_cameras_and_material_tracks(Scene& scene) {
  Camera watcher;
  watcher.name = "watcher";
  watcher.frame_from_camera.translation_m = {2, 3, 20};
  scene.cameras.push_back(watcher);
  Camera rider;
  rider.frame = FrameId(1);
  rider.zfar_m = 100.0F;
  scene.cameras.push_back(rider);
  Camera plan;
  plan.name = "plan";
  plan.orthographic = true;
  plan.xmag_m = 8.0F;
  plan.ymag_m = 6.0F;
  plan.zfar_m = 50.0F;
  plan.frame_from_camera.rotation = glm::quat(0.70710677F, -0.70710677F, 0.0F, 0.0F);
  scene.cameras.push_back(plan);

  const float fade_times[] = {1.0F, 4.0F}, fade[] = {1, 1, 1, 1, 0.2F, 0.4F, 0.6F, 1};
  scene.material_tracks.push_back(
      {MaterialId(6), scene.add_track(Property::base_color, Interpolation::linear, fade_times, fade)});
  const float glow_times[] = {0.0F, 2.0F}, glow[] = {0, 0, 0, 3, 2, 1};
  scene.material_tracks.push_back(
      {MaterialId(6), scene.add_track(Property::emissive, Interpolation::linear, glow_times, glow)});
}

}  // namespace

Scene everything_scene() {
  Scene scene;
  add_materials(scene);
  add_meshes(scene);
  add_frames(scene);
  add_objects(scene);
  add_cameras_and_material_tracks(scene);
  scene.duration_s = 6.0F;
  scene.info.seed = 7;
  scene.info.arguments = {"--grid", "2x2", "--title", "\"quoted\""};
  AppearanceInfo appearance;
  appearance.curve = "hilbert";
  appearance.curve_variant = "skilling-2004";
  appearance.order = "+x+y+z";
  appearance.cells = {4, 4, 2};
  appearance.grid_z_up_m = {{0, 0, 0}, {4.8F, 0.3F, 2.4F}};
  appearance.interval_s = 0.5;
  appearance.hold_s = 1;
  appearance.coherence_given = 0.95;
  appearance.coherence_measured = 0.953125;
  appearance.displaced_objects = 3;
  appearance.timed_objects = 64;
  appearance.moments = 4;
  appearance.locality_cells = 13.3;
  scene.info.appearance = appearance;
  return scene;
}

Scene town_scene(std::uint32_t objects, std::uint32_t moments) {
  Scene scene;
  scene.geometries = {box()};
  scene.materials.resize(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    scene.materials[i].name = "brick " + std::to_string(i);
    scene.materials[i].base_color = {0.6F + 0.1F * static_cast<float>(i), 0.3F, 0.2F, 1.0F};
    scene.materials[i].metallic = 0.0F;
    scene.meshes.push_back({"brick " + std::to_string(i), {{GeometryId(0), MaterialId(i)}}});
  }
  std::vector<TrackId> tracks;
  for (std::uint32_t m = 0; m < moments; ++m)
    tracks.push_back(appear_at(scene, 0.01F * static_cast<float>(m + 1)));
  scene.duration_s = 0.01F * static_cast<float>(moments) + 1.0F;
  scene.objects.reserve(objects, std::size_t{objects} * 32);
  std::string name;
  for (std::uint32_t i = 0; i < objects; ++i) {
    const std::uint32_t building = i / 2400, floor = i / 800 % 3, brick = i % 800;
    name = "building_" + std::to_string(10 + building / 10 % 90) + "_" + std::to_string(building) +
           "/floor_" + std::to_string(floor) + "/brick_" + std::to_string(1000 + brick);
    Transform t;
    t.translation_m = {0.5F * static_cast<float>(i % 100) + 9.7F * static_cast<float>(building % 30),
                       0.2F * static_cast<float>(i / 100 % 24),
                       9.7F * static_cast<float>(building / 30) + 0.125F};
    t.scale = i % 12 == 0 ? glm::vec3(0.25F, 0.2F, 0.25F) : glm::vec3(0.5F, 0.2F, 0.25F);
    if (i % 2 == 1) t.rotation = glm::quat(0.70710677F, 0.0F, 0.70710677F, 0.0F);
    const ObjectId id = scene.objects.add(name, MeshId(i % 7 % 3), t);
    scene.objects.visibility[id.value] = tracks[std::uint64_t{i} * moments / objects];
  }
  return scene;
}

}  // namespace scenegen::testing
