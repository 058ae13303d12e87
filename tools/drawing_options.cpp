#include "tools/drawing_options.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "render/strategy_names.h"
#include "scene/limits.h"
#include "tools/calibrations.h"
#include "tools/camera_paths.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

float aspect_of(glm::uvec2 size) {
  return static_cast<float>(size.x) / static_cast<float>(size.y);
}

Result<CameraId> find_camera(const Scene& scene, const std::string& wanted) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    if (scene.cameras[i].name == wanted || std::to_string(i) == wanted) return CameraId(i);
    names.push_back(scene.cameras[i].name.empty() ? std::to_string(i) : scene.cameras[i].name);
  }
  names.emplace_back("auto");
  if (scene.cameras.empty())
    return fail(ErrorKind::usage, "--camera", "the file has no camera; 'auto' frames the scene");
  return fail(ErrorKind::usage, "--camera", unknown_word("camera", wanted, names));
}

}  // namespace

DrawingOptions::DrawingOptions() {
  const char* wanted = std::getenv("SCENEPLAY_VALIDATION");  // NOLINT(concurrency-mt-unsafe): nobody sets it
  validation = wanted != nullptr && std::string_view(wanted) == "1";
}

render::RendererOptions DrawingOptions::renderer() const {
  render::RendererOptions o;
  o.device.wanted = device;
  o.device.validation = validation;
  o.size = size;
  o.samples = samples;
  o.how.objects_per_node = octree_n;
  o.how.octree_bytes = octree_mib << 20;
  o.how.late_visibility = late_visibility;
  o.how.node_form = node_form;
  o.how.correction = !no_correction;
  o.shadows = shadows;
  o.full_barriers = full_barriers;
  return o;
}

void add_drawing_options(Options& options, DrawingOptions& d, Value strategy, Value frames_in_flight) {
  options.group("Drawing");
  options.add("--samples", choice_value<std::uint32_t>(d.samples, {{"1", 1}, {"4", 4}}, "N"),
              "samples a pixel");
  options.add("--shadows", on_off_value(d.shadows), "shadows of the sun");
  options.add("--strategy", std::move(strategy),
              "way of drawing; all but inline-queries give the same pictures (docs/STRATEGIES.md)");
  options.add(
      "--octree-n", whole_value(d.octree_n, 0U, 100000U),
      "objects a node of the octree holds, and draws a kept command buffer; 0: the smallest from 200 on "
      "that fits");
  options.add(
      "--node-form",
      choice_value<render::NodeForm>(d.node_form, {{"auto", render::NodeForm::automatic},
                                                   {"secondaries", render::NodeForm::secondaries},
                                                   {"indirect", render::NodeForm::indirect}}),
      "how the octree's commands are kept: command buffers, or indirect draws in device memory; auto: "
      "what costs less on the device");
  options.add("--octree-memory", whole_value(d.octree_mib, std::uint64_t{1}, std::uint64_t{1} << 20, "MIB"),
              "what --strategy octree may take; without room for it, inline is used");
  options.flag(
      "--late-visibility", d.late_visibility,
      "with --strategy queries-all, queries, hi-z or adaptive: believe earlier frames; what comes into "
      "view may appear frames too late");
  options.flag("--no-correction", d.no_correction,
               "adaptive: choose by the model alone, not corrected by what earlier frames took");
  options.add("--frames-in-flight", std::move(frames_in_flight),
              "frames at work at once; 1: processor and device one after the other");
  options.add(
      "--calibration", calibration_value(d.calibration),
      "what drawing costs here, for strategies that choose by it (docs/CALIBRATION.md); auto: as last "
      "measured for such pictures, else a quick measurement");
  options.add("--barriers", choice_value<bool>(d.full_barriers, {{"exact", false}, {"full", true}}),
              "full: a full barrier at every step, to look for missing ones");
}

Result<void> check_strategies(std::span<const std::string> strategies, bool show_nodes,
                              bool late_visibility) {
  const auto check = [&](const char* option, bool render::StrategyTraits::*trait,
                         const std::string& lacks) -> Result<void> {
    const bool any = std::any_of(strategies.begin(), strategies.end(), [&](const std::string& name) {
      return render::strategy_traits(name).*trait;
    });
    if (any) return {};
    std::vector<std::string> names(strategies.begin(), strategies.end());  // several forms of one: once
    std::sort(names.begin(), names.end());
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return fail(ErrorKind::usage, option,
                (names.size() > 1 ? "each of '" : "'") + join(names, "', '") + "' " + lacks +
                    "; allowed: " + join(render::strategies_that(trait), ", "));
  };
  if (show_nodes) {
    if (auto fits = check("--show-nodes", &render::StrategyTraits::keeps_nodes, "keeps no nodes"); !fits)
      return fits;
  }
  if (late_visibility)
    return check("--late-visibility", &render::StrategyTraits::can_be_late,
                 "draws the same with and without it");
  return {};
}

void add_device_options(Options& options, DrawingOptions& d, std::optional<Value> several) {
  options.group("Device");
  const char* help = several ? "Vulkan device; may be given several times" : "Vulkan device";
  options.add("--device", several ? std::move(*several) : text_value(d.device, "NAME|INDEX"), help, Role::run,
              "a discrete GPU, else any");
  options.flag("--list-devices", d.list_devices,
               "print the Vulkan devices there are");  // handled before parsing
  options.add("--validation", on_off_value(d.validation), "check every Vulkan call with the Khronos layer");
}

void print_warnings(const render::Renderer& renderer, std::size_t& known, bool quiet) {
  const std::vector<std::string> all = renderer.warnings();
  for (; known < all.size(); ++known) {
    if (!quiet) (void)std::fprintf(stderr, "warning: %s\n", printable(all[known]).c_str());
  }
}

Result<void> check_validation(render::Renderer& renderer) {
  const std::vector<std::string> messages = renderer.take_validation_messages();
  if (messages.empty()) return {};
  return fail(ErrorKind::no_device, "validation",
              std::to_string(messages.size()) + " messages, the first: " + messages.front());
}

Result<CameraMan> CameraMan::of_scene(const Scene& scene, const std::string& camera, glm::uvec2 size) {
  CameraMan man;
  man.aspect_ = aspect_of(size);
  if (camera == "auto" || (camera.empty() && scene.cameras.empty())) {
    man.framed_ = render::frame_boxes(object_bounds(scene), man.aspect_);
    return man;
  }
  auto id = camera.empty() ? Result<CameraId>(CameraId(0)) : find_camera(scene, camera);
  if (!id) return forward_error(id);
  man.id_ = *id;
  man.camera_ = scene.cameras[id->value];
  return man;
}

Result<CameraMan> CameraMan::of_path(const std::string& wanted, const Scene& scene, glm::uvec2 size) {
  auto path = camera_path_of(wanted, scene);
  if (!path) return forward_error(path);
  CameraMan man;
  man.aspect_ = aspect_of(size);
  man.path_ = std::move(*path);
  return man;
}

double CameraMan::played_s(double duration_s) const {
  if (duration_s > 0 || !path_) return duration_s;
  return std::max(0.0, path_->keys.back().time_s);
}

render::View CameraMan::view(const timeline::Player& player, double time_s) const {
  if (path_) return path_->view(time_s - begin_s_, aspect_);
  if (camera_) return render::view_of_camera(*camera_, player.world_from_camera(id_), aspect_);
  return framed_;
}

}  // namespace scenegen::tools
