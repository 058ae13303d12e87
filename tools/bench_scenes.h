// What a benchmark draws: files, or scenes that it makes itself.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::tools {

struct BenchScene {
  std::string name;  ///< the file's as given, or that of the generated scene
  std::function<Result<Scene>()> load;
};

[[nodiscard]] BenchScene scene_of_file(const std::string& file);
/// Small scenes of several kinds for --quick, made by the generator from fixed seeds, no files needed. Their
/// SceneInfo::arguments are those with which scenegen makes the same scene.
[[nodiscard]] std::vector<BenchScene> quick_scenes();

/// Entry of "scenes" in bench.json (docs/BENCH_FORMAT.md). `bytes`: of the file; 0 for a generated scene.
[[nodiscard]] nlohmann::ordered_json scene_json(const std::string& name, const Scene& scene,
                                                std::uint64_t bytes, double load_ms);

}  // namespace scenegen::tools
