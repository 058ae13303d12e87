// scenegen schedule at scale: 10 000 tasks and 100 000 objects, stage by stage, beside what a plain read and
// write of the same model costs in the same run. CPU seconds; the aim is 5 s.
#include <sys/resource.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "scene/gltf/patch.h"
#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "tests/support/synthetic_scene.h"
#include "timeline/schedule/mapping.h"

namespace {

using namespace scenegen;

double cpu_s() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

double total_s = 0;

template <class F>
auto stage(const char* what, const F& f) {
  const double before_s = cpu_s();
  auto result = f();
  const double took_s = cpu_s() - before_s;
  total_s += took_s;
  std::printf("%-44s %8.2f\n", what, took_s);
  if (!result) std::printf("  %s\n", result.error().str().c_str());
  return result;
}

/// Ten objects a task: a third by name, a third by patterns, a third by regular expressions; every task waits
/// for two.
std::string plan_text(const Scene& scene, std::size_t tasks) {
  std::string out = "id,name,start,duration,type,predecessors,objects\n";
  const std::size_t each = scene.objects.size() / tasks;
  for (std::size_t i = 0; i < tasks; ++i) {
    const std::string id = std::to_string(i);
    out += id + ",task " + id + (i < 2 ? ",2024-01-01" : ",") + ",1d,construct," +
           (i < 2 ? "" : std::to_string(i - 1) + "SS+1h;" + std::to_string(i - 2)) + ",\"";
    for (std::size_t k = i * each; k < (i + 1) * each; ++k) {
      const std::string name(scene.objects.names[k]);
      out += (k == i * each ? "" : ";") + (i % 3 == 0   ? name
                                           : i % 3 == 1 ? name + "*"
                                                        : "name~^" + name + "$");
    }
    out += "\"\n";
  }
  return out;
}

}  // namespace

int main() {
  constexpr std::uint32_t kObjects = 100'000;
  constexpr std::size_t kTasks = 10'000;
  const std::string model = "schedule_bench.glb", output = "schedule_bench_out.glb";
  Scene town = testing::town_scene(kObjects, 1);
  for (auto& track : town.objects.visibility) track = TrackId();
  town.tracks.clear();
  town.duration_s = 0;
  gltf::WriteOptions write_options;
  write_options.layout = gltf::Layout::nodes;
  if (const auto written = gltf::write(town, model, write_options); !written) {
    std::printf("%s\n", written.error().str().c_str());
    return 1;
  }
  const std::string csv = plan_text(town, kTasks);
  std::printf("%zu tasks, %u objects, plan of %.1f MB\n%-44s %8s\n", kTasks, kObjects,
              static_cast<double>(csv.size()) * 1e-6, "stage", "CPU s");

  const auto plain = stage("baseline: read and write the model", [&]() -> Result<gltf::WriteReport> {
    auto read = gltf::read(model);
    if (!read) return forward_error(read);
    return gltf::write(read->scene, output, write_options);
  });
  if (!plain) return 1;
  const double baseline_s = total_s;
  total_s = 0;
  auto plan = stage("read the plan", [&] { return timeline::parse_plan(csv, "plan.csv"); });
  auto read = stage("read the model", [&] { return gltf::read(model, {true, 1}); });
  if (!plan || !read) return 1;
  auto facts =
      stage("its nodes, names and extras", [&] { return ObjectFacts::make(read->scene, *read->source); });
  if (!facts) return 1;
  const auto mapping =
      stage("map tasks to objects", [&] { return timeline::map_tasks(*plan, read->scene, *facts); });
  if (!mapping) return 1;
  timeline::ActivityOptions options;
  const auto activities = stage("times along the curve", [&]() -> Result<timeline::Schedule> {
    return timeline::make_activities(*plan, *mapping, read->scene, options);
  });
  const auto profiled =
      stage("profiles", [&] { return timeline::apply_profiles(read->scene, activities->activities, {}); });
  if (!profiled) return 1;
  read->scene.info.calendar = activities->calendar;
  const auto written = stage("patch the document", [&] {
    gltf::PatchOptions patch;
    patch.material_copy_of = profiled->copy_of;
    return gltf::patch(*read->source, read->scene, output, patch);
  });
  if (!written) return 1;
  std::printf("%-44s %8.2f   aim 5; %.1f times the baseline; %zu of %u objects; %.1f MB\n", "all of it",
              total_s, total_s / baseline_s, activities->activities.size(), kObjects,
              static_cast<double>(written->bytes) * 1e-6);
  (void)std::remove(model.c_str());
  (void)std::remove(output.c_str());
  return 0;
}
