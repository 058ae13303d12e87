// What the model is told of scenes, to ask it what each way of drawing would take on devices that are not
// here (tests/render/device_choice_test.cpp, docs/BENCHMARKS.md): counts depend on the scene, the view and
// what is asked, not on the device that draws.
//
//   bench_device_choice FILE.glb... --calibration FILE.json... [-o FACTS.json] [--device NAME] [--at SHARE]
//
// Each scene is played past its first camera at 120 frames for the whole timeline, up to SHARE of it
// (0.75), by `queries` and by `hi-z`, with the unit costs of each calibration: what `queries` asks, and in
// which form chunks are kept, follow from those. A line a scene and calibration: predicted ms of each way.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "render/calibration/calibration_file.h"
#include "render/model/experience.h"
#include "render/renderer.h"
#include "scene/gltf/read.h"
#include "tests/support/facts_json.h"
#include "timeline/timeline.h"
#include "tools/bench_case.h"
#include "tools/drawing_options.h"
#include "tools/output.h"

using namespace scenegen;
using nlohmann::ordered_json;
using render::model::Method;

namespace {

constexpr int kFrames = 24;         // played, so that queries are gathered and what was seen is known
constexpr double kPace = 1. / 120;  // of the timeline a frame

struct Request {
  std::vector<std::string> files, calibrations;
  std::string device, output;
  double at = 0.75;
};

/// The last of the frames.
Result<render::FrameReport> play(const Scene& scene, double at, const render::RendererOptions& options) {
  auto camera = tools::CameraMan::of_scene(scene, "", options.size);
  if (!camera) return forward_error(camera);
  timeline::Player player(timeline::compile(scene));
  const auto time_of = [&](int frame) {
    return static_cast<double>(scene.duration_s) * std::max(0.0, at - (kFrames - 1 - frame) * kPace);
  };
  player.seek(time_of(0));
  auto renderer = render::Renderer::create(scene, player, options);
  if (!renderer) return forward_error(renderer);
  render::FrameResult result;
  for (int i = 0; i < kFrames; ++i) {
    const timeline::ChangeSet& changes = player.seek(time_of(i));
    if (auto done = renderer->submit(changes, player, camera->view(player)); !done)
      return forward_error(done);
    while (renderer->in_flight() >= (i + 1 < kFrames ? renderer->most_in_flight() : 1)) {
      if (auto done = renderer->finish(result); !done) return forward_error(done);
    }
  }
  std::size_t known = 0;
  tools::print_warnings(*renderer, known, false);
  return result.report;
}

/// Facts of both runs: each knows for certain what it did itself. What lies in the frustum is counted by the
/// tree, so that all ways are told of the same sample of slots.
render::model::FrameFacts both(const render::model::FrameFacts& of_device,
                               const render::model::FrameFacts& of_tree) {
  render::model::FrameFacts out = of_tree;
  out.visible_slots = of_device.visible_slots;
  out.seen = of_device.seen;
  out.hi_z_blocks = of_device.hi_z_blocks;
  out.exact_seen = true;
  render::model::Experience{}.fill_unknown(out, 0, {});  // the fragments of what is seen
  return out;
}

render::RendererOptions options_for(const render::Calibration& calibration,
                                    const std::shared_ptr<render::vkr::Device>& device) {
  render::RendererOptions options;
  options.shared_device = device;
  options.size = calibration.key.size;
  options.samples = calibration.key.samples;
  options.shadows = calibration.key.shadows;
  options.outputs.readback = false;
  options.predictions = true;
  options.costs = calibration.costs;
  return options;
}

Result<ordered_json> facts_of(const Scene& scene, render::RendererOptions options, double at,
                              const render::FrameReport& of_device) {
  options.strategy = "queries";
  auto of_tree = play(scene, at, options);
  if (!of_tree) return forward_error(of_tree);
  return ordered_json{{"indirect", of_tree->indirect_commands > 0},
                      {"facts", test::facts_json(both(of_device.facts, of_tree->facts))}};
}

void print_line(const std::string& scene, const render::Calibration& calibration, const ordered_json& row) {
  render::model::PredictionOptions how;
  how.indirect_nodes = row["indirect"];
  how.readback = false;
  const render::model::FrameFacts facts = test::facts_from_json(row["facts"]);
  std::printf("%-24s %-36s", scene.c_str(), calibration.key.device.c_str());
  for (const Method m : {Method::inline_frustum, Method::octree, Method::queries, Method::hi_z})
    std::printf(" %s %.2f", std::string(name_of(m)).c_str(),
                predict(m, facts, calibration.costs, how).frame_s * 1e3);
  std::printf("\n");
  std::fflush(stdout);
}

Result<void> run(const Request& request) {
  std::vector<render::Calibration> calibrations;
  for (const std::string& path : request.calibrations) {
    std::ifstream in(path, std::ios::binary);
    if (!in) return fail(ErrorKind::io, path, "cannot be read");
    const std::string text((std::istreambuf_iterator<char>(in)), {});
    auto calibration = render::parse_calibration(text, path);
    if (!calibration) return forward_error(calibration);
    calibrations.push_back(*calibration);
    const render::CalibrationKey& first = calibrations.front().key;
    if (calibration->key.size != first.size || calibration->key.samples != first.samples)
      return fail(ErrorKind::usage, path, "is for other pictures than " + request.calibrations.front());
  }
  if (calibrations.empty())
    return fail(ErrorKind::usage, "--calibration", "is missing: whose unit costs are taken");
  auto device = render::share_device({.wanted = request.device});
  if (!device) return forward_error(device);
  std::string out;
  for (const std::string& file : request.files) {
    auto read = gltf::read(file, {});
    if (!read) return forward_error(read);
    const std::string name = tools::base_name(file);
    // What the device culls does not follow from costs.
    render::RendererOptions culling = options_for(calibrations.front(), *device);
    culling.strategy = "hi-z";
    auto of_device = play(read->scene, request.at, culling);
    if (!of_device) return forward_error(of_device);
    for (const render::Calibration& calibration : calibrations) {
      auto row = facts_of(read->scene, options_for(calibration, *device), request.at, *of_device);
      if (!row) return forward_error(row);
      print_line(name, calibration, *row);
      ordered_json line{
          {"scene", name.substr(0, name.rfind('.'))}, {"at", request.at}, {"device", calibration.key.device}};
      line.update(*row);
      out += (out.empty() ? "[\n" : ",\n") + line.dump();
    }
  }
  if (request.output.empty()) return {};
  return tools::write_file(request.output, out + "\n]\n");
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  for (int i = 1; i < argc; ++i) {
    const std::string_view a = argv[i];
    const bool has_value = i + 1 < argc;
    const char* value = has_value ? argv[i + 1] : "";
    if (a.starts_with("-") && has_value) ++i;
    if (a == "--calibration")
      request.calibrations.emplace_back(value);
    else if (a == "--device")
      request.device = value;
    else if (a == "--at")
      request.at = std::atof(value);
    else if (a == "-o")
      request.output = value;
    else
      request.files.emplace_back(a);
  }
  const Result<void> done = run(request);
  return done ? 0 : tools::report_error(done.error());
}
