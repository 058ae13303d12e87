// Profiles at a million objects over 4096 moments: CPU time of apply_profiles and what it adds to the scene,
// in bytes. The peer is the plain form: tracks, frame and mesh track of its own for every object.
#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "timeline/appearance.h"
#include "timeline/profiles.h"

namespace scenegen::timeline {
namespace {

constexpr std::uint32_t kObjects = 1'000'000;
constexpr std::uint32_t kMeshes = 14;  // as many as a brick town has

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// A cube of a hundred objects each way, of some meshes, in order along no curve.
Scene cube() {
  Scene s;
  s.geometries.resize(1);
  s.geometries[0].positions_m = {{-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F}, {0, 0.5F, 0}};
  for (std::uint32_t m = 0; m < kMeshes; ++m) {
    s.materials.emplace_back().name = "material_" + std::to_string(m);
    s.meshes.push_back({"mesh_" + std::to_string(m), {{GeometryId(0), MaterialId(m)}}});
  }
  s.objects.reserve(kObjects, std::size_t{kObjects} * 8);
  for (std::uint32_t i = 0; i < kObjects; ++i) {
    const glm::uvec3 at(i % 100, i / 100 % 100, i / 10000);
    s.objects.add(std::to_string(i), MeshId(i * 7919ULL % kMeshes), Transform{glm::vec3(at)});
  }
  return s;
}

std::size_t bytes_of(const Scene& s) {
  return s.tracks.size() * sizeof(Track) + (s.track_times_s.size() + s.track_values.size()) * sizeof(float) +
         s.frames.size() * sizeof(Frame) + s.meshes.size() * sizeof(Mesh) +
         s.materials.size() * sizeof(Material) + s.frame_tracks.size() * sizeof(FrameTrack) +
         s.object_mesh_tracks.size() * sizeof(ObjectMeshTrack) +
         s.material_tracks.size() * sizeof(MaterialTrack);
}

/// The same without sharing: keys of visibility, look and way for each object.
std::size_t plain_bytes(const Scene& shared) {
  std::size_t bytes = 0;
  const auto add = [&](TrackId id) {
    bytes += sizeof(Track) + (shared.times_s(id).size() + shared.values(id).size()) * sizeof(float);
  };
  std::vector<TrackId> way(shared.frames.size());
  for (const FrameTrack& use : shared.frame_tracks) way[use.frame.value] = use.track;
  for (std::size_t i = 0; i < kObjects; ++i) {
    if (shared.objects.visibility[i].valid()) add(shared.objects.visibility[i]);
    const FrameId frame = shared.objects.frame[i];
    if (frame.valid()) bytes += sizeof(Frame) + sizeof(FrameTrack), add(way[frame.value]);
  }
  for (const ObjectMeshTrack& use : shared.object_mesh_tracks)
    bytes += sizeof(ObjectMeshTrack), add(use.track);
  return bytes;
}

void bench(Profile profile, ColorForm color, const Scene& timed) {
  Scene scene = timed;
  ProfileOptions options;
  options.color = color;
  double begin = cpu_s();
  const std::vector<Activity> activities = activities_of_appearance(scene, {profile, 0, {0, 3, 0}});
  const double activities_s = cpu_s() - begin;
  const std::size_t before = bytes_of(scene);
  begin = cpu_s();
  const auto result = apply_profiles(scene, activities, options);
  const double apply_s = cpu_s() - begin;
  if (!result) {
    (void)std::fprintf(stderr, "%s\n", result.error().str().c_str());
    std::exit(EXIT_FAILURE);
  }
  const auto added = static_cast<double>(bytes_of(scene) - before);
  const auto plain = static_cast<double>(plain_bytes(scene));
  std::printf("  %-10s %-8s %7.2f s %7.2f s %9.1f MB", std::string(name(profile)).c_str(),
              color == ColorForm::swap ? "swap" : "pointer", activities_s, apply_s, added * 1e-6);
  if (color == ColorForm::swap) std::printf(" %9.1f MB", plain * 1e-6);
  std::printf("%s %8zu %8zu %7zu\n", color == ColorForm::swap ? "" : "            ", scene.tracks.size(),
              scene.frames.size(), scene.meshes.size());
}

}  // namespace
}  // namespace scenegen::timeline

int main() {
  using namespace scenegen::timeline;
  scenegen::Scene scene = cube();
  if (!assign_appearance(scene, {})) return EXIT_FAILURE;
  std::printf("1 000 000 objects of %u meshes, 4096 moments; bytes added to the scene\n", kMeshes);
  std::printf("  %-10s %-8s %9s %9s %12s %12s %8s %8s %7s\n", "profile", "color", "activities", "apply",
              "added", "unshared", "tracks", "frames", "meshes");
  for (std::size_t i = 0; i < kProfileCount; ++i) bench(static_cast<Profile>(i), ColorForm::swap, scene);
  bench(Profile::construct, ColorForm::pointer, scene);
  return EXIT_SUCCESS;
}
