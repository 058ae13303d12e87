#include "tests/render/render_support.h"

#include <array>
#include <deque>

namespace scenegen::render::test {

Geometry box_geometry() {
  Geometry g;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      glm::vec3 n(0.0F);
      n[axis] = side;
      glm::vec3 u(0.0F);
      u[(axis + 1) % 3] = side;
      const glm::vec3 v = glm::cross(n, u);
      const auto first = static_cast<std::uint32_t>(g.positions_m.size());
      for (const glm::vec2 c : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
        g.positions_m.push_back(0.5F * (n + c.x * u + c.y * v));
        g.normals.push_back(n);
        g.texcoords[0].push_back(0.5F + 0.5F * glm::vec2(c.x, -c.y));
      }
      for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) g.indices.push_back(first + i);
    }
  }
  return g;
}

Geometry quad_geometry() {
  Geometry g;
  g.positions_m = {{-0.5F, -0.5F, 0}, {0.5F, -0.5F, 0}, {0.5F, 0.5F, 0}, {-0.5F, 0.5F, 0}};
  g.normals.assign(4, glm::vec3(0, 0, 1));
  g.texcoords[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  g.indices = {0, 1, 2, 0, 2, 3};
  return g;
}

MeshId add_mesh(Scene& scene, Geometry geometry, const Material& material) {
  scene.geometries.push_back(std::move(geometry));
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.name = "mesh " + std::to_string(scene.meshes.size());
  mesh.primitives.push_back(
      {GeometryId(scene.geometries.size() - 1), MaterialId(scene.materials.size() - 1)});
  scene.meshes.push_back(mesh);
  return MeshId(scene.meshes.size() - 1);
}

ObjectId add_object(Scene& scene, const std::string& name, MeshId mesh, const glm::vec3& at_m,
                    const glm::vec3& scale) {
  Transform t;
  t.translation_m = at_m;
  t.scale = scale;
  return scene.objects.add(name, mesh, t);
}

Material plain(const glm::vec4& color, bool unlit) {
  Material m;
  m.base_color = color;
  m.metallic = 0.0F;
  m.roughness = 0.8F;
  m.unlit = unlit;
  return m;
}

void appear_at(Scene& scene, ObjectId id, float time_s) {
  const std::array times{0.0F, time_s};
  const std::array values{0.0F, 1.0F};
  scene.objects.visibility[id.value] =
      scene.add_track(Property::visibility, Interpolation::step, times, values);
  scene.duration_s = std::max(scene.duration_s, time_s + 1.0F);
}

Scene wall_scene() {
  Scene scene;
  const MeshId ground = add_mesh(scene, box_geometry(), plain({0.35F, 0.4F, 0.3F, 1}));
  const std::array bricks{add_mesh(scene, box_geometry(), plain({0.6F, 0.22F, 0.14F, 1})),
                          add_mesh(scene, box_geometry(), plain({0.7F, 0.35F, 0.2F, 1})),
                          add_mesh(scene, box_geometry(), plain({0.5F, 0.5F, 0.52F, 1}))};
  Material glass = plain({0.4F, 0.6F, 0.7F, 0.4F});
  glass.alpha_mode = AlphaMode::blend;
  glass.roughness = 0.1F;
  const MeshId pane = add_mesh(scene, box_geometry(), glass);
  add_object(scene, "ground", ground, {0, -0.05F, 0}, {30, 0.1F, 30});
  int n = 0;
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) {
      if (y >= 2 && y <= 3 && x >= 3 && x <= 4) continue;
      const glm::vec3 at(static_cast<float>(x) - 3.5F + (y % 2 == 0 ? 0.0F : 0.25F),
                         0.25F + 0.5F * static_cast<float>(y), 0.0F);
      const ObjectId id = add_object(scene, "brick_" + std::to_string(n),
                                     bricks[static_cast<std::size_t>(n) % 3], at, {0.98F, 0.48F, 0.5F});
      appear_at(scene, id, 0.1F * static_cast<float>(++n));
    }
  }
  add_object(scene, "pane_back", pane, {0, 1.5F, 0.0F}, {2, 1, 0.02F});
  add_object(scene, "pane_front", pane, {0.8F, 1.4F, 1.0F}, {2, 1.5F, 0.02F});
  add_object(scene, "turned", bricks[0], {2.5F, 0.75F, 2.0F}, {-1, 1.5F, 1});
  return scene;
}

View look(const glm::vec3& eye_m, const glm::vec3& target_m, glm::uvec2 size, float yfov_rad) {
  Lens lens;
  lens.yfov_rad = yfov_rad;
  lens.near_m = 0.1F;
  return make_view(look_at(eye_m, target_m), lens, static_cast<float>(size.x) / static_cast<float>(size.y));
}

RendererOptions test_options() {
  RendererOptions o;
  o.device.validation = true;
  o.size = {160, 90};
  o.outputs = {true, true, true};
  o.shadows = false;
  return o;
}

std::vector<FrameResult> render(const Scene& scene, const std::vector<double>& times_s, const View& view,
                                const RendererOptions& options) {
  timeline::Player player(timeline::compile(scene));
  Result<Renderer> renderer = Renderer::create(scene, player, options);
  if (!renderer) FAIL(renderer.error().str());
  std::vector<FrameResult> out;
  const auto finish = [&] {
    const Result<void> finished = renderer->finish(out.emplace_back());
    if (!finished) FAIL(finished.error().str());
  };
  for (const double t : times_s) {
    if (renderer->in_flight() == renderer->most_in_flight()) finish();
    const timeline::ChangeSet& changes = player.seek(t);
    const Result<void> submitted = renderer->submit(changes, player, view);
    if (!submitted) FAIL(submitted.error().str());
  }
  while (renderer->in_flight() > 0) finish();
  for (const std::string& message : renderer->take_validation_messages()) FAIL_CHECK(message);
  return out;
}

FrameResult render_one(const Scene& scene, const View& view, const RendererOptions& options, double time_s) {
  return render(scene, {time_s}, view, options).front();
}

glm::ivec3 pixel(const FrameResult& frame, glm::uvec2 size, std::uint32_t x, std::uint32_t y) {
  const std::size_t at = std::size_t{4} * (std::size_t{y} * size.x + x);
  return {frame.rgba[at], frame.rgba[at + 1], frame.rgba[at + 2]};
}

}  // namespace scenegen::render::test
