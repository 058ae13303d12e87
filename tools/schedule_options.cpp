#include "tools/schedule_options.h"

#include <filesystem>

#include "scene/limits.h"
#include "tools/scenegen_options.h"
#include "tools/source_model.h"
#include "tools/verb.h"

namespace scenegen::tools {

namespace {

using timeline::CurveKind;
using timeline::DateOrder;

/// The curve, or no stagger at all.
Value curve_value(timeline::ActivityOptions& target) {
  Value value = choice_value<CurveKind>(
      target.curve,
      {{"hilbert", CurveKind::hilbert}, {"morton", CurveKind::morton}, {"row-prime", CurveKind::row_prime}},
      "CURVE");
  value.range += ", none";
  value.parse = [&target](std::string_view text) -> Result<void> {
    const std::vector<std::string> words{"hilbert", "morton", "row-prime", "none"};
    target.stagger = text != "none";
    if (!target.stagger) return {};
    auto curve = timeline::parse_curve(text);
    if (!curve) return fail(ErrorKind::usage, "", unknown_word("value", text, words));
    target.curve = *curve;
    return {};
  };
  value.spell = [&target] { return target.stagger ? std::string(name(target.curve)) : std::string("none"); };
  return value;
}

void add_plan_options(Options& options, ScheduleRequest& r) {
  options.group("Plan");
  options.add("--date-order",
              choice_value<DateOrder>(
                  r.plan_options.date_order,
                  {{"dmy", DateOrder::day_month_year}, {"mdy", DateOrder::month_day_year}}, "ORDER"),
              "whether 3/4/2024 is the 3rd of April or the 4th of March", Role::content,
              "dates that may be either are an error");
  options.add("--default-type",
              choice_value<timeline::Profile>(r.plan_options.default_profile, profile_choices(), "NAME"),
              "type of tasks that do not say theirs", Role::content);
  options.flag("--summary-tasks", r.summary_tasks, "summary tasks may have objects of their own",
               Role::content);
  options.group("Objects of tasks");
  options.add("--task-key", text_value(r.task_key, "KEY"),
              "member of an object's extras that names its task by id or name, for tasks that say no objects",
              Role::content);
  options.add(
      "--unmatched",
      choice_value<Unmatched>(
          r.unmatched, {{"show", Unmatched::show}, {"hide", Unmatched::hide}, {"error", Unmatched::error}},
          "WORD"),
      "what becomes of objects that no task is about", Role::content);
  options.add("--save-mapping", text_value(r.save_mapping, "FILE"),
              "also write which task is about which objects, as JSON", Role::run, "none");
  options.add("--mapping", text_value(r.mapping, "FILE"),
              "take the objects of tasks from such a file, made with an older model; what is not there any "
              "more is said",
              Role::content, "none");
}

void add_time_options(Options& options, ScheduleRequest& r) {
  timeline::ActivityOptions& a = r.activities;
  options.group("Time");
  options.add("--seconds-per-day", real_value(a.seconds_per_day, 1e-6, 1e6, "S"),
              "seconds on the timeline that a day of the plan takes", Role::content);
  options.add("--curve", curve_value(a),
              "curve along which the objects of one task follow each other; none: all at once",
              Role::content);
  options.add("--cells", size3_value(a.cells, glm::uvec3(1), glm::uvec3(limits::kMaxCellsPerAxis), "XxYxZ"),
              "cells of the curve over the model; objects of one cell follow in the file's order",
              Role::content);
  options.add("--order", order_value(a.order),
              "axes from the fastest to the slowest, with directions; z is up", Role::content);
  options.add("--share", real_value(a.share, 0, 1, "X"),
              "part of a task's time that is spent on each object; they overlap where there are many",
              Role::content);
  options.add("--steps", whole_value<std::uint32_t>(a.steps, 1, 1'000'000),
              "most different times within a task", Role::content);
  options.add("--hold", real_value(r.hold_s, 0, 1e6, "S"), "seconds after the last task", Role::content);
}

}  // namespace

Options schedule_options(ScheduleRequest& r) {
  Options options("scenegen schedule", {"scenegen schedule MODEL PLAN -o OUT [options]"},
                  "builds a model by a Gantt plan: tasks let their objects appear, be demolished, move or be "
                  "worked at, in "
                  "colors that show it. MODEL is glTF, or what Assimp reads (IFC, FBX, OBJ and others); PLAN "
                  "is CSV or MS "
                  "Project XML (docs/SCHEDULES.md). What the model holds stays as it is; nodes and one "
                  "animation are added.");
  options.positional("MODEL", r.model, "a .glb or .gltf file, or a model of another format");
  options.positional("PLAN", r.plan, "a .csv file or the .xml of MS Project (- is stdin)");
  add_plan_options(options, r);
  add_time_options(options, r);
  add_profile_options(options, r.profile, ProfileSource::plan);
  options.group("Model");
  add_import_options(options, r.import);
  options.group("Output");
  options.add("-o,--output",
              text_value(r.output, "FILE", ".glb, .gltf with its .bin, - for a .glb on stdout"),
              "the file to write", Role::run, "none, it must be given");
  add_visibility_option(options, r.visibility);
  options.add("--format", format_value(r.format), "form of what is printed on stdout");
  options.add("--report", text_value(r.report, "FILE"),
              "also write the whole mapping, and what it left open, as JSON", Role::run, "none");
  options.flag("--dry-run", r.dry_run, "print which task is about which objects, and write no model");
  options.group("General");
  options.add("--threads", whole_value<std::uint32_t>(r.threads, 0, limits::kMaxThreads),
              "0: one per processor; never changes the file");
  options.add_config(r.dump_config);
  options.add_general(r.quiet);
  return options;
}

std::vector<Conflict> schedule_conflicts(const ScheduleRequest& r) {
  std::vector<Conflict> out;
  add_import_conflicts(r.model, out);
  if (!r.activities.stagger) {
    for (const char* name : {"--cells", "--order", "--share", "--steps"})
      out.push_back({name, "cannot be used with --curve none, which lets objects of a task go together"});
  }
  add_stdout_conflicts(r.dry_run ? "" : r.output, r.report, out);
  if (r.save_mapping == "-")
    out.push_back({"--format", "cannot be used with --save-mapping -, which puts the mapping on stdout"});
  return out;
}

Result<void> check_schedule(const ScheduleRequest& r, const Options& options) {
  if (auto allowed = options.refuse(schedule_conflicts(r)); !allowed) return allowed;
  if (r.model == "-" && r.plan == "-") return fail(ErrorKind::usage, "PLAN", "stdin is the model already");
  const std::uint64_t cells =
      std::uint64_t{r.activities.cells.x} * r.activities.cells.y * r.activities.cells.z;
  if (cells > limits::kMaxCells) {
    return fail(ErrorKind::usage, "--cells",
                std::to_string(cells) + " cells; at most " + std::to_string(limits::kMaxCells));
  }
  if (!r.dry_run && !r.dump_config) {
    if (r.output.empty()) {
      const std::string stem = std::filesystem::path(r.model).stem().string();
      return fail(ErrorKind::usage, "--output",
                  "is missing: say which file to write (-o " +
                      (r.model == "-" ? "out" : stem + "_scheduled") + ".glb)");
    }
    if (auto writable = check_scene_output(r.output); !writable) return writable;
  }
  // The model itself may be replaced, and a mapping brought up to date: they are read before that.
  const std::string output = r.dry_run ? "" : r.output;
  if (auto apart = check_distinct_files(
          {{"--output", output}, {"--report", r.report}, {"--save-mapping", r.save_mapping}},
          {{"PLAN", r.plan}});
      !apart)
    return apart;
  if (auto apart = check_distinct_files({{"--report", r.report}, {"--save-mapping", r.save_mapping}},
                                        {{"MODEL", r.model}});
      !apart)
    return apart;
  for (const NamedPath& file : {NamedPath{"--output", output}, NamedPath{"--report", r.report}}) {
    if (auto apart = check_distinct_files({file}, {{"--mapping", r.mapping}}); !apart) return apart;
  }
  for (const std::string& path : {r.report, r.save_mapping}) {
    if (path.empty() || path == "-") continue;
    if (auto writable = check_output_file(path); !writable) return writable;
  }
  return {};
}

}  // namespace scenegen::tools
