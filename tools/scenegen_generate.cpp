// scenegen [options]: parameters -> scene -> appearance times -> file.
#include "tools/make_scene.h"
#include "tools/output.h"
#include "tools/scenegen.h"
#include "tools/scenegen_options.h"
#include "tools/verb.h"

namespace scenegen::tools {

namespace {

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

double objects_per_group(const Made& made) {
  return made.file.instance_groups == 0 ? 0
                                        : static_cast<double>(made.file.instanced_objects) /
                                              static_cast<double>(made.file.instance_groups);
}

/// "scene.glb  5.1 MB  38 016 objects  4 096 moments  coherence 0.951  locality 13.3  seed 1  0.21 s"
std::string finished_line(const GenerateRequest& r, const Made& made) {
  std::string line = (r.output == "-" ? "stdout" : r.output) + (r.dry_run ? "  (not written)  " : "  ") +
                     human_bytes(made.file.bytes) + "  " + counted(made.counts.objects, "object");
  if (r.dry_run) {
    line += "  " + counted(made.counts.vertices, "vertex", "vertices") + "  " +
            counted(made.counts.triangles, "triangle");
  }
  line += "  " + counted(made.moments(), "moment");
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
  add("moments", made.moments());
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
  auto made = make_scene(r, arguments);
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
         "  scenegen sweep sweep.json -o scenes                                many scenes, all combinations "
         "of "
         "parameters\n"
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
