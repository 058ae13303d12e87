// scenegen optimize FILE -o OUT: the same scene in a smaller file that draws with fewer calls.
#include "scene/gltf/read.h"
#include "scene/gltf/survey.h"
#include "scene/gltf/write.h"
#include "scene/optimize/optimize.h"
#include "timeline/timeline.h"
#include "tools/output.h"
#include "tools/read_gltf.h"
#include "tools/scenegen.h"
#include "tools/scenegen_options.h"
#include "tools/verb.h"

namespace scenegen::tools {

namespace {

using nlohmann::ordered_json;

struct OptimizeRequest {
  std::string input;
  std::string output;
  gltf::WriteOptions file;
  bool allow_loss = false;
  std::string report;
  Format format = Format::table;
  bool dry_run = false;
  bool quiet = false;
};

/// What was there, what was done, what is there now.
struct Optimized {
  std::uint64_t bytes_before = 0, objects = 0, moments = 0;
  gltf::Survey before;
  OptimizeReport content;
  gltf::WriteReport file;
  std::vector<gltf::OutputFile> files;  ///< complete, not yet in their places
  double seconds = 0;
};

std::vector<Conflict> conflicts(const OptimizeRequest& r) {
  std::vector<Conflict> out = conflicts_of_draco(r.file.draco);
  add_stdout_conflicts(r.dry_run ? "" : r.output, r.report, out);
  return out;
}

Result<void> check(const OptimizeRequest& r, const Options& options) {
  if (auto allowed = options.refuse(conflicts(r)); !allowed) return allowed;
  if (r.output.empty() && !r.dry_run)
    return fail(ErrorKind::usage, "--output", "is missing: say which file to write (-o small.glb)");
  if (!r.dry_run) {
    if (auto writable = check_scene_output(r.output); !writable) return writable;
  }
  return check_output_and_report(r.dry_run ? "" : r.output, r.report, {"FILE", r.input});
}

std::string listed(const std::vector<gltf::Ignored>& losses) {
  constexpr std::size_t kMost = 3;
  std::string out;
  for (std::size_t i = 0; i < std::min(losses.size(), kMost); ++i) {
    const gltf::Ignored& loss = losses[i];
    out += (i == 0 ? "" : "; ") + loss.what + " (" + loss.where;
    out += loss.count > 1 ? " and " + human_count(loss.count - 1) + " more)" : ")";
  }
  if (losses.size() > kMost) out += "; and " + counted(losses.size() - kMost, "kind") + " more";
  return out;
}

Result<Optimized> run(const OptimizeRequest& r) {
  const Stopwatch stopwatch;
  gltf::WriteOptions file_options = r.file;
  file_options.id_table = true;
  Optimized out;
  file_options.later = &out.files;
  Progress progress("reading " + r.input, 0, r.quiet);
  auto read = read_gltf(r.input, {.keep_source = true});
  if (!read) return forward_error(read);
  auto before = gltf::survey(*read);
  if (!before) return forward_error(before);
  if (!before->losses.empty() && !r.allow_loss)
    return fail(
        ErrorKind::bad_input, read->source->path,
        "rewriting it would lose " + listed(before->losses) + ": give --allow-loss to write it without");
  out.before = std::move(*before);
  out.bytes_before = read->file_bytes;
  read->source.reset();
  progress.stage("optimizing");
  out.content = optimize(read->scene);
  out.objects = read->scene.objects.size();
  out.moments = timeline::compile(read->scene)->visibility_times_s().size();
  progress.stage(r.dry_run ? "measuring" : "writing " + r.output);
  auto file = r.dry_run ? gltf::predict(read->scene, r.output.empty() ? "-" : r.output, file_options)
                        : gltf::write(read->scene, r.output, file_options);
  if (!file) return forward_error(file);
  out.file = std::move(*file);
  if (out.file.bytes > out.bytes_before) {
    out.file.notes.push_back("larger than before: " + human_bytes(out.file.bytes) + " instead of " +
                             human_bytes(out.bytes_before));
  }
  out.seconds = stopwatch.seconds();
  return out;
}

double share(const Optimized& made) {
  return made.bytes_before == 0
             ? 0
             : static_cast<double>(made.file.bytes) / static_cast<double>(made.bytes_before);
}

void add_change(Report& out, const std::string& key, const std::string& label, std::uint64_t before,
                std::uint64_t after, const std::string& remark = {}) {
  std::string text = human_count(before) + " -> " + human_count(after);
  if (!remark.empty()) text += "  (" + remark + ")";
  out.add({key, label, {{"before", before}, {"after", after}}, text});
}

std::string joined(std::uint64_t equal, std::uint64_t stretched = 0) {
  std::string out = equal == 0 ? "" : human_count(equal) + " equal to others";
  if (stretched > 0)
    out += (out.empty() ? "" : ", ") + counted(stretched, "stretched copy", "stretched copies");
  return out;
}

Report report(const OptimizeRequest& r, const Optimized& made) {
  const OptimizeReport& c = made.content;
  Report out("scenegen/optimize", 1);
  const auto add = [&out](std::string key, ordered_json value) {
    out.add({std::move(key), {}, std::move(value), {}});
  };
  add("input", r.input);
  add("output", r.output);
  add("dryRun", r.dry_run);
  add("objects", made.objects);
  add("moments", made.moments);
  add("layout", layout_name(made.file.layout));
  add("visibility", visibility_name(r.file.visibility));
  out.section("File");
  out.add({"bytes",
           "size",
           {{"before", made.bytes_before}, {"after", made.file.bytes}},
           human_bytes(made.bytes_before) + " -> " + human_bytes(made.file.bytes) + "  (" +
               human_real(100 * share(made), 1) + " %)"});
  add_change(out, "draws", "draws", made.before.draws, made.file.draws);
  add_change(out, "nodes", "nodes", made.before.nodes, made.file.nodes);
  add_change(out, "channels", "channels", made.before.channels, made.file.channels);
  add_change(out, "accessors", "accessors", made.before.accessors, made.file.accessors);
  out.section("Content");
  add_change(out, "meshes", "meshes", made.before.meshes, c.after.meshes,
             joined(c.equal_meshes, c.stretched_meshes));
  add_change(out, "geometries", "geometries", c.before.geometries, c.after.geometries,
             joined(c.equal_geometries));
  add_change(out, "materials", "materials", made.before.materials, c.after.materials,
             joined(c.equal_materials));
  add_change(out, "textures", "textures", made.before.textures, c.after.textures, joined(c.equal_textures));
  add_change(out, "images", "images", made.before.images, c.after.images, joined(c.equal_images));
  add_change(
      out, "frames", "frames", c.before.frames, c.after.frames,
      c.unframed_objects == 0 ? "" : counted(c.unframed_objects, "object") + " left frames that never move");
  add_change(
      out, "tracks", "timelines", c.before.tracks, c.after.tracks,
      c.constant_tracks == 0 ? joined(c.equal_tracks) : human_count(c.constant_tracks) + " changed nothing");
  add_change(out, "keys", "keys", c.before.keys, c.after.keys);
  for (const auto& [key, value] : {std::pair{"equalMeshes", c.equal_meshes},
                                   {"stretchedMeshes", c.stretched_meshes},
                                   {"stretchedObjects", c.stretched_objects},
                                   {"equalGeometries", c.equal_geometries},
                                   {"equalMaterials", c.equal_materials},
                                   {"equalTextures", c.equal_textures},
                                   {"equalImages", c.equal_images},
                                   {"equalTracks", c.equal_tracks},
                                   {"constantTracks", c.constant_tracks},
                                   {"idleKeys", c.idle_keys},
                                   {"unframedObjects", c.unframed_objects}})
    add(key, value);
  if (r.file.draco.on) {
    add("dracoGeometries", made.file.draco_geometries);
    add("dracoBytes", made.file.draco_bytes);
    add("dracoLeft", made.file.draco_left);
  }
  ordered_json lost = ordered_json::array();
  for (const gltf::Ignored& loss : made.before.losses)
    lost.push_back({{"where", loss.where}, {"what", loss.what}, {"count", loss.count}});
  add("lost", std::move(lost));
  add("notes", made.file.notes);
  add("seconds", made.seconds);
  return out;
}

/// "small.glb  4.1 MB (17 % of 23.8 MB)  200 000 objects  4 096 moments  1.2 s"
std::string finished_line(const OptimizeRequest& r, const Optimized& made) {
  const std::string name = r.output.empty() ? r.input : r.output == "-" ? "stdout" : r.output;
  return name + (r.dry_run ? "  (not written)  " : "  ") + human_bytes(made.file.bytes) + " (" +
         human_real(100 * share(made), 1) + " % of " + human_bytes(made.bytes_before) + ")  " +
         counted(made.objects, "object") + "  " + counted(made.moments, "moment") + "  layout " +
         layout_name(made.file.layout) + "  " + human_seconds(made.seconds) + "\n";
}

std::vector<std::string> all_notes(const Optimized& made) {
  std::vector<std::string> out;
  if (!made.before.losses.empty()) out.push_back("lost " + listed(made.before.losses));
  out.insert(out.end(), made.file.notes.begin(), made.file.notes.end());
  return out;
}

Result<int> work(const OptimizeRequest& r) {
  auto made = run(r);
  if (!made) return forward_error(made);
  const Report facts = report(r, *made);
  auto said = say({.facts = facts,
                   .notes = all_notes(*made),
                   .text = facts.str(Format::table) + "\n" + finished_line(r, *made),
                   .report = r.report,
                   .files = &made->files,
                   .format = r.format,
                   .quiet = r.quiet,
                   .stdout_taken = r.report == "-" || (r.output == "-" && !r.dry_run)});
  return said ? Result<int>(0) : forward_error(said);
}

Options optimize_options(OptimizeRequest& r) {
  Options options(
      "scenegen optimize", {"scenegen optimize FILE -o OUT [options]"},
      "writes the same scene smaller and with fewer draws: equal meshes, materials, images and timelines "
      "become one, stretched copies of a mesh share it, objects that appear together are grouped. What is "
      "seen does not change at any time.");
  options.positional("FILE", r.input, "a .glb or .gltf file");
  options.group("Output");
  options.add("-o,--output",
              text_value(r.output, "FILE", ".glb, .gltf with its .bin, - for a .glb on stdout"),
              "the file to write", Role::run, "none, it must be given");
  add_file_options(options, r.file);
  options.flag("--allow-loss", r.allow_loss,
               "write although the file holds what would be lost: skins, morph targets, lights, further "
               "animations, extras and extensions that this program does not know");
  options.add("--format", format_value(r.format), "form of what is printed on stdout");
  options.add("--report", text_value(r.report, "FILE"), "also write what was done, as JSON", Role::run,
              "none");
  options.flag("--dry-run", r.dry_run, "measure and write nothing");
  add_draco_options(options, r.file.draco);
  options.group("General");
  options.add_general(r.quiet);
  return options;
}

}  // namespace

int optimize_verb(std::span<const std::string> arguments) {
  OptimizeRequest request;
  Options options = optimize_options(request);
  return run_verb(options, arguments,
                  {.check = [&] { return check(request, options); }, .work = [&] { return work(request); }});
}

}  // namespace scenegen::tools
