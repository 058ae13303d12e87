#include "tools/make_scene.h"

#include "timeline/statistics.h"
#include "tools/memory.h"
#include "tools/output.h"

namespace scenegen::tools {

namespace {

/// Refuses what would not fit: the kernel would end the process half way.
Result<void> check_memory(std::uint64_t objects) {
  constexpr std::uint64_t kBytesPerObject = 250;  // scene, times, grouping while writing (docs/BENCHMARKS.md)
  const auto available = available_memory();
  const std::uint64_t needed = objects * kBytesPerObject;
  if (!available || needed <= *available) return {};
  return fail(ErrorKind::bad_input, "",
              human_count(objects) + " objects need about " + human_bytes(needed) + " of memory, " +
                  human_bytes(*available) + " are free");
}

Result<gen::Prediction> predict(const GenerateRequest& r) {
  return r.test_set != 0 ? gen::predict_test_set(static_cast<int>(r.test_set)) : gen::predict_town(r.town);
}

Result<gen::Generated> generate(const GenerateRequest& r) {
  if (r.test_set == 0) return gen::generate_town(r.town);
  return gen::generate_test_set(static_cast<int>(r.test_set), r.seed);
}

}  // namespace

Result<Made> make_scene(const GenerateRequest& r, const std::vector<std::string>& arguments) {
  const Stopwatch stopwatch;
  auto predicted = predict(r);
  if (!predicted) return forward_error(predicted);
  if (auto fits = check_memory(predicted->objects); !fits) return forward_error(fits);

  constexpr std::uint64_t kLongWork = 300'000;  // objects; about a third of a second
  Progress progress("", 0, r.quiet || predicted->objects < kLongWork);
  progress.stage("laying " + counted(predicted->objects, "object"));
  auto generated = generate(r);
  if (!generated) return forward_error(generated);
  Scene& scene = generated->scene;

  Made made;
  made.counts = *predicted;
  made.notes = std::move(generated->notes);
  scene.info.generator = "scenegen " SCENEGEN_VERSION;
  scene.info.seed = r.seed;
  scene.info.arguments = arguments;
  if (r.curve) {
    progress.stage("giving times");
    auto appearance = timeline::assign_appearance(scene, r.appearance, generated->exempt);
    if (!appearance) return forward_error(appearance);
    made.appearance = *appearance;
    if (r.profile.profile != timeline::Profile::appear) {
      const auto activities = timeline::activities_of_appearance(scene, curve_activities(r.profile));
      auto profiled = timeline::apply_curve_profiles(scene, activities, r.profile.options);
      if (!profiled) return forward_error(profiled);
    }
    gen::drive_machines(scene, generated->machines, r.appearance.threads);
  }
  progress.stage(r.dry_run ? "measuring" : "writing " + r.output);
  gltf::WriteOptions options = r.file;
  options.later = &made.files;
  auto file = r.dry_run ? gltf::predict(scene, r.output, options) : gltf::write(scene, r.output, options);
  if (!file) return forward_error(file);
  made.file = std::move(*file);
  made.notes.insert(made.notes.end(), made.file.notes.begin(), made.file.notes.end());
  if (!r.dry_run && (r.format != Format::table || !r.report.empty())) {
    const timeline::Statistics counted = timeline::statistics(scene, r.appearance.threads);
    made.counts = {counted.objects, counted.vertices, counted.triangles};
  }
  made.seconds = stopwatch.seconds();
  return made;
}

}  // namespace scenegen::tools
