// Timeline and player at a million objects beside what D 2.3's program does each frame, walking every
// object's curve. Prints CPU times of this thread as a table; run the release build.
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "scene/random.h"
#include "timeline/compare.h"
#include "timeline/player.h"
#include "timeline/timeline.h"

namespace scenegen::timeline {
namespace {

constexpr std::uint32_t kObjects = 1'000'000;
constexpr float kDuration_s = 41.96F;

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Scene empty_scene() {
  Scene s;
  s.duration_s = kDuration_s;
  s.geometries.resize(1);
  s.meshes = {{"box", {{GeometryId(0), {}}}}};
  s.objects.reserve(kObjects, std::size_t{kObjects} * 8);
  for (std::uint32_t i = 0; i < kObjects; ++i) {
    s.objects.add(std::to_string(i), MeshId(0), Transform{{static_cast<float>(i), 0, 0}});
  }
  return s;
}

/// `tracks` appearance tracks; each object names one at random, so that an event's objects lie all over
/// memory.
Scene appearing(std::uint32_t tracks) {
  Scene s = empty_scene();
  const Random random(1, "bench");
  for (std::uint32_t i = 0; i < tracks; ++i) {
    const float at = 0.01F + 40.96F * static_cast<float>(i) / static_cast<float>(tracks);
    s.add_track(Property::visibility, Interpolation::step, std::vector{0.0F, at, kDuration_s},
                std::vector{0.0F, 1.0F, 1.0F});
  }
  for (std::uint32_t i = 0; i < kObjects; ++i) {
    s.objects.visibility[i] =
        TrackId(tracks == kObjects ? (i * 7919ULL) % kObjects : random.below(i, tracks));
  }
  return s;
}

/// One frame an object, each gliding and turning in 1 % of the time, in order of index (neighbours in memory
/// one after another) or all over memory.
Scene moving(bool in_order) {
  Scene s = empty_scene();
  const float length = kDuration_s / 100;
  for (std::uint32_t i = 0; i < kObjects; ++i) {
    const float at =
        (kDuration_s - length) * static_cast<float>(in_order ? i : (i * 7919ULL) % kObjects) / kObjects;
    Frame f;
    f.name = "f" + std::to_string(i);
    s.frames.push_back(f);
    s.objects.frame[i] = FrameId(i);
    const std::vector<float> times{at, at + length};
    s.frame_tracks.push_back({FrameId(i), s.add_track(Property::translation, Interpolation::linear, times,
                                                      std::vector<float>{0, 0, 0, 1, 2, 3})});
    s.frame_tracks.push_back(
        {FrameId(i), s.add_track(Property::rotation, Interpolation::linear, times,
                                 std::vector<float>{0, 0, 0, 1, 0, 0.70710678F, 0, 0.70710678F})});
  }
  return s;
}

/// D 2.3: every frame, every object's curve.
class Walker {
 public:
  explicit Walker(const Scene& scene) : scene_(scene), visible_(scene.objects.size(), 0) {}

  std::size_t seek(double t) {
    changed_.clear();
    for (std::uint32_t o = 0; o < visible_.size(); ++o) {
      const TrackId id = scene_.objects.visibility[o];
      const auto times = scene_.times_s(id);
      std::size_t k = 0;
      while (k + 1 < times.size() && static_cast<double>(times[k + 1]) <= t) ++k;
      const auto now = static_cast<std::uint8_t>(scene_.values(id)[k] != 0.0F);
      if (now == visible_[o]) continue;
      visible_[o] = now;
      changed_.push_back(o);
    }
    return changed_.size();
  }

 private:
  const Scene& scene_;
  std::vector<std::uint8_t> visible_;
  std::vector<std::uint32_t> changed_;
};

struct Cost {
  double seconds = 0;
  std::uint64_t changed = 0;
  std::uint64_t steps = 0;
  [[nodiscard]] double ns_per_changed() const { return 1e9 * seconds / static_cast<double>(changed); }
  [[nodiscard]] double us_per_step() const { return 1e6 * seconds / static_cast<double>(steps); }
};

/// Steps of 1 % of 40.96 s from one end to the other; best of three runs.
template <class Seek>
Cost sweep(const Seek& seek, bool forwards) {
  Cost best;
  for (int run = 0; run < 3; ++run) {
    const auto at = [&](int i) { return 0.01 + 40.96 * (forwards ? i : 100 - i) / 100.0; };
    seek(at(0));
    Cost cost;
    const double begin = cpu_s();
    for (int i = 1; i <= 100; ++i) cost.changed += seek(at(i));
    cost.seconds = cpu_s() - begin;
    cost.steps = 100;
    if (run == 0 || cost.seconds < best.seconds) best = cost;
  }
  return best;
}

void print(const char* what, const Cost& cost, double peer_us_per_step) {
  std::printf("  %-34s %10.1f ns/changed %10.1f us/step", what, cost.ns_per_changed(), cost.us_per_step());
  if (peer_us_per_step > 0)
    std::printf("   %6.1fx faster than walking", peer_us_per_step / cost.us_per_step());
  std::printf("\n");
}

void bench(const char* title, const Scene& scene, bool with_walker) {
  double compile_s = 1e9;
  std::shared_ptr<const Timeline> timeline;
  for (int run = 0; run < 3; ++run) {
    timeline.reset();
    const double begin = cpu_s();
    timeline = compile(scene);
    compile_s = std::min(compile_s, cpu_s() - begin);
  }
  double begin = cpu_s();
  Player player(timeline);
  const double construct_s = cpu_s() - begin;
  std::printf("%s\n  %-34s %10.3f s\n  %-34s %10.3f s\n", title, "compile", compile_s, "construct a player",
              construct_s);

  double peer = 0;
  if (with_walker) {
    Walker walker(scene);
    const Cost cost = sweep([&](double t) { return walker.seek(t); }, true);
    print("walk every curve (D 2.3)", cost, 0);
    peer = cost.us_per_step();
  }
  const auto seek = [&](double t) { return player.seek(t).count(); };
  print("1 % steps forwards", sweep(seek, true), peer);
  print("1 % steps backwards", sweep(seek, false), peer);

  Cost far;
  const Random random(2, "seek");
  begin = cpu_s();
  for (std::uint64_t i = 0; i < 20; ++i)
    far.changed += player.seek(41.0 * static_cast<double>(random.unit(i))).count();
  far.seconds = cpu_s() - begin;
  far.steps = 20;
  print("random seeks", far, peer);
  if (!timeline->moving_objects().empty()) return;
  begin = cpu_s();
  for (int i = 0; i < 1000; ++i) player.seek(i % 2 == 0 ? 41.5 : 41.6);
  std::printf("  %-34s %10.3f us\n", "step that changes nothing", 1e3 * (cpu_s() - begin));
}

void bench_compare() {
  const Scene scene = appearing(4096);
  const double begin = cpu_s();
  const Comparison result = compare(scene, scene);
  std::printf("compare two scenes of 1 000 000 objects\n  %-34s %10.3f s  (%llu times, %s)\n", "4096 moments",
              cpu_s() - begin, static_cast<unsigned long long>(result.times_compared),
              result.equal() ? "equal" : "DIFFERENT");
}

}  // namespace
}  // namespace scenegen::timeline

/// Without an argument all parts, else those named by number.
int main(int argc, char** argv) {
  using namespace scenegen::timeline;
  const std::string parts = argc > 1 ? argv[1] : "12345";
  const auto wanted = [&](char part) { return parts.find(part) != std::string::npos; };
  if (wanted('1')) bench("1 000 000 objects appear, 4096 shared tracks", appearing(4096), true);
  if (wanted('2')) bench("1 000 000 objects appear, a track each", appearing(kObjects), true);
  if (wanted('3')) bench("1 000 000 objects glide and turn (LINEAR), in order of index", moving(true), false);
  if (wanted('4')) bench("1 000 000 objects glide and turn (LINEAR), in random order", moving(false), false);
  if (wanted('5')) bench_compare();
  return EXIT_SUCCESS;
}
