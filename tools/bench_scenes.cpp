#include "tools/bench_scenes.h"

#include <array>
#include <cmath>

#include "gen/generate.h"
#include "scene/gltf/read.h"
#include "timeline/appearance.h"
#include "tools/read_gltf.h"

namespace scenegen::tools {
namespace {

using nlohmann::ordered_json;

/// A town, or a test set.
struct QuickScene {
  std::string name;
  int test_set = 0;  ///< 0: a town
  glm::uvec2 grid{1, 1};
  double coherence = 1;
  std::vector<std::string> arguments;
};

std::vector<QuickScene> recipes() {
  const auto town = [](const char* name, const char* grid, glm::uvec2 size, const char* c, double coherence) {
    return QuickScene{name, 0, size, coherence, {"--grid", grid, "--curve", "hilbert", "--coherence", c}};
  };
  const auto set = [](const char* name, int number) {
    return QuickScene{name, number, {1, 1}, 1, {"--test-set", std::to_string(number), "--curve", "hilbert"}};
  };
  return {town("town, coherent", "2x2", {2, 2}, "0.95", 0.95), town("town, random", "2x2", {2, 2}, "0", 0),
          set("boxes (set 6)", 6), set("spheres (set 15)", 15), set("textures (set 48)", 48)};
}

Result<Scene> make(const QuickScene& q) {
  constexpr std::uint64_t kSeed = 1;
  gen::TownOptions town;
  town.grid = q.grid;
  town.seed = kSeed;
  auto generated = q.test_set == 0 ? gen::generate_town(town) : gen::generate_test_set(q.test_set, kSeed);
  if (!generated) return forward_error(generated);
  Scene& scene = generated->scene;
  scene.info.generator = "scenegen " SCENEGEN_VERSION;
  scene.info.seed = kSeed;
  scene.info.arguments = q.arguments;
  timeline::AppearanceOptions appearance;
  appearance.coherence = q.coherence;
  appearance.seed = kSeed;
  auto timed = timeline::assign_appearance(scene, appearance, generated->exempt);
  if (!timed) return forward_error(timed);
  return std::move(scene);
}

}  // namespace

BenchScene scene_of_file(const std::string& file) {
  return {file, [file]() -> Result<Scene> {
            auto read = read_gltf(file, {});
            if (!read) return forward_error(read);
            return std::move(read->scene);
          }};
}

std::vector<BenchScene> quick_scenes() {
  std::vector<BenchScene> out;
  for (const QuickScene& q : recipes()) out.push_back({q.name, [q] { return make(q); }});
  return out;
}

ordered_json scene_json(const std::string& name, const Scene& scene, std::uint64_t bytes, double load_ms) {
  ordered_json out{{"file", name}};
  if (bytes > 0) out["bytes"] = bytes;
  out["objects"] = scene.objects.size();
  out["durationS"] = scene.duration_s;
  out["generator"] = scene.info.generator;
  if (scene.info.seed) out["seed"] = *scene.info.seed;
  if (!scene.info.arguments.empty()) out["arguments"] = scene.info.arguments;
  if (scene.info.appearance) out["coherence"] = scene.info.appearance->coherence_measured;
  out["loadMs"] = std::round(load_ms * 1e3) / 1e3;
  return out;
}

}  // namespace scenegen::tools
