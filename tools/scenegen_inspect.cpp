// scenegen inspect FILE: what is in a file, ours or anybody's.
#include <filesystem>

#include "scene/gltf/read.h"
#include "scene/import/import.h"
#include "scene/limits.h"
#include "scene/validate.h"
#include "timeline/statistics.h"
#include "tools/object_list.h"
#include "tools/output.h"
#include "tools/scenegen.h"
#include "tools/verb.h"

namespace scenegen::tools {

namespace {

using nlohmann::ordered_json;

struct InspectRequest {
  std::string file;
  bool objects = false;
  Format format = Format::table;
  std::uint32_t threads = 1;
  bool quiet = false;
};

std::string size_text(const glm::uvec3& v) {
  return std::to_string(v.x) + "x" + std::to_string(v.y) + "x" + std::to_string(v.z);
}

void add_count(Report& out, std::string key, std::string label, std::uint64_t count) {
  out.add({std::move(key), std::move(label), count, human_count(count)});
}

void add_file_section(Report& out, const std::string& path, const gltf::ReadResult& read) {
  std::uint64_t image_bytes = 0;
  for (const Image& image : read.scene.images) image_bytes += image.bytes.size();
  const std::uint64_t binary_bytes = read.file_bytes - std::min(read.file_bytes, read.json_bytes);
  const SceneInfo& info = read.scene.info;
  out.section("File");
  out.add({"file", "file", path, path});
  if (!import::is_gltf(path)) {
    std::error_code gone;  // since it was read
    const std::uintmax_t bytes = std::filesystem::file_size(path, gone);
    if (!gone) out.add({"bytes", "size", bytes, human_bytes(bytes)});
    out.add({"gltfBytes", "as glTF", read.file_bytes, human_bytes(read.file_bytes)});
    out.add({"importer", "read by", info.generator, info.generator});
    return;
  }
  out.add({"bytes", "size", read.file_bytes, human_bytes(read.file_bytes)});
  out.add({"parts/json", "  JSON", read.json_bytes, human_bytes(read.json_bytes)});
  out.add({"parts/binary", "  binary", binary_bytes, human_bytes(binary_bytes)});
  out.add(
      {"parts/images", "  of which images", image_bytes, image_bytes == 0 ? "" : human_bytes(image_bytes)});
  out.add({"generator", "generator", info.generator, info.generator});
  out.add({"seed", "seed", info.seed ? ordered_json(*info.seed) : ordered_json(),
           info.seed ? std::to_string(*info.seed) : ""});
  out.add({"arguments", "arguments", info.arguments, join(info.arguments, " ")});
}

void add_scene_section(Report& out, const timeline::Statistics& s) {
  out.section("Scene");
  add_count(out, "objects", "objects", s.objects);
  add_count(out, "classes/static", "  static", s.classes.constant);
  add_count(out, "classes/pseudoDynamic", "  pseudo-dynamic", s.classes.pseudo_dynamic);
  add_count(out, "classes/dynamic", "  dynamic", s.classes.dynamic);
  out.add({"vertices", "vertices drawn", s.vertices,
           human_count(s.vertices) + " (" + human_count(s.unique_vertices) + " stored)"});
  out.add({"uniqueVertices", "", s.unique_vertices, ""});
  out.add({"triangles", "triangles drawn", s.triangles,
           human_count(s.triangles) + " (" + human_count(s.unique_triangles) + " stored)"});
  out.add({"uniqueTriangles", "", s.unique_triangles, ""});
  add_count(out, "meshes", "meshes", s.meshes);
  add_count(out, "geometries", "geometries", s.geometries);
  add_count(out, "materials", "materials", s.materials);
  add_count(out, "textures", "textures", s.textures);
  add_count(out, "images", "images", s.images);
  add_count(out, "cameras", "cameras", s.cameras);
  add_count(out, "frames", "frames", s.frames);
  if (s.bounds_m.empty()) return;
  const glm::vec3 size = s.bounds_m.size();
  out.add({"sizeM",
           "size (x, y up, z)",
           {size.x, size.y, size.z},
           human_real(size.x, 2) + " x " + human_real(size.y, 2) + " x " + human_real(size.z, 2) + " m"});
}

void add_timeline_section(Report& out, const timeline::Statistics& s) {
  out.section("Timeline");
  out.add({"durationS", "length", s.duration_s, human_real(s.duration_s, 3) + " s"});
  add_count(out, "tracks", "tracks", s.tracks);
  add_count(out, "keys", "keys", s.keys);
  add_count(out, "moments", "moments", s.moments);
  add_count(out, "events", "events", s.events);
  out.add({"eventsPerMoment/mean", "events per moment", s.mean_events,
           s.moments == 0 ? ""
                          : human_real(s.mean_events, 1) + " (" + human_count(s.least_events) + " to " +
                                human_count(s.most_events) + ")"});
  out.add({"eventsPerMoment/least", "", s.least_events, ""});
  out.add({"eventsPerMoment/most", "", s.most_events, ""});
}

void add_appearance_section(Report& out, const SceneInfo& info, const timeline::Statistics& s) {
  if (!info.appearance) return;
  const AppearanceInfo& a = *info.appearance;
  out.section("Appearance");
  out.add({"appearance/curve", "curve", a.curve,
           a.curve_variant == a.curve ? a.curve : a.curve + " (" + a.curve_variant + ")"});
  out.add({"appearance/order", "order of axes (z up)", a.order, a.order});
  out.add({"appearance/cells", "cells", {a.cells.x, a.cells.y, a.cells.z}, size_text(a.cells)});
  out.add({"appearance/intervalS", "interval", a.interval_s, shortest(a.interval_s) + " s"});
  out.add({"appearance/holdS", "hold", a.hold_s, shortest(a.hold_s) + " s"});
  out.add({"coherenceGiven", "coherence given", a.coherence_given, shortest(a.coherence_given)});
  out.add({"coherenceStored", "coherence stored", a.coherence_measured, human_real(a.coherence_measured, 6)});
  if (s.coherence_measured) {
    out.add(
        {"coherence", "coherence measured now", *s.coherence_measured, human_real(*s.coherence_measured, 6)});
  }
  add_count(out, "timed", "objects timed", a.timed_objects);
  add_count(out, "displaced", "objects displaced", a.displaced_objects);
  if (s.jumps) {
    out.add({"jumps", "jumps", *s.jumps,
             human_count(*s.jumps) + " (steps of the curve between cells that share no face)"});
  }
  if (s.locality_cells) {
    out.add({"locality", "locality", *s.locality_cells,
             human_real(*s.locality_cells, 1) + " (mean side of the box round 512 neighbours on the curve)"});
  }
}

void add_ignored_section(Report& out, const std::vector<gltf::Ignored>& ignored) {
  ordered_json list = ordered_json::array();
  for (const gltf::Ignored& entry : ignored) {
    list.push_back({{"where", entry.where}, {"what", entry.what}, {"count", entry.count}});
  }
  out.section("Ignored: in the file, not in the scene");
  out.add({"ignored", "", std::move(list), ""});
  for (const gltf::Ignored& entry : ignored) {
    out.add({"", human_count(entry.count) + " x", {}, entry.where + ": " + entry.what});
  }
}

void add_findings_section(Report& out, const std::vector<Finding>& findings) {
  ordered_json list = ordered_json::array();
  for (const Finding& entry : findings) {
    list.push_back({{"rule", entry.rule}, {"where", entry.where}, {"what", entry.what}});
  }
  out.section("Findings: rules of docs/FORMAT.md that the scene breaks");
  out.add({"findings", "", std::move(list), ""});
  for (const Finding& entry : findings) {
    out.add({"", "rule " + std::to_string(entry.rule), {}, entry.where + ": " + entry.what});
  }
}

Result<gltf::ReadResult> read_file(const InspectRequest& r) {
  if (r.objects || !import::is_gltf(r.file)) return import::read_model(r.file);
  gltf::ReadOptions options;
  options.threads = r.threads;
  return gltf::read(r.file, options);
}

/// The exit code: 1 when the scene breaks rules.
Result<int> inspect(const InspectRequest& r) {
  auto read = read_file(r);
  if (!read) return forward_error(read);
  const std::vector<Finding> findings = validate(read->scene);
  std::string text;
  if (r.objects) {
    auto list = object_list(r.file, *read, r.format);
    if (!list) return forward_error(list);
    text = std::move(*list);
  } else {
    const timeline::Statistics statistics = timeline::statistics(read->scene, r.threads);
    Report out("scenegen/inspect", 1);
    add_file_section(out, r.file, *read);
    add_scene_section(out, statistics);
    add_timeline_section(out, statistics);
    add_appearance_section(out, read->scene.info, statistics);
    add_ignored_section(out, read->ignored);
    add_findings_section(out, findings);
    text = out.str(r.format);
  }
  if (!r.quiet || r.format != Format::table) {
    if (auto written = write_stdout(text); !written) return forward_error(written);
  }
  return findings.empty() ? 0 : static_cast<int>(ErrorKind::bad_input);
}

}  // namespace

int inspect_verb(std::span<const std::string> arguments) {
  InspectRequest request;
  Options options("scenegen inspect", {"scenegen inspect FILE [options]"},
                  "says what is in a file: objects, meshes, timeline, sizes, and what was ignored. FILE is "
                  "glTF, or a model that scenegen animate and scenegen schedule read.");
  options.positional("FILE", request.file, "a .glb or .gltf file (- is stdin), or a model of another format");
  options.group("Output");
  options.flag("--objects", request.objects,
               "list instead what rules and plans can call its objects: the tree of nodes with their names, "
               "[materials] and extras; with --format csv or json an object a row");
  options.add("--format", format_value(request.format), "form of what is printed on stdout");
  options.group("General");
  options.add("--threads", whole_value<std::uint32_t>(request.threads, 1, limits::kMaxThreads),
              "threads to use");
  options.add_general(request.quiet);
  return run_verb(options, arguments, {.work = [&] { return inspect(request); }});
}

}  // namespace scenegen::tools
