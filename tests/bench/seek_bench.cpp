// What a seek in test set 32 takes the processor before anything is drawn: the timeline, the scene, and the
// octree that follows it. From nothing to everything and back, and to times in any order; CPU times of one
// thread, the aim of each is 20 ms. Run the release build.
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "gen/generate.h"
#include "render/draw_scene.h"
#include "render/gpu_scene.h"
#include "render/spatial/scene_octree.h"
#include "scene/random.h"
#include "timeline/appearance.h"
#include "timeline/player.h"

namespace scenegen::render {
namespace {

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

struct Seek {
  double timeline_ms = 0, scene_ms = 0, tree_ms = 0;
  std::size_t changes = 0;
  [[nodiscard]] double all_ms() const { return timeline_ms + scene_ms + tree_ms; }
};

struct Stage {
  timeline::Player player;
  DrawScene scene;
  SceneOctree tree;

  Stage(const Scene& source, const std::shared_ptr<const timeline::Timeline>& timeline,
        std::uint32_t per_node)
      : player(timeline), scene(source, player, texture_sets(source).of_material), tree(scene, per_node) {}

  Seek seek(double time_s) {
    Seek out;
    double at = cpu_ms();
    const auto lap = [&] {
      const double before = at;
      at = cpu_ms();
      return at - before;
    };
    const timeline::ChangeSet& changes = player.seek(time_s);
    out.timeline_ms = lap();
    scene.apply(changes, player);
    out.scene_ms = lap();
    tree.update(changes);
    out.tree_ms = lap();
    out.changes = changes.count();
    return out;
  }
};

void print(const std::string& what, const Seek& seek, std::size_t visible) {
  std::printf("  %-34s %7zu %7zu  %8.2f %8.2f %8.2f %8.2f\n", what.c_str(), seek.changes, visible,
              seek.timeline_ms, seek.scene_ms, seek.tree_ms, seek.all_ms());
}

void measure(double coherence, std::uint32_t per_node) {
  auto made = gen::generate_test_set(32, 1);
  if (!made) return;
  timeline::AppearanceOptions appearance;
  appearance.cells = {32, 32, 32};
  appearance.coherence = coherence;
  if (!timeline::assign_appearance(made->scene, appearance, made->exempt)) return;
  const auto compiled = timeline::compile(made->scene);
  const auto end_s = static_cast<double>(made->scene.duration_s);
  std::printf("C = %g, %u objects a node         changes visible  timeline    scene   octree      all, ms\n",
              coherence, per_node);
  Seek there;  // the best of three: others use the machine too
  Seek back;
  std::size_t visible[2] = {};
  for (int i = 0; i < 3; ++i) {
    Stage stage(made->scene, compiled, per_node);
    (void)stage.seek(0);
    const Seek a = stage.seek(end_s);
    visible[0] = stage.scene.visible_object_count();
    const Seek b = stage.seek(0);
    visible[1] = stage.scene.visible_object_count();
    if (i == 0 || a.all_ms() < there.all_ms()) there = a;
    if (i == 0 || b.all_ms() < back.all_ms()) back = b;
  }
  print("from the start to the end", there, visible[0]);
  print("and back", back, visible[1]);
  Stage stage(made->scene, compiled, per_node);
  const Random random(1, "seek bench");
  std::vector<Seek> any;
  for (std::uint64_t i = 0; i < 40; ++i)
    any.push_back(stage.seek(end_s * static_cast<double>(random.unit(i))));
  std::sort(any.begin(), any.end(), [](const Seek& a, const Seek& b) { return a.all_ms() < b.all_ms(); });
  print("to any time: median", any[any.size() / 2], 0);
  print("to any time: the longest of 40", any.back(), 0);
  Seek sum;
  constexpr int kFrames = 256;
  (void)stage.seek(0.5 * end_s);
  for (int i = 1; i <= kFrames; ++i) {  // one moment of 1024 a frame
    const Seek one = stage.seek(end_s * (0.5 + i / 1024.0));
    sum.timeline_ms += one.timeline_ms / kFrames;
    sum.scene_ms += one.scene_ms / kFrames;
    sum.tree_ms += one.tree_ms / kFrames;
    sum.changes += one.changes;
  }
  sum.changes /= kFrames;
  print("a frame of 1024, mean", sum, 0);
}

}  // namespace
}  // namespace scenegen::render

int main() {
  for (const double coherence : {0.0, 1.0}) {
    for (const std::uint32_t per_node : {200U, 500U}) scenegen::render::measure(coherence, per_node);
  }
}
