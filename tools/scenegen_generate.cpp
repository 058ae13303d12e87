// scenegen [options]: parameters -> scene -> appearance times -> file.
#include <algorithm>
#include <cstdio>

#include "gen/generate.h"
#include "scene/gltf/write.h"
#include "timeline/appearance.h"
#include "timeline/statistics.h"
#include "tools/memory.h"
#include "tools/output.h"
#include "tools/scenegen.h"
#include "tools/scenegen_options.h"
#include "tools/verb.h"

namespace scenegen::tools {

namespace {

/// What was made, or would be.
struct Made {
  gen::Prediction counts;
  gltf::WriteReport file;
  std::optional<AppearanceInfo> appearance;
  std::vector<std::string> notes;
  std::vector<gltf::OutputFile> files;  ///< complete, not yet in their places
  double seconds = 0;
};

Result<void> check(const GenerateRequest& r, const Options& options) {
  if (auto allowed = options.refuse(conflicts(r)); !allowed) return allowed;
  if (!r.dry_run) {
    if (auto writable = check_scene_output(r.output); !writable) return writable;
  }
  if (auto apart = check_distinct_files(
          {{"--output", r.dry_run ? "" : r.output}, {"--report", r.report}},
          {{"--building-model", r.town.building_model}, {"--extra-model", r.town.extra_model}});
      !apart)
    return apart;
  if (r.report.empty() || r.report == "-") return {};
  return check_output_file(r.report);
}

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

Result<Made> make(const GenerateRequest& r, const std::vector<std::string>& arguments) {
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

double objects_per_group(const Made& made) {
  return made.file.instance_groups == 0 ? 0
                                        : static_cast<double>(made.file.instanced_objects) /
                                              static_cast<double>(made.file.instance_groups);
}

std::uint64_t moments(const Made& made) {
  return made.appearance ? made.appearance->moments : 0;
}

/// "scene.glb  5.1 MB  38 016 objects  4 096 moments  coherence 0.951  locality 13.3  seed 1  0.21 s"
std::string finished_line(const GenerateRequest& r, const Made& made) {
  std::string line = (r.output == "-" ? "stdout" : r.output) + (r.dry_run ? "  (not written)  " : "  ") +
                     human_bytes(made.file.bytes) + "  " + counted(made.counts.objects, "object");
  if (r.dry_run) {
    line += "  " + counted(made.counts.vertices, "vertex", "vertices") + "  " +
            counted(made.counts.triangles, "triangle");
  }
  line += "  " + counted(moments(made), "moment");
  if (made.appearance) {
    line += "  coherence " + human_real(made.appearance->coherence_measured, 3) + "  locality " +
            human_real(made.appearance->locality_cells, 1);
  }
  line += "  seed " + std::to_string(r.seed) + "  " + human_seconds(made.seconds) + "\n";
  if (made.file.instance_groups > 0) {
    line += layout_name(made.file.layout) + ": " + counted(made.file.instance_groups, "group") + ", " +
            human_real(objects_per_group(made), 1) + " objects per group, " +
            counted(made.file.single_object_groups, "object") + " alone\n";
  }
  return line;
}

Report report(const GenerateRequest& r, const Made& made, const std::vector<std::string>& arguments) {
  Report out("scenegen/report", 1);
  const auto add = [&out](std::string key, nlohmann::ordered_json value) {
    out.add({std::move(key), {}, std::move(value), {}});
  };
  add("command", "generate");
  add("dryRun", r.dry_run);
  add("output", r.output);
  add("objects", made.counts.objects);
  add("vertices", made.counts.vertices);
  add("triangles", made.counts.triangles);
  add("moments", moments(made));
  add("bytes", made.file.bytes);
  add("jsonBytes", made.file.json_bytes);
  add("seed", r.seed);
  if (made.appearance) {
    add("profile", timeline::name(r.profile.profile));
    add("coherence", made.appearance->coherence_measured);
    add("coherenceGiven", made.appearance->coherence_given);
    add("displaced", made.appearance->displaced_objects);
    add("timed", made.appearance->timed_objects);
    add("locality", made.appearance->locality_cells);
  }
  add("layout", layout_name(made.file.layout));
  add("visibility", visibility_name(r.file.visibility));
  add("nodes", made.file.nodes);
  add("channels", made.file.channels);
  add("samplers", made.file.samplers);
  add("accessors", made.file.accessors);
  add("draws", made.file.draws);
  if (made.file.layout == gltf::Layout::instances || made.file.layout == gltf::Layout::merged) {
    add("groups", made.file.instance_groups);
    add("objectsPerGroup", objects_per_group(made));
    add("singleObjectGroups", made.file.single_object_groups);
  }
  if (r.file.draco.on) {
    add("dracoGeometries", made.file.draco_geometries);
    add("dracoBytes", made.file.draco_bytes);
    add("dracoLeft", made.file.draco_left);
  }
  add("arguments", arguments);
  add("notes", made.notes);
  add("seconds", made.seconds);
  return out;
}

Result<int> work(GenerateRequest& r, const std::vector<std::string>& arguments) {
  settle(r);
  auto made = make(r, arguments);
  if (!made) return forward_error(made);
  const Report facts = report(r, *made, arguments);
  auto said = say({.facts = facts,
                   .notes = made->notes,
                   .text = finished_line(r, *made),
                   .report = r.report,
                   .files = &made->files,
                   .format = r.format,
                   .quiet = r.quiet,
                   .stdout_taken = r.report == "-" || (r.output == "-" && !r.dry_run)});
  return said ? Result<int>(0) : forward_error(said);
}

}  // namespace

std::string generate_short_help() {
  return "scenegen " SCENEGEN_VERSION
         ": makes a town of brick buildings that goes up along a space-filling curve, as glTF.\n"
         "\n"
         "  scenegen --grid 4x4 --curve hilbert --coherence 0.95 -o town.glb   generate a town of 16 "
         "buildings\n"
         "  scenegen animate model.fbx -o model.glb                            give a static model a "
         "timeline\n"
         "  scenegen schedule house.ifc plan.csv -o house.glb                  build a model by a Gantt "
         "plan\n"
         "  scenegen inspect town.glb                                          what is in a file\n"
         "  scenegen diff a.glb b.glb                                          are two files the same "
         "scene?\n"
         "  scenegen optimize town.glb -o small.glb                            the same scene in a smaller "
         "file\n"
         "  sceneplay frames town.glb -o pictures                              see it\n"
         "\n"
         "scenegen --help lists every option with its default and range.\n";
}

int generate_verb(std::span<const std::string> arguments) {
  GenerateRequest request;
  Options options = generate_options(request);
  return run_verb(options, arguments,
                  {.check = [&] { return check(request, options); },
                   .dump_config = &request.dump_config,
                   .conflicts = [&] { return conflicts(request); },
                   .work = [&] { return work(request, options.canonical_arguments()); }});
}

}  // namespace scenegen::tools
