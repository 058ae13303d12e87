// scenegen animate MODEL -o OUT: a static model -> times along a curve -> the model's own document, patched.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "scene/gltf/patch.h"
#include "scene/limits.h"
#include "scene/selector.h"
#include "timeline/appearance.h"
#include "timeline/profiles.h"
#include "timeline/statistics.h"
#include "timeline/track_table.h"
#include "tools/output.h"
#include "tools/profile_options.h"
#include "tools/scenegen.h"
#include "tools/scenegen_options.h"
#include "tools/source_model.h"
#include "tools/verb.h"

namespace scenegen::tools {

namespace {

using timeline::Profile;

/// "construct:material=Brick*"
struct Rule {
  Profile profile;
  std::string selector;
};

struct AnimateRequest {
  std::string input, output;
  import::ImportOptions import;
  gltf::Split split = gltf::Split::none;
  std::vector<std::string> rules, exclude;  ///< as given, checked
  timeline::AppearanceOptions appearance;
  ProfileRequest profile;
  gltf::VisibilityEncoding visibility = gltf::VisibilityEncoding::scale;
  std::uint64_t seed = 1;
  std::uint32_t threads = 0;

  std::string report;
  Format format = Format::table;
  bool dry_run = false;
  bool dump_config = false;
  bool quiet = false;
};

/// What was made, or would be.
struct Animated {
  timeline::Statistics counts;
  AppearanceInfo appearance;
  gltf::WriteReport file;
  std::uint64_t excluded = 0, split_objects = 0, expanded = 0;
  std::vector<std::uint64_t> objects_of_profile = std::vector<std::uint64_t>(timeline::kProfileCount);
  std::vector<std::string> notes;
  std::vector<gltf::OutputFile> files;  ///< complete, not yet in their places
  double seconds = 0;
};

// ---- What is asked for

Result<Rule> parse_rule(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos)
    return fail(ErrorKind::usage, "", "'" + text + "' is not of the form PROFILE:SELECTOR");
  auto profile = timeline::parse_profile(text.substr(0, colon));
  if (!profile) return forward_error(profile);
  Rule out{*profile, text.substr(colon + 1)};
  auto selector = Selector::parse(out.selector);
  if (!selector) return forward_error(selector);
  return out;
}

Result<void> check_rule(const std::string& text) {
  auto rule = parse_rule(text);
  return rule ? Result<void>() : forward_error(rule);
}

Result<void> check_selector(const std::string& text) {
  auto selector = Selector::parse(text);
  return selector ? Result<void>() : forward_error(selector);
}

Value split_value(gltf::Split& target) {
  return choice_value<gltf::Split>(target,
                                   {{"none", gltf::Split::none},
                                    {"primitives", gltf::Split::primitives},
                                    {"components", gltf::Split::components}},
                                   "HOW");
}

constexpr const char* kSelectorForms = "NAME, name=, name~, extras.KEY=, material=, subtree=";

void add_model_options(Options& options, AnimateRequest& r) {
  options.group("Model");
  options.add("--split", split_value(r.split),
              "how many objects a mesh is: all of it one; one for every primitive; one for every connected "
              "piece, of vertices at equal positions",
              Role::content);
  options.add("--exclude", texts_value(r.exclude, "SELECTOR", kSelectorForms, check_selector),
              "objects that get no time and stay visible; may be given several times", Role::content, "none");
  add_import_options(options, r.import);
}

Options animate_options(AnimateRequest& r) {
  Options options(
      "scenegen animate", {"scenegen animate MODEL -o OUT [options]"},
      "gives the objects of a static model times along a space-filling curve. MODEL is glTF, or "
      "what Assimp reads (FBX, IFC, OBJ, Collada, STL, 3MF and others). What the model holds stays "
      "as it is; nodes and one animation are added. An object is a node with a mesh, or an instance; "
      "each keeps a node of its own (scenegen optimize groups them again).");
  options.positional("MODEL", r.input, "a .glb or .gltf file (- is stdin), or a model of another format");
  add_model_options(options, r);
  options.group("Appearance");
  options.add("--curve",
              choice_value<timeline::CurveKind>(r.appearance.curve,
                                                {{"hilbert", timeline::CurveKind::hilbert},
                                                 {"morton", timeline::CurveKind::morton},
                                                 {"row-prime", timeline::CurveKind::row_prime}},
                                                "CURVE"),
              "curve along which objects appear", Role::content);
  add_curve_options(options, r.appearance);
  options.add("--seed", whole_value<std::uint64_t>(r.seed, 0, limits::kMaxSeed), "of the displaced times",
              Role::content);
  add_profile_options(options, r.profile, ProfileSource::curve);
  options.add("--rule", texts_value(r.rules, "PROFILE:SELECTOR", kSelectorForms, check_rule),
              "another profile for some objects, as in 'construct:material=Brick*'; may be given several "
              "times, and of those that fit an object the last counts",
              Role::content, "none");
  options.group("Output");
  options.add("-o,--output",
              text_value(r.output, "FILE", ".glb, .gltf with its .bin, - for a .glb on stdout"),
              "the file to write", Role::run, "none, it must be given");
  add_visibility_option(options, r.visibility);
  options.add("--format", format_value(r.format), "form of what is printed on stdout");
  options.add("--report", text_value(r.report, "FILE"),
              "also write what was made, and how long it took, as JSON", Role::run, "none");
  options.flag("--dry-run", r.dry_run, "print what would be made, but for its bytes, and write nothing");
  options.group("General");
  options.add("--threads", whole_value<std::uint32_t>(r.threads, 0, limits::kMaxThreads),
              "0: one per processor; never changes the file");
  options.add_config(r.dump_config);
  options.add_general(r.quiet);
  return options;
}

std::vector<Rule> rules_of(const AnimateRequest& r) {
  std::vector<Rule> out;
  for (const std::string& text : r.rules) {
    if (auto rule = parse_rule(text)) out.push_back(std::move(*rule));  // checked when it was taken
  }
  return out;
}

std::vector<Conflict> conflicts(const AnimateRequest& r) {
  std::vector<Profile> used{r.profile.profile};
  for (const Rule& rule : rules_of(r)) used.push_back(rule.profile);
  std::vector<Conflict> out = profile_conflicts(r.profile, used);
  add_import_conflicts(r.input, out);
  add_stdout_conflicts(r.dry_run ? "" : r.output, r.report, out);
  return out;
}

Result<void> check(const AnimateRequest& r, const Options& options) {
  if (auto allowed = options.refuse(conflicts(r)); !allowed) return allowed;
  if (!r.dry_run && !r.dump_config) {
    if (r.output.empty()) {
      const std::string stem = std::filesystem::path(r.input).stem().string();
      return fail(ErrorKind::usage, "--output",
                  "is missing: say which file to write (-o " + (r.input == "-" ? "out" : stem + "_animated") +
                      ".glb)");
    }
    if (auto writable = check_scene_output(r.output); !writable) return writable;
  }
  return check_output_and_report(r.dry_run ? "" : r.output, r.report, {"MODEL", r.input});
}

// ---- The way of the data

/// Objects that a selector chooses; one that chooses none is most likely misspelt.
Result<std::vector<ObjectId>> chosen(const std::string& selector, const char* option,
                                     const ObjectFacts& facts) {
  auto parsed = Selector::parse(selector);
  if (!parsed) return forward_error(parsed);
  std::vector<ObjectId> out = parsed->select(facts);
  if (out.empty())
    return fail(ErrorKind::bad_input, option, "'" + selector + "' chooses no object of the model");
  return out;
}

/// By object: the profile, or none when it is excluded.
Result<std::vector<std::optional<Profile>>> profiles_of_objects(const AnimateRequest& r,
                                                                const gltf::ReadResult& read) {
  std::vector<std::optional<Profile>> out(read.scene.objects.size(), r.profile.profile);
  if (r.rules.empty() && r.exclude.empty()) return out;
  auto facts = ObjectFacts::make(read.scene, *read.source);
  if (!facts) return forward_error(facts);
  for (const Rule& rule : rules_of(r)) {
    auto objects = chosen(rule.selector, "--rule", *facts);
    if (!objects) return forward_error(objects);
    for (const ObjectId id : *objects) out[id.value] = rule.profile;
  }
  for (const std::string& selector : r.exclude) {
    auto objects = chosen(selector, "--exclude", *facts);
    if (!objects) return forward_error(objects);
    for (const ObjectId id : *objects) out[id.value] = std::nullopt;
  }
  if (std::none_of(out.begin(), out.end(), [](const auto& p) { return p.has_value(); }))
    return fail(ErrorKind::bad_input, "--exclude", "leaves no object to give a time to");
  return out;
}

/// Times along the curve, then what happens at them. Returns what patch() must know of new materials.
Result<timeline::ProfileResult> give_times(const AnimateRequest& r, const gltf::ReadResult& read,
                                           Scene& scene, Animated& out) {
  auto profiles = profiles_of_objects(r, read);
  if (!profiles) return forward_error(profiles);
  std::vector<std::uint8_t> exempt;
  std::vector<std::vector<ObjectId>> groups(timeline::kProfileCount);
  for (std::size_t i = 0; i < profiles->size(); ++i) {
    const std::optional<Profile>& profile = (*profiles)[i];
    exempt.push_back(profile ? 0 : 1);
    if (profile) groups[static_cast<std::size_t>(*profile)].emplace_back(i);
  }
  out.excluded = static_cast<std::uint64_t>(std::count(exempt.begin(), exempt.end(), 1));
  auto appearance = timeline::assign_appearance(scene, r.appearance, exempt);
  if (!appearance) return forward_error(appearance);
  std::vector<timeline::Activity> activities;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    out.objects_of_profile[i] = groups[i].size();
    if (groups[i].empty()) continue;
    timeline::CurveActivities curve = curve_activities(r.profile);
    curve.profile = static_cast<Profile>(i);
    const auto some = timeline::activities_of_appearance(scene, curve, groups[i]);
    activities.insert(activities.end(), some.begin(), some.end());
  }
  timeline::ProfileResult result;
  result.first_new_material = scene.materials.size();
  const auto& plain = groups[static_cast<std::size_t>(Profile::appear)];
  if (plain.size() + out.excluded < profiles->size()) {
    auto profiled = timeline::apply_curve_profiles(scene, activities, r.profile.options);
    if (!profiled) return forward_error(profiled);
    result = std::move(*profiled);
  }
  out.appearance = *scene.info.appearance;
  return result;
}

Result<Animated> animate(const AnimateRequest& r, const std::vector<std::string>& arguments) {
  const Stopwatch stopwatch;
  Animated out;
  Progress progress("", 0, r.quiet);
  progress.stage("reading " + r.input);
  auto model = read_source_model(r.input, r.import, r.split);
  if (!model) return forward_error(model);
  out.split_objects = model->split_objects;
  out.expanded = model->expanded;
  out.notes = std::move(model->notes);
  const gltf::ReadResult& read = model->read;
  Scene& scene = model->read.scene;
  progress.stage("giving times to " + counted(scene.objects.size(), "object"));
  const timeline::TracksAsRead as_read(scene);
  auto profiled = give_times(r, read, scene, out);
  if (!profiled) return forward_error(profiled);
  scene.info.seed = r.seed;
  scene.info.arguments = arguments;
  scene.info.calendar.reset();
  if (r.dry_run || r.format != Format::table || !r.report.empty())
    out.counts = timeline::statistics(scene, r.appearance.threads);
  out.counts.objects = scene.objects.size();
  if (!r.dry_run) {
    progress.stage("writing " + r.output);
    as_read.restore(scene);
    gltf::PatchOptions options;
    options.visibility = r.visibility;
    options.material_copy_of = profiled->copy_of;
    options.later = &out.files;
    auto file = gltf::patch(*read.source, scene, r.output, options);
    if (!file) return forward_error(file);
    out.file = std::move(*file);
    out.notes.insert(out.notes.end(), out.file.notes.begin(), out.file.notes.end());
  }
  out.seconds = stopwatch.seconds();
  return out;
}

// ---- What is said

/// "out.glb  5.1 MB  110 objects  82 moments  coherence 1.000  locality 13.3  seed 1  0.21 s"
std::string finished_line(const AnimateRequest& r, const Animated& made) {
  std::string line =
      r.dry_run ? "(not written)  "
                : (r.output == "-" ? "stdout" : r.output) + "  " + human_bytes(made.file.bytes) + "  ";
  line += counted(made.counts.objects, "object");
  if (r.dry_run) {
    line += "  " + counted(made.counts.vertices, "vertex", "vertices") + "  " +
            counted(made.counts.triangles, "triangle");
  }
  if (made.excluded != 0) line += "  " + human_count(made.excluded) + " excluded";
  return line + "  " + counted(made.appearance.moments, "moment") + "  coherence " +
         human_real(made.appearance.coherence_measured, 3) + "  locality " +
         human_real(made.appearance.locality_cells, 1) + "  seed " + std::to_string(r.seed) + "  " +
         human_seconds(made.seconds) + "\n";
}

Report report(const AnimateRequest& r, const Animated& made, const std::vector<std::string>& arguments) {
  Report out("scenegen/report", 1);
  const auto add = [&out](std::string key, nlohmann::ordered_json value) {
    out.add({std::move(key), {}, std::move(value), {}});
  };
  add("command", "animate");
  add("input", r.input);
  add("output", r.output);
  add("written", !r.dry_run);
  add("objects", made.counts.objects);
  add("excluded", made.excluded);
  add("splitObjects", made.split_objects);
  add("expandedInstances", made.expanded);
  add("vertices", made.counts.vertices);
  add("triangles", made.counts.triangles);
  add("moments", made.appearance.moments);
  if (!r.dry_run) {
    add("bytes", made.file.bytes);
    add("jsonBytes", made.file.json_bytes);
    add("nodes", made.file.nodes);
    add("channels", made.file.channels);
  }
  add("seed", r.seed);
  add("coherence", made.appearance.coherence_measured);
  add("coherenceGiven", made.appearance.coherence_given);
  add("displaced", made.appearance.displaced_objects);
  add("locality", made.appearance.locality_cells);
  nlohmann::ordered_json profiles = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < made.objects_of_profile.size(); ++i) {
    if (made.objects_of_profile[i] != 0)
      profiles[std::string(timeline::name(static_cast<Profile>(i)))] = made.objects_of_profile[i];
  }
  add("profiles", std::move(profiles));
  add("visibility", visibility_name(r.visibility));
  add("arguments", arguments);
  add("notes", made.notes);
  add("seconds", made.seconds);
  return out;
}

void settle(AnimateRequest& r) {
  const unsigned processors = std::max(1U, std::thread::hardware_concurrency());
  r.appearance.seed = r.seed;
  r.appearance.threads = r.threads != 0 ? r.threads : std::min(processors, limits::kMaxThreads);
}

Result<int> work(AnimateRequest& r, const std::vector<std::string>& arguments) {
  settle(r);
  auto made = animate(r, arguments);
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

int animate_verb(std::span<const std::string> arguments) {
  AnimateRequest request;
  Options options = animate_options(request);
  return run_verb(options, arguments,
                  {.check = [&] { return check(request, options); },
                   .dump_config = &request.dump_config,
                   .conflicts = [&] { return conflicts(request); },
                   .work = [&] { return work(request, options.canonical_arguments()); }});
}

}  // namespace scenegen::tools
