// Runs the cases of a benchmark: scenes x devices x cameras x frames in flight x ways of drawing x
// repetitions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/result.h"
#include "tools/bench_case.h"
#include "tools/bench_scenes.h"
#include "tools/drawing_options.h"

namespace scenegen::tools {

struct BenchRequest {
  std::vector<std::string> files;
  std::string folder, times, camera, trace;
  std::vector<std::string> camera_paths;
  std::vector<std::string> devices;  ///< as --device names them; none: the default one
  std::vector<BenchWay> ways{{"inline", "inline", false, {}, {}}, {"octree", "octree", false, {}, {}}};
  std::vector<std::uint32_t> frames_in_flight{2};
  std::uint32_t frames = 100, warm_up = 10, repeat = 5;
  DrawingOptions drawing;
  bool quick = false;
  bool keep_renderers = false;
  bool readback = false;
  bool resume = false;
  bool quiet = false;
  std::vector<std::string> arguments;

  /// Cameras to see every scene from.
  [[nodiscard]] std::vector<std::string> cameras() const {
    return camera_paths.empty() ? std::vector{camera} : camera_paths;
  }
  [[nodiscard]] std::vector<BenchScene> scenes() const;
};

/// What fails is noted in the results, and the rest goes on; the error is then the first failure. What can be
/// found out before anything is measured (a folder that cannot be made, no device at all) ends it at once.
[[nodiscard]] Result<void> run_bench(const BenchRequest& request);

}  // namespace scenegen::tools
