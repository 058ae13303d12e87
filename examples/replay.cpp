// Reads any glTF file and prints what changes while its timeline is played, one line a change.
//   replay FILE [STEP_S]
#include <cstdio>
#include <cstdlib>
#include <string>

#include "scene/gltf/read.h"
#include "timeline/player.h"

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: replay FILE [STEP_S]\n"), 2;
  const double step_s = argc > 2 ? std::atof(argv[2]) : 0.5;
  if (!(step_s > 0.0)) return std::fprintf(stderr, "error: STEP_S: must be above 0\n"), 2;

  const auto file = scenegen::gltf::read(argv[1]);
  if (!file) return std::fprintf(stderr, "error: %s\n", file.error().str().c_str()), 1;
  const scenegen::Scene& scene = file->scene;

  scenegen::timeline::Player player(scenegen::timeline::compile(scene));
  for (double time_s = 0.0; time_s <= static_cast<double>(scene.duration_s); time_s += step_s) {
    const scenegen::timeline::ChangeSet& changes = player.seek(time_s);
    for (const scenegen::ObjectId id : changes.shown) {
      std::printf("%7.3f s  + %s\n", time_s, std::string(scene.objects.names[id.value]).c_str());
    }
    for (const scenegen::ObjectId id : changes.hidden) {
      std::printf("%7.3f s  - %s\n", time_s, std::string(scene.objects.names[id.value]).c_str());
    }
    for (const scenegen::ObjectId id : changes.moved) {
      const glm::vec4 place_m = player.world_from_object(id)[3];
      std::printf("%7.3f s  > %s (%.3f, %.3f, %.3f) m\n", time_s,
                  std::string(scene.objects.names[id.value]).c_str(), static_cast<double>(place_m.x),
                  static_cast<double>(place_m.y), static_cast<double>(place_m.z));
    }
  }
  std::printf("%zu of %zu objects visible at the end\n", player.visible_count(), scene.objects.size());
  return 0;
}
