// One case of a benchmark: a scene, a camera, a way of drawing; and one run over its moments.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "render/renderer.h"
#include "scene/scene.h"
#include "timeline/player.h"
#include "tools/drawing_options.h"

namespace scenegen::tools {

/// An entry of --strategy: "queries-all:late:n=100".
struct BenchWay {
  std::string label;  ///< as given
  std::string strategy;
  bool late = false;
  std::optional<std::uint32_t> octree_n;
  std::optional<render::NodeForm> form;
};
/// Entries separated by commas. The error names the nearest strategy or modifier; its `where` is empty.
[[nodiscard]] Result<std::vector<BenchWay>> parse_ways(std::string_view text);

/// Results may be from other folders and machines: scenes and cameras are known by the last part of their
/// path.
[[nodiscard]] inline std::string base_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

struct BenchCase {
  std::string file;
  std::string device;  ///< its name
  std::string camera;  ///< a camera path, or a camera of the scene as --camera names it
  std::uint32_t frames_in_flight = 2;
  BenchWay way;

  /// Tells it from all other cases.
  [[nodiscard]] std::string key() const;
};

/// What one run over the moments measured.
struct BenchRun {
  std::uint64_t objects = 0;
  std::vector<double> frame_ms;                ///< from the end of the frame before to the end of this one
  std::vector<std::string> stages;             ///< names
  std::vector<std::vector<double>> stages_ms;  ///< by stage and frame; negative: not known
  std::vector<double> cpu_ms;                  ///< what the processor works for a frame
  /// Processor time of the whole process, all threads, over the frames that count, a frame; what a software
  /// device draws with is in it. None in runs that an earlier version kept.
  std::optional<double> process_cpu_ms;
  std::vector<std::uint64_t> counters;  ///< sums over the frames, in the order of counter_fields()
  std::uint64_t device_bytes = 0;
  std::optional<double> start_ms;  ///< from the scene in memory to the first frame; of a fresh renderer
  nlohmann::ordered_json memory;   ///< memory_json() after the last frame
  std::vector<std::string> warnings;

  [[nodiscard]] nlohmann::ordered_json json() const;
  /// None when it is not what json() makes.
  [[nodiscard]] static std::optional<BenchRun> from_json(const nlohmann::ordered_json& json);
};

/// Index of the moment that frame `frame` shows when the first is 0 and the path is walked to and fro: frames
/// before it and after the last one (warm-up; what keeps the processor busy while the last ones are finished)
/// change as much as those that are measured.
[[nodiscard]] std::size_t moment_of_frame(std::int64_t frame, std::size_t moments);

/// A renderer and a player of its own for one case; made when first run.
class BenchSeat {
 public:
  BenchSeat(const Scene& scene, std::shared_ptr<const timeline::Timeline> timeline, CameraMan camera,
            render::RendererOptions options)
      : scene_(scene),
        timeline_(std::move(timeline)),
        camera_(std::move(camera)),
        options_(std::move(options)) {}

  /// `on_frame` is told how many frames of how many are done.
  /// `trace`, if not null, gets a row a frame that counts.
  [[nodiscard]] Result<BenchRun> run(const std::vector<double>& moments, std::uint32_t warm_up,
                                     const std::function<void(std::size_t, std::size_t)>& on_frame,
                                     nlohmann::ordered_json* trace = nullptr);
  /// The next run gets a renderer that knows nothing of this one.
  void forget();

 private:
  struct Pass;
  Result<void> make();

  const Scene& scene_;
  std::shared_ptr<const timeline::Timeline> timeline_;
  CameraMan camera_;
  render::RendererOptions options_;
  std::optional<timeline::Player> player_;
  std::optional<render::Renderer> renderer_;
};

}  // namespace scenegen::tools
