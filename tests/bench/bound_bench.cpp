// What choosing could gain at most (issue of the renderer, "Gain"): the time of recording and drawing all
// that is in the frustum over the device's time for what is truly visible. Truly visible is an object that
// owns a pixel of an id picture of twice the width and height, so with about as many points in a pixel as
// four samples have, or that is blended.
//
//   bench_bound FILE.glb... --camera-path PATH.json... --times LIST [--size WxH] [--frames N] [--device NAME]
//   [--csv FILE]
//
// A row per file, camera and moment: `octree-record` with two frames in flight at that moment, and the same
// picture from the visible objects alone, drawn as `inline` and as `octree`, whichever takes the device less.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "render/renderer.h"
#include "scene/gltf/read.h"
#include "tools/drawing_options.h"
#include "tools/frame_times.h"
#include "tools/output.h"

using namespace scenegen;

namespace {

struct Request {
  std::vector<std::string> files, cameras;
  std::string times, device, csv;
  glm::uvec2 size{1920, 1080};
  int frames = 30;
};

struct Sides {
  double cpu_ms = 0, gpu_ms = 0;
  std::uint64_t draws = 0;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? -1.0 : values[values.size() / 2];
}

struct Seen {
  Scene scene;  ///< visible objects alone, where they are
  std::size_t objects = 0;
};

bool blended(const Scene& scene, MeshId mesh) {
  const std::vector<Primitive>& primitives = scene.meshes[mesh.value].primitives;
  return std::any_of(primitives.begin(), primitives.end(), [&](const Primitive& p) {
    return p.material.valid() && scene.materials[p.material.value].alpha_mode == AlphaMode::blend;
  });
}

/// The objects of `ids`, and what is blended and visible by timeline, as a scene without a timeline.
Seen only_visible(const Scene& scene, const timeline::Player& player, std::span<const std::uint32_t> ids) {
  std::vector<bool> wanted(scene.objects.size(), false);
  for (const std::uint32_t id : ids) {
    if (id < wanted.size()) wanted[id] = true;
  }
  Seen seen;
  seen.scene.geometries = scene.geometries;
  seen.scene.meshes = scene.meshes;
  seen.scene.images = scene.images;
  seen.scene.textures = scene.textures;
  seen.scene.materials = scene.materials;
  for (std::uint32_t i = 0; i < wanted.size(); ++i) {
    const ObjectId id(i);
    const MeshId mesh = player.mesh(id);
    if (!mesh.valid() || !player.visible(id)) continue;
    if (!wanted[i] && !blended(scene, mesh)) continue;
    Frame frame;
    frame.has_matrix = true;
    frame.matrix = player.world_from_object(id);
    const FrameId of(static_cast<std::uint32_t>(seen.scene.frames.size()));
    seen.scene.frames.push_back(std::move(frame));
    (void)seen.scene.objects.add(std::to_string(i), mesh, Transform{}, of);
    ++seen.objects;
  }
  return seen;
}

class Bound {
 public:
  Bound(const Request& request, std::shared_ptr<render::vkr::Device> device)
      : request_(request), device_(std::move(device)) {}

  Result<std::vector<std::uint32_t>> ids(const Scene& scene, timeline::Player& player,
                                         const tools::CameraMan& camera, double time_s) const {
    render::RendererOptions o = options("inline");
    o.size = 2U * request_.size;
    o.outputs = {false, true, false, true};
    o.frames_in_flight = 1;
    Result<render::Renderer> renderer = render::Renderer::create(scene, player, o);
    if (!renderer) return forward_error(renderer);
    render::FrameResult frame;
    if (auto done = renderer->submit(player.seek(time_s), player, camera.view(player)); !done)
      return forward_error(done);
    if (auto done = renderer->finish(frame); !done) return forward_error(done);
    return std::move(frame.ids);
  }

  /// Medians over frames that are all the same, two in flight.
  Result<Sides> measure(const Scene& scene, timeline::Player& player, const render::View& view,
                        const std::string& strategy) const {
    Result<render::Renderer> renderer = render::Renderer::create(scene, player, options(strategy));
    if (!renderer) return forward_error(renderer);
    const double time_s = player.time_s();
    std::vector<double> cpu_ms, gpu_ms;
    render::FrameResult frame;
    constexpr int kWarm = 12;
    for (int i = 0; i < kWarm + request_.frames; ++i) {
      if (auto done = renderer->submit(player.seek(time_s), player, view); !done) return forward_error(done);
      if (renderer->in_flight() < renderer->most_in_flight()) continue;
      if (auto done = renderer->finish(frame); !done) return forward_error(done);
      if (i < kWarm) continue;
      const render::FrameReport& r = frame.report;
      cpu_ms.push_back(r.update_ms + r.plan_ms + r.record_ms + r.submit_ms);
      gpu_ms.push_back(r.gpu_ms);
    }
    if (auto done = renderer->finish(frame); !done) return forward_error(done);
    return Sides{median(cpu_ms), median(gpu_ms), frame.report.draws};
  }

  [[nodiscard]] render::RendererOptions options(const std::string& strategy) const {
    render::RendererOptions o;
    o.shared_device = device_;
    o.size = request_.size;
    o.strategy = strategy;
    o.shadows = false;
    o.outputs.readback = false;
    return o;
  }

 private:
  const Request& request_;
  std::shared_ptr<render::vkr::Device> device_;
};

Result<void> one_moment(const Bound& bound, const Scene& scene, timeline::Player& player,
                        const tools::CameraMan& camera, const std::string& name, std::string& csv) {
  const double time_s = player.time_s();
  auto ids = bound.ids(scene, player, camera, time_s);
  if (!ids) return forward_error(ids);
  const render::View view = camera.view(player);
  auto all = bound.measure(scene, player, view, "octree-record");
  if (!all) return forward_error(all);
  const Seen seen = only_visible(scene, player, *ids);
  timeline::Player still(timeline::compile(seen.scene));
  Sides least;
  for (const char* strategy : {"inline", "octree"}) {
    auto sides = bound.measure(seen.scene, still, view, strategy);
    if (!sides) return forward_error(sides);
    if (least.draws == 0 || sides->gpu_ms < least.gpu_ms) least = *sides;
  }
  const double one = (all->cpu_ms + all->gpu_ms) / least.gpu_ms;
  const double two = std::max(all->cpu_ms, all->gpu_ms) / least.gpu_ms;
  std::printf("%-52s %8.2f s  %7lu  %7lu  %8.3f  %8.3f  %8.3f   %6.2f  %6.2f\n", name.c_str(), time_s,
              all->draws, least.draws, all->cpu_ms, all->gpu_ms, least.gpu_ms, one, two);
  std::fflush(stdout);
  std::array<char, 256> line{};
  std::snprintf(line.data(), line.size(), ",%.3f,%lu,%lu,%.4f,%.4f,%.4f,%.4f,%.4f\n", time_s, all->draws,
                least.draws, all->cpu_ms, all->gpu_ms, least.gpu_ms, one, two);
  csv += name + line.data();
  return {};
}

Result<void> run(const Request& request) {
  auto device = render::share_device({.wanted = request.device});
  if (!device) return forward_error(device);
  const Bound bound(request, *device);
  std::printf("%-52s %10s  %7s  %7s  %8s  %8s  %8s   %6s  %6s\n", "file, camera", "time", "draws", "visible",
              "record", "gpu all", "visible", "1 in f", "2 in f");
  std::string csv = "case,time_s,draws,visible,record_ms,gpu_all_ms,gpu_visible_ms,bound1,bound2\n";
  for (const std::string& file : request.files) {
    auto read = gltf::read(file, {});
    if (!read) return forward_error(read);
    const Scene& scene = read->scene;
    auto times = tools::parse_times(request.times, scene.duration_s, nullptr);
    if (!times) return forward_error(times);
    timeline::Player player(timeline::compile(scene));
    for (const std::string& path : request.cameras) {
      auto camera = tools::CameraMan::of_path(path, scene, request.size);
      if (!camera) return forward_error(camera);
      const std::string name = file.substr(file.rfind('/') + 1) + " " + path.substr(path.rfind('/') + 1);
      for (const double time_s : *times) {
        (void)player.seek(time_s);
        if (auto done = one_moment(bound, scene, player, *camera, name, csv); !done) return done;
      }
    }
  }
  if (request.csv.empty()) return {};
  return tools::write_file(request.csv, csv);
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  for (int i = 1; i < argc; ++i) {
    const std::string_view a = argv[i];
    const bool has_value = i + 1 < argc;
    const char* value = has_value ? argv[i + 1] : "";
    if (a.starts_with("--") && has_value) ++i;
    if (a == "--camera-path")
      request.cameras.emplace_back(value);
    else if (a == "--times")
      request.times = value;
    else if (a == "--size")
      (void)std::sscanf(value, "%ux%u", &request.size.x, &request.size.y);
    else if (a == "--frames")
      request.frames = std::max(1, std::atoi(value));
    else if (a == "--device")
      request.device = value;
    else if (a == "--csv")
      request.csv = value;
    else
      request.files.emplace_back(a);
  }
  const Result<void> done = run(request);
  return done ? 0 : tools::report_error(done.error());
}
