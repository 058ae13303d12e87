// scenegen schedule MODEL PLAN -o OUT: a model and a Gantt plan -> the model's own document, built by the
// plan.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <thread>

#include "scene/gltf/patch.h"
#include "scene/limits.h"
#include "scene/transform.h"
#include "timeline/calendar.h"
#include "timeline/schedule/mapping.h"
#include "timeline/statistics.h"
#include "tools/scenegen.h"
#include "tools/schedule_options.h"
#include "tools/source_model.h"
#include "tools/verb.h"

namespace scenegen::tools {

namespace {

using nlohmann::ordered_json;
using timeline::Mapping;
using timeline::Plan;
using timeline::Task;

/// What was made, or would be.
struct Scheduled {
  Plan plan;
  Mapping mapping;
  std::string saved_mapping;  ///< text of --save-mapping
  Calendar calendar;
  NameTable names;  ///< of the objects
  std::uint64_t moments = 0;
  float duration_s = 0;
  gltf::WriteReport file;
  std::vector<std::string> notes;
  std::vector<gltf::OutputFile> files;  ///< complete, not yet in their places
  double seconds = 0;
};

// ---- The way of the data

/// "3 objects without a task: 'a', 'b', 'c'"
template <class Items, class NameOf>
std::string listed(const std::string& one, const std::string& rest, const Items& items,
                   const NameOf& name_of) {
  constexpr std::size_t kMost = 5;
  std::string out = counted(items.size(), one) + rest + ": ";
  for (std::size_t i = 0; i < std::min(items.size(), kMost); ++i)
    out += (i == 0 ? "'" : ", '") + std::string(name_of(items[i])) + "'";
  return out + (items.size() > kMost ? ", ..." : "");
}

Result<void> map(const ScheduleRequest& r, const gltf::ReadResult& read, Scheduled& out) {
  auto facts = ObjectFacts::make(read.scene, *read.source);
  if (!facts) return forward_error(facts);
  timeline::MappingOptions options;
  options.summary_tasks = r.summary_tasks;
  options.task_key = r.task_key;
  std::optional<timeline::SavedMapping> saved;
  if (!r.mapping.empty()) {
    auto loaded = timeline::read_mapping(r.mapping);
    if (!loaded) return forward_error(loaded);
    saved = std::move(*loaded);
    options.saved = &*saved;
  }
  auto mapping = timeline::map_tasks(out.plan, read.scene, *facts, options);
  if (!mapping) return forward_error(mapping);
  out.mapping = std::move(*mapping);
  const auto& objects = out.mapping.objects_of_task;
  if (std::all_of(objects.begin(), objects.end(), [](const auto& list) { return list.empty(); })) {
    return fail(ErrorKind::bad_input, r.plan,
                "no task is about an object of the model (say which in columns 'objects' or 'selector'); the "
                "model has " +
                    listed("object", "", out.mapping.objects_without_tasks,
                           [&](ObjectId id) { return out.names[id.value]; }));
  }
  if (!r.save_mapping.empty())
    out.saved_mapping = timeline::write_mapping(out.plan, out.mapping, read.scene, *facts);
  return {};
}

Result<void> settle_unmatched(const ScheduleRequest& r, Scene& scene, const Mapping& mapping) {
  const std::vector<ObjectId>& rest = mapping.objects_without_tasks;
  if (rest.empty() || r.unmatched == Unmatched::show) return {};
  if (r.unmatched == Unmatched::error) {
    return fail(ErrorKind::bad_input, r.model,
                listed("object", " without a task (--unmatched show or hide lets them be)", rest,
                       [&](ObjectId id) { return scene.objects.names[id.value]; }));
  }
  const float never[] = {0.0F};
  const TrackId track = scene.add_track(Property::visibility, Interpolation::step, never, never);
  for (const ObjectId id : rest) scene.objects.visibility[id.value] = track;
  return {};
}

/// Says which tasks an object has that apply_profiles() finds contradictory: it knows no tasks.
Error with_tasks(Error error, const Scene& scene, const Plan& plan, const Mapping& mapping) {
  for (const Mapping::Shared& shared : mapping.claimed_twice) {
    if (error.where != "object '" + std::string(scene.objects.names[shared.object.value]) + "'") continue;
    error.what += "; its tasks:";
    for (const std::uint32_t task : shared.tasks)
      error.what += " '" + plan.tasks[task].id + "' (" + plan.tasks[task].where + ")";
  }
  error.kind = ErrorKind::bad_input;
  return error;
}

timeline::ActivityOptions activity_options(const ScheduleRequest& r) {
  timeline::ActivityOptions out = r.activities;
  out.move_offset_m = y_up_from_z_up(glm::vec3(r.profile.move_z_up_m));
  out.summary_tasks = r.summary_tasks;
  out.threads =
      r.threads != 0 ? r.threads : std::clamp(std::thread::hardware_concurrency(), 1U, limits::kMaxThreads);
  return out;
}

Result<Scheduled> schedule(const ScheduleRequest& r, const std::vector<std::string>& arguments) {
  const Stopwatch stopwatch;
  Scheduled out;
  Progress progress("", 0, r.quiet);
  auto plan = timeline::read_plan(r.plan, r.plan_options);  // first: it is small, and wrong more often
  if (!plan) return forward_error(plan);
  out.plan = std::move(*plan);
  progress.stage("reading " + r.model);
  auto model = read_source_model(r.model, r.import);
  if (!model) return forward_error(model);
  out.notes = std::move(model->notes);
  const gltf::SourceDocument& source = *model->read.source;
  Scene& scene = model->read.scene;
  out.names = scene.objects.names;
  progress.stage("mapping " + counted(out.plan.tasks.size(), "task") + " to " +
                 counted(scene.objects.size(), "object"));
  if (auto mapped = map(r, model->read, out); !mapped) return forward_error(mapped);
  timeline::Schedule times = timeline::make_activities(out.plan, out.mapping, scene, activity_options(r));
  auto profiled = timeline::apply_profiles(scene, times.activities, r.profile.options);
  if (!profiled)
    return tl::unexpected<Error>(with_tasks(std::move(profiled.error()), scene, out.plan, out.mapping));
  if (auto settled = settle_unmatched(r, scene, out.mapping); !settled) return forward_error(settled);
  scene.duration_s = std::max(scene.duration_s, static_cast<float>(times.end_s + r.hold_s));
  scene.info.arguments = arguments;
  scene.info.seed.reset();
  scene.info.appearance.reset();
  scene.info.calendar = times.calendar;
  out.calendar = std::move(times.calendar);
  out.duration_s = scene.duration_s;
  if (r.dry_run || r.format != Format::table || !r.report.empty())
    out.moments = timeline::statistics(scene, 1).moments;
  if (!r.save_mapping.empty()) {
    auto prepared = prepare_file(r.save_mapping, out.saved_mapping);
    if (!prepared) return forward_error(prepared);
    out.files.push_back(std::move(*prepared));
  }
  if (!r.dry_run) {
    progress.stage("writing " + r.output);
    gltf::PatchOptions options;
    options.visibility = r.visibility;
    options.material_copy_of = profiled->copy_of;
    options.later = &out.files;
    auto file = gltf::patch(source, scene, r.output, options);
    if (!file) return forward_error(file);
    out.file = std::move(*file);
    out.notes.insert(out.notes.end(), out.file.notes.begin(), out.file.notes.end());
  }
  out.seconds = stopwatch.seconds();
  return out;
}

// ---- What is said

std::uint64_t scheduled_objects(const Scheduled& made) {
  return made.names.size() - made.mapping.objects_without_tasks.size();
}

std::string first_date(const Scheduled& made) {
  return made.calendar.start.substr(0, 10);
}

/// As plans say it: the midnight at which a task ends is the day before, which it includes.
std::string finish_text(timeline::CivilSeconds start_s, timeline::CivilSeconds finish_s) {
  const std::string text = timeline::moment_text(finish_s);
  const bool whole_days = text.size() == 10 && finish_s > start_s;
  return whole_days ? timeline::moment_text(finish_s - 1).substr(0, 10) : text;
}

std::string last_date(const Scheduled& made) {
  std::string last;
  for (const CalendarTask& task : made.calendar.tasks) {
    const std::string finish = timeline::date_at(made.calendar, task.finish_s);
    // Half a day back from midnight is the day before.
    const bool whole_days = finish.size() == 10 && task.finish_s > task.start_s;
    const double at_s = task.finish_s - (whole_days ? made.calendar.seconds_per_day / 2 : 0);
    last = std::max(last, timeline::date_at(made.calendar, at_s).substr(0, 10));
  }
  return last;
}

/// "house.glb  5.1 MB  83 of 83 objects  12 tasks  2024-03-01 to 2024-05-24  84 s  0.21 s"
std::string finished_line(const ScheduleRequest& r, const Scheduled& made) {
  const std::string output = r.output == "-" ? "stdout" : r.output;
  return (r.dry_run ? "(not written)" : output + "  " + human_bytes(made.file.bytes)) + "  " +
         human_count(scheduled_objects(made)) + " of " + counted(made.names.size(), "object") + "  " +
         counted(made.calendar.tasks.size(), "task") + "  " + first_date(made) + " to " + last_date(made) +
         "  timeline " + human_real(static_cast<double>(made.duration_s), 2) + " s  made in " +
         human_seconds(made.seconds) + "\n";
}

std::vector<std::string> all_notes(const Scheduled& made) {
  std::vector<std::string> out = made.notes;
  const Mapping& m = made.mapping;
  out.insert(out.end(), made.plan.notes.begin(), made.plan.notes.end());
  constexpr std::size_t kMostMisses = 10;
  const std::size_t misses = std::min(m.notes.size(), kMostMisses);
  out.insert(out.end(), m.notes.begin(), m.notes.begin() + static_cast<std::ptrdiff_t>(misses));
  if (misses < m.notes.size()) {
    out.push_back("... and " + human_count(m.notes.size() - misses) +
                  " more of that kind (--report lists them)");
  }
  if (!m.tasks_without_objects.empty()) {
    out.push_back(listed("task", " without objects", m.tasks_without_objects,
                         [&](std::uint32_t i) { return made.plan.tasks[i].name; }));
  }
  if (!m.objects_without_tasks.empty()) {
    out.push_back(listed("object", " without a task", m.objects_without_tasks,
                         [&](ObjectId id) { return made.names[id.value]; }));
  }
  std::vector<ObjectId> lost, equal;
  for (const Mapping::Shared& shared : m.claimed_twice) {
    if (!shared.losers.empty()) lost.push_back(shared.object);
    if (shared.equals) equal.push_back(shared.object);
  }
  if (!equal.empty()) {
    out.push_back(listed("object", " claimed twice by rules as sure, all of which count", equal,
                         [&](ObjectId id) { return made.names[id.value]; }));
  }
  if (!lost.empty()) {
    out.push_back(listed("object", " claimed twice, of which the surer rule counts", lost,
                         [&](ObjectId id) { return made.names[id.value]; }));
  }
  return out;
}

ordered_json ids_of(const Plan& plan, const std::vector<std::uint32_t>& tasks) {
  ordered_json out = ordered_json::array();
  for (const std::uint32_t task : tasks) out.push_back(plan.tasks[task].id);
  return out;
}

ordered_json tasks_json(const Scheduled& made) {
  ordered_json out = ordered_json::array();
  for (std::size_t i = 0; i < made.plan.tasks.size(); ++i) {
    const Task& task = made.plan.tasks[i];
    const auto& rule = made.mapping.rule_of_task[i];
    ordered_json names = ordered_json::array();
    for (const ObjectId id : made.mapping.objects_of_task[i]) names.push_back(made.names[id.value]);
    out.push_back({{"id", task.id},
                   {"name", task.name},
                   {"type", timeline::name(task.profile)},
                   {"summary", task.summary},
                   {"start", timeline::moment_text(*task.start_s)},
                   {"finish", finish_text(*task.start_s, *task.finish_s)},
                   {"rule", rule ? ordered_json(timeline::name(*rule)) : ordered_json()},
                   {"objects", std::move(names)}});
  }
  return out;
}

Report report(const ScheduleRequest& r, const Scheduled& made, const std::vector<std::string>& arguments) {
  Report out("scenegen/schedule", 1);
  const auto add = [&out](std::string key, ordered_json value) {
    out.add({std::move(key), {}, std::move(value), {}});
  };
  add("model", r.model);
  add("plan", r.plan);
  add("output", r.output);
  add("written", !r.dry_run);
  add("objects", made.names.size());
  add("scheduled", scheduled_objects(made));
  add("calendar/start", made.calendar.start);
  add("calendar/secondsPerDay", made.calendar.seconds_per_day);
  add("durationS", static_cast<double>(made.duration_s));
  add("moments", made.moments);
  if (!r.dry_run) {
    add("bytes", made.file.bytes);
    add("nodes", made.file.nodes);
    add("channels", made.file.channels);
  }
  add("tasks", tasks_json(made));
  add("tasksWithoutObjects", ids_of(made.plan, made.mapping.tasks_without_objects));
  ordered_json rest = ordered_json::array(), shared = ordered_json::array();
  for (const ObjectId id : made.mapping.objects_without_tasks) rest.push_back(made.names[id.value]);
  for (const Mapping::Shared& s : made.mapping.claimed_twice) {
    shared.push_back({{"object", made.names[s.object.value]},
                      {"tasks", ids_of(made.plan, s.tasks)},
                      {"overruled", ids_of(made.plan, s.losers)}});
  }
  add("objectsWithoutTasks", std::move(rest));
  add("objectsClaimedTwice", std::move(shared));
  add("unmatchedEntries", made.mapping.notes);
  add("arguments", arguments);
  add("notes", made.notes);
  add("seconds", made.seconds);
  return out;
}

/// What --dry-run prints: which task is about how many objects, and how that was found.
std::string mapping_table(const Scheduled& made, Format format) {
  const auto cell = [&](const std::string& text) {  // a name of two lines would break the row
    return format == Format::table ? printable(text) : text;
  };
  Table table({{"task", "task"},
               {"name", "name"},
               {"type", "type"},
               {"start", "start"},
               {"finish", "finish"},
               {"objects", "objects"},
               {"rule", "found by"}});
  for (std::size_t i = 0; i < made.plan.tasks.size(); ++i) {
    const Task& task = made.plan.tasks[i];
    const auto& rule = made.mapping.rule_of_task[i];
    table.row({cell(task.id), cell(task.name),
               task.summary ? std::string_view("summary") : timeline::name(task.profile),
               timeline::moment_text(*task.start_s), finish_text(*task.start_s, *task.finish_s),
               made.mapping.objects_of_task[i].size(), rule ? timeline::name(*rule) : "-"});
  }
  return table.str(format);
}

Result<int> work(const ScheduleRequest& r, const std::vector<std::string>& arguments) {
  auto made = schedule(r, arguments);
  if (!made) return forward_error(made);
  const Report facts = report(r, *made, arguments);
  auto said =
      say({.facts = facts,
           .notes = all_notes(*made),
           .text = (r.dry_run ? mapping_table(*made, Format::table) : "") + finished_line(r, *made),
           .csv = mapping_table(*made, Format::csv),
           .report = r.report,
           .files = &made->files,
           .format = r.format,
           .quiet = r.quiet,
           .stdout_taken = r.report == "-" || r.save_mapping == "-" || (r.output == "-" && !r.dry_run)});
  return said ? Result<int>(0) : forward_error(said);
}

}  // namespace

int schedule_verb(std::span<const std::string> arguments) {
  ScheduleRequest request;
  Options options = schedule_options(request);
  return run_verb(options, arguments,
                  {.check = [&] { return check_schedule(request, options); },
                   .dump_config = &request.dump_config,
                   .conflicts = [&] { return schedule_conflicts(request); },
                   .work = [&] { return work(request, options.canonical_arguments()); }});
}

}  // namespace scenegen::tools
