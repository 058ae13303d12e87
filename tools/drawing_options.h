// What the verbs of sceneplay that draw have in common: how it is drawn, and where it is seen from.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/camera_path.h"
#include "render/renderer.h"
#include "scene/scene.h"
#include "timeline/player.h"
#include "tools/cli.h"

namespace scenegen::tools {

struct DrawingOptions {
  glm::uvec2 size{1280, 720};
  std::uint32_t samples = 4;
  bool shadows = true;
  std::uint32_t octree_n = 0;
  std::uint64_t octree_mib = 1024;
  bool late_visibility = false;
  render::NodeForm node_form = render::NodeForm::automatic;
  bool no_correction = false;
  bool full_barriers = false;
  std::string calibration = "auto";  ///< for set_costs()
  std::string device;
  bool list_devices = false;
  bool validation = false;  ///< set by SCENEPLAY_VALIDATION=1 too

  DrawingOptions();
  /// Colour alone, with the default strategy and number of frames in flight.
  [[nodiscard]] render::RendererOptions renderer() const;
};

/// Group "Drawing". How --strategy and --frames-in-flight are read differs from verb to verb.
void add_drawing_options(Options& options, DrawingOptions& drawing, Value strategy, Value frames_in_flight);
/// Refuses --show-nodes and --late-visibility where none of these strategies knows what they mean.
[[nodiscard]] Result<void> check_strategies(std::span<const std::string> strategies, bool show_nodes,
                                            bool late_visibility);
/// Group "Device". `several`: how --device is read where it may be given several times.
void add_device_options(Options& options, DrawingOptions& drawing, std::optional<Value> several = {});

/// Prints those warnings of the renderer that are behind `known`, which counts them from then on.
void print_warnings(const render::Renderer& renderer, std::size_t& known, bool quiet);
/// An error when the validation layer reported something.
[[nodiscard]] Result<void> check_validation(render::Renderer& renderer);

/// Where each frame is seen from.
class CameraMan {
 public:
  /// A camera of the scene by name or index, "auto" (frames all of it), or "" (the first one, else auto).
  [[nodiscard]] static Result<CameraMan> of_scene(const Scene& scene, const std::string& camera,
                                                  glm::uvec2 size);
  /// As --camera-path names it: docs/CAMERA_PATH.md.
  [[nodiscard]] static Result<CameraMan> of_path(const std::string& wanted, const Scene& scene,
                                                 glm::uvec2 size);
  /// The path begins at this time of what is played; a camera of the scene knows no such thing.
  void begin_at(double time_s) { begin_s_ = time_s; }
  /// How long a scene with a timeline of `duration_s` is played: a still scene as long as the path moves.
  [[nodiscard]] double played_s(double duration_s) const;
  /// `time_s`: what the player was sent to; that of a still scene stays at 0.
  [[nodiscard]] render::View view(const timeline::Player& player, double time_s) const;
  [[nodiscard]] render::View view(const timeline::Player& player) const {
    return view(player, player.time_s());
  }

 private:
  float aspect_ = 1.0F;
  std::optional<render::CameraPath> path_;
  double begin_s_ = 0;
  std::optional<Camera> camera_;
  CameraId id_;
  render::View framed_;
};

}  // namespace scenegen::tools
