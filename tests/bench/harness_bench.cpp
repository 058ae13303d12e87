// What measuring costs: sceneplay bench's loop beside a bare one (seek, view, submit, finish), on the same
// scene, in turns. Pictures are tiny, so that what is measured round a frame shows; the processor's time of
// this thread alone counts, as machines are shared. Prints microseconds a frame, and what the timers inside
// the renderer add, which cannot be taken out.
//   bench_harness [DEVICE]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "gen/generate.h"
#include "render/stage_timer.h"
#include "timeline/appearance.h"
#include "tools/bench_case.h"
#include "tools/bench_results.h"

using namespace scenegen;
using namespace scenegen::tools;

namespace {

constexpr std::size_t kFrames = 500;
constexpr int kTurns = 9;

double thread_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// As short as a program that plays a scene can be.
void bare(render::Renderer& renderer, timeline::Player& player, const CameraMan& camera,
          const std::vector<double>& moments) {
  render::FrameResult result;
  for (const double time_s : moments) {
    if (renderer.in_flight() == renderer.most_in_flight() && !renderer.finish(result)) std::abort();
    const timeline::ChangeSet& changes = player.seek(time_s);
    if (!renderer.submit(changes, player, camera.view(player, time_s))) std::abort();
  }
  while (renderer.in_flight() > 0) {
    if (!renderer.finish(result)) std::abort();
  }
}

double timer_us() {
  double sum_ms = 0;
  constexpr int kMany = 1'000'000;
  const double begin = thread_s();
  for (int i = 0; i < kMany; ++i) const render::StageTimer timer(sum_ms);
  return (thread_s() - begin) / kMany * 1e6 + 0 * sum_ms;
}

}  // namespace

int main(int argc, char** argv) {
  auto made = gen::generate_test_set(44, 1);  // 32 boxes: a frame takes next to nothing
  if (!made) return 1;
  timeline::AppearanceOptions appearance;
  appearance.coherence = 1;
  if (!timeline::assign_appearance(made->scene, appearance, made->exempt)) return 1;
  const Scene& scene = made->scene;
  render::RendererOptions options;
  options.device.wanted = argc > 1 ? argv[1] : "";
  options.size = {32, 18};
  options.samples = 1;
  options.shadows = false;
  options.outputs.readback = false;
  auto device = render::share_device(options.device);
  if (!device) {
    std::fprintf(stderr, "%s\n", device.error().str().c_str());
    return 1;
  }
  options.shared_device = *device;
  auto camera = CameraMan::of_path("orbit", scene, options.size);
  if (!camera) return 1;
  std::vector<double> moments;
  for (std::size_t i = 0; i < kFrames; ++i)
    moments.push_back(static_cast<double>(scene.duration_s) * static_cast<double>(i) / (kFrames - 1));

  const auto compiled = timeline::compile(scene);
  timeline::Player player(compiled);
  auto renderer = render::Renderer::create(scene, player, options);
  if (!renderer) return 1;
  BenchSeat seat(scene, compiled, *camera, options);
  std::vector<double> bare_us, bench_us, frame_ms;
  for (int turn = -1; turn < kTurns; ++turn) {  // the first one makes what is made once
    const double begin = thread_s();
    bare(*renderer, player, *camera, moments);
    const double between = thread_s();
    auto run = seat.run(moments, 1, [](std::size_t, std::size_t) {});
    const double end = thread_s();
    if (!run || turn < 0) continue;
    bare_us.push_back((between - begin) * 1e6 / kFrames);
    // Warm-up, and frames that keep the processor busy at the end, are drawn as well.
    bench_us.push_back((end - between) * 1e6 /
                       static_cast<double>(kFrames + 1 + renderer->most_in_flight() - 1));
    frame_ms.push_back(summarize(run->frame_ms).median);
  }
  const double bare_median = summarize(bare_us).median;
  const double harness_us = summarize(bench_us).median - bare_median;
  const double timers_us = 16 * timer_us();
  const double frame_us = 1e3 * summarize(frame_ms).median;
  std::printf("bare loop             %8.2f us of this thread a frame\n", bare_median);
  std::printf("sceneplay bench       %8.2f us more (%.2f %% of a frame of %.0f us)\n", harness_us,
              100 * harness_us / frame_us, frame_us);
  std::printf("16 timers in renderer %8.2f us (%.2f %%)\n", timers_us, 100 * timers_us / frame_us);
  return 0;
}
