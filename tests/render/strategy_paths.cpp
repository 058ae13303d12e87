#include "tests/render/strategy_paths.h"

#include <array>
#include <cmath>
#include <cstring>

#include "scene/random.h"

namespace scenegen::render::test {
namespace {

/// Three rows of long walls, each of panels of boxes, with clutter behind every wall; glass here and there.
class Yard {
 public:
  explicit Yard(std::size_t objects) {
    for (const glm::vec4 color :
         {glm::vec4(0.6F, 0.22F, 0.14F, 1), glm::vec4(0.7F, 0.6F, 0.4F, 1), glm::vec4(0.4F, 0.45F, 0.5F, 1)})
      meshes_.push_back(add_mesh(scene, box_geometry(), plain(color)));
    Material glass = plain({0.4F, 0.6F, 0.7F, 0.4F});
    glass.alpha_mode = AlphaMode::blend;
    pane_ = add_mesh(scene, box_geometry(), glass);
    add("ground", meshes_[2], {0, -0.5F, 0}, {60, 1, 60});
    const int panels = 30;
    for (int row = 0; row < 3; ++row) {
      for (int p = 0; p < panels; ++p) {
        const ObjectId id =
            add("panel", meshes_[static_cast<std::size_t>(p) % 3],
                {2.0F * static_cast<float>(p - panels / 2) + 1.0F, 2.0F, 12.0F * static_cast<float>(row - 1)},
                {2.0F, 4.0F, 0.3F});
        walls.push_back(id);
      }
      add("pane", pane_, {3.0F * static_cast<float>(row), 1.5F, 12.0F * static_cast<float>(row - 1) + 1.5F},
          {3, 2, 0.05F});
    }
    for (std::size_t i = scene.objects.size(); i < objects; ++i) {
      const auto unit = [&](std::uint64_t k) { return random.unit(8 * i + k); };
      clutter.push_back(add("thing", meshes_[i % 3],
                            {56 * unit(0) - 28, 0.2F + 3.2F * unit(1), 40 * unit(2) - 18},
                            glm::vec3(0.3F) + 0.5F * glm::vec3(unit(3), unit(4), unit(5))));
    }
  }

  ObjectId add(const std::string& name, MeshId mesh, const glm::vec3& at, const glm::vec3& size) {
    return add_object(scene, name + " " + std::to_string(scene.objects.size()), mesh, at, size);
  }

  void visible(ObjectId id, std::vector<float> times, std::vector<float> values) {
    scene.objects.visibility[id.value] =
        scene.add_track(Property::visibility, Interpolation::step, times, values);
  }

  [[nodiscard]] MeshId mesh(std::size_t i) const { return meshes_[i]; }

  Scene scene;
  std::vector<ObjectId> walls, clutter;
  Random random{17, "yard"};

 private:
  std::vector<MeshId> meshes_;
  MeshId pane_;
};

constexpr float kLength_s = 10.0F;

float share(std::size_t i, std::size_t n) {
  return n > 1 ? static_cast<float>(i) / static_cast<float>(n - 1) : 0.0F;
}

PathFrame facing(double time_s, const glm::vec3& eye, float heading_rad, float down = 0.05F) {
  return {time_s, eye, eye + glm::vec3(std::sin(heading_rad), -down, -std::cos(heading_rad))};
}

/// Along the street, with a fast turn at every fifth frame.
Path walk(std::size_t frames, std::size_t objects) {
  Yard yard(objects);
  yard.scene.duration_s = kLength_s;
  Path path{"walk with fast turns", std::move(yard.scene), {}};
  for (std::size_t i = 0; i < frames; ++i) {
    const float s = share(i, frames);
    const float turn = i % 10 < 5 ? 0.4F : 2.2F;
    path.frames.push_back(facing(0.0, {-24.0F + 48.0F * s, 1.7F, 6.0F}, turn + s));
  }
  return path;
}

Path cuts(std::size_t frames, std::size_t objects) {
  Yard yard(objects);
  for (std::size_t i = 0; i < yard.clutter.size(); i += 3)
    yard.visible(yard.clutter[i], {0, kLength_s * share(i, yard.clutter.size())}, {0, 1});
  yard.scene.duration_s = kLength_s;
  Path path{"camera cuts", std::move(yard.scene), {}};
  const std::array eyes{glm::vec3(0, 1.7F, 18), glm::vec3(20, 1.7F, 5), glm::vec3(-5, 30, 30),
                        glm::vec3(0, 1.6F, -5.5F), glm::vec3(-27, 2, -16)};
  for (std::size_t i = 0; i < frames; ++i) {
    const glm::vec3 eye = eyes[(i / 4 + i / 9) % eyes.size()];
    path.frames.push_back(
        {kLength_s * share(i, frames), eye + 0.02F * static_cast<float>(i), {1, 1, -2}, kPathSize});
  }
  return path;
}

/// A still camera before a wall whose panels go and come back.
Path vanishing_walls(std::size_t frames, std::size_t objects) {
  Yard yard(objects);
  for (std::size_t i = 0; i < yard.walls.size(); ++i) {
    const float gone = 0.5F + 8.0F * yard.random.unit(90'000 + i);
    yard.visible(yard.walls[i], {0, gone, gone + 0.9F}, {1, 0, 1});
  }
  yard.scene.duration_s = kLength_s;
  Path path{"vanishing walls", std::move(yard.scene), {}};
  for (std::size_t i = 0; i < frames; ++i)
    path.frames.push_back({kLength_s * share(i, frames), {0, 1.7F, 20}, {2, 1.2F, 0}, kPathSize});
  return path;
}

/// First in any order (C = 0), then again along a line (C = 1); back in time at the end.
Path coherence(std::size_t frames, std::size_t objects) {
  Yard yard(objects);
  for (std::size_t i = 0; i < yard.clutter.size(); ++i) {
    const float any = 0.05F + 4.0F * yard.random.unit(91'000 + i);
    const float along =
        5.0F + 4.0F * yard.scene.objects.frame_from_object[yard.clutter[i].value].translation_m.x / 60.0F +
        2.0F;
    yard.visible(yard.clutter[i], {0, any, 4.5F, along}, {0, 1, 0, 1});
  }
  for (std::size_t i = 0; i < yard.walls.size(); ++i)
    yard.visible(yard.walls[i], {0, 0.2F + 8.0F * yard.random.unit(92'000 + i)}, {0, 1});
  yard.scene.duration_s = kLength_s;
  Path path{"coherence 0 to 1", std::move(yard.scene), {}};
  for (std::size_t i = 0; i < frames; ++i) {
    const float s = share(i, frames);
    const float t = s < 0.8F ? kLength_s * s / 0.8F : kLength_s * (1.0F - s) / 0.2F;
    path.frames.push_back(facing(t, {-10.0F + 20.0F * s, 2.5F, 17.0F}, 0.5F - s));
  }
  return path;
}

/// Things that travel through walls and nodes, and one that turns inside out.
Path moving(std::size_t frames, std::size_t objects) {
  Yard yard(objects);
  Scene& scene = yard.scene;
  for (std::size_t k = 0; k < 24; ++k) {
    Frame frame;
    frame.name = "mover " + std::to_string(k);
    const FrameId id(static_cast<std::uint32_t>(scene.frames.size()));
    scene.frames.push_back(frame);
    Transform at;
    at.scale = glm::vec3(1.5F);
    scene.objects.add("moved " + std::to_string(k), yard.mesh(k % 3), at, id);
    const auto unit = [&](std::uint64_t i) { return yard.random.unit(93'000 + 8 * k + i); };
    const glm::vec3 a(50 * unit(0) - 25, 1.0F + 2 * unit(1), 36 * unit(2) - 18);
    const glm::vec3 b(90 * unit(3) - 45, 1.0F + 3 * unit(4), 60 * unit(5) - 30);  // some leave the root
    scene.frame_tracks.push_back(
        {id, scene.add_track(Property::translation, Interpolation::linear, std::array{0.0F, kLength_s},
                             std::array{a.x, a.y, a.z, b.x, b.y, b.z})});
    if (k % 4 == 0)
      scene.frame_tracks.push_back(
          {id, scene.add_track(Property::scale, Interpolation::step, std::array{0.0F, 4.0F, 6.0F},
                               std::array{1.0F, 1.0F, 1.0F, -1.0F, 1.0F, 1.0F, 1.0F, 1.0F, 1.0F})});
  }
  scene.duration_s = kLength_s;
  Path path{"moving objects", std::move(yard.scene), {}};
  for (std::size_t i = 0; i < frames; ++i) {
    const float s = share(i, frames);
    path.frames.push_back(facing(kLength_s * s, {4.0F - 8.0F * s, 1.8F, 19.0F}, -0.2F + 0.4F * s));
  }
  return path;
}

/// Pictures of several sizes, with meshes swapped and colours changed on the way.
Path resizes(std::size_t frames, std::size_t objects) {
  Yard yard(objects);
  Scene& scene = yard.scene;
  for (std::size_t i = 0; i < yard.clutter.size(); i += 5) {
    const float at = 9.0F * yard.random.unit(94'000 + i);
    scene.object_mesh_tracks.push_back(
        {yard.clutter[i],
         scene.add_track(Property::mesh, Interpolation::step, std::array{0.0F, at},
                         std::array{static_cast<float>(scene.objects.mesh[yard.clutter[i].value].value),
                                    static_cast<float>(yard.mesh(i % 3).value)})});
  }
  scene.material_tracks.push_back(
      {MaterialId(0),
       scene.add_track(Property::base_color, Interpolation::linear, std::array{0.0F, kLength_s},
                       std::array{0.6F, 0.2F, 0.1F, 1.0F, 0.1F, 0.3F, 0.6F, 1.0F})});
  scene.duration_s = kLength_s;
  Path path{"resizes", std::move(yard.scene), {}};
  const std::array sizes{kPathSize, glm::uvec2(160, 120), glm::uvec2(321, 181), glm::uvec2(64, 200)};
  for (std::size_t i = 0; i < frames; ++i) {
    const float s = share(i, frames);
    path.frames.push_back(facing(kLength_s * s, {-6.0F + 9.0F * s, 1.7F, 16.0F}, 0.3F * s));
    path.frames.back().size = sizes[i / 3 % sizes.size()];
  }
  return path;
}

}  // namespace

std::vector<Path> strategy_paths(std::size_t frames, std::size_t objects) {
  std::vector<Path> out;
  for (const auto& make : {walk, cuts, vanishing_walls, coherence, moving, resizes})
    out.push_back(make(frames, objects));
  return out;
}

namespace {

/// One for all paths: making one takes as long as some frames, and drivers give out a limited number.
std::shared_ptr<vkr::Device> device_of_all() {
  static const std::shared_ptr<vkr::Device> device = [] {
    auto made = share_device(test_options().device);
    if (!made) FAIL(made.error().str());
    return std::move(*made);
  }();
  return device;
}

}  // namespace

Run run_path(const Path& path, RendererOptions options) {
  options.shared_device = device_of_all();
  timeline::Player player(timeline::compile(path.scene));
  options.size = path.frames.front().size;
  Result<Renderer> renderer = Renderer::create(path.scene, player, options);
  if (!renderer) FAIL(renderer.error().str());
  Run run;
  const auto finish = [&] {
    const Result<void> finished = renderer->finish(run.frames.emplace_back());
    if (!finished) FAIL(finished.error().str());
  };
  for (const PathFrame& frame : path.frames) {
    if (frame.size != renderer->size()) {
      while (renderer->in_flight() > 0) finish();
      const Result<void> resized = renderer->resize(frame.size);
      if (!resized) FAIL(resized.error().str());
    }
    if (renderer->in_flight() == renderer->most_in_flight()) finish();
    const timeline::ChangeSet& changes = player.seek(frame.time_s);
    const Result<void> submitted =
        renderer->submit(changes, player, look(frame.eye_m, frame.target_m, frame.size, 0.9F));
    if (!submitted) FAIL(submitted.error().str());
  }
  while (renderer->in_flight() > 0) finish();
  run.warnings = renderer->warnings();
  CHECK(renderer->memory(player).own_bytes() > 0);  // also of a tree that was given up
  for (const std::string& message : renderer->take_validation_messages()) FAIL_CHECK(message);
  return run;
}

Difference difference(const Run& run, const Run& brute, const Run& backwards) {
  Difference d;
  REQUIRE(run.frames.size() == brute.frames.size());
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    const FrameResult& a = run.frames[f];
    const FrameResult& b = brute.frames[f];
    const FrameResult& r = backwards.frames[f];
    REQUIRE(a.ids.size() == b.ids.size());
    REQUIRE(a.rgba.size() == b.rgba.size());
    d.pixels += b.ids.size();
    for (std::size_t i = 0; i < b.ids.size(); ++i) {
      const bool tie = b.ids[i] != r.ids[i];
      d.ties += tie ? 1 : 0;
      d.ids += !tie && a.ids[i] != b.ids[i] ? 1 : 0;
      d.depth += std::memcmp(&a.depth[i], &b.depth[i], sizeof(float)) != 0 ? 1 : 0;
      const bool same_colors = std::memcmp(&b.rgba[4 * i], &r.rgba[4 * i], 4) == 0;
      d.color += same_colors && std::memcmp(&a.rgba[4 * i], &b.rgba[4 * i], 4) != 0 ? 1 : 0;
    }
  }
  return d;
}

}  // namespace scenegen::render::test
