#include "tools/scenegen_options.h"

#include <algorithm>
#include <filesystem>
#include <thread>

#include "scene/limits.h"
#include "tools/verb.h"

namespace scenegen::tools {

namespace {

using timeline::CurveKind;

const std::vector<std::pair<std::string, gltf::Layout>>& layouts() {
  static const std::vector<std::pair<std::string, gltf::Layout>> list{{"auto", gltf::Layout::automatic},
                                                                      {"nodes", gltf::Layout::nodes},
                                                                      {"groups", gltf::Layout::groups},
                                                                      {"instances", gltf::Layout::instances},
                                                                      {"merged", gltf::Layout::merged}};
  return list;
}

const std::vector<std::pair<std::string, gltf::VisibilityEncoding>>& encodings() {
  using gltf::VisibilityEncoding;
  static const std::vector<std::pair<std::string, VisibilityEncoding>> list{
      {"scale", VisibilityEncoding::scale},
      {"pointer", VisibilityEncoding::pointer},
      {"both", VisibilityEncoding::both}};
  return list;
}

template <class T>
std::string name_in(const std::vector<std::pair<std::string, T>>& list, T value) {
  for (const auto& [name, entry] : list) {
    if (entry == value) return name;
  }
  return {};
}

Value test_set_value(std::uint32_t& target) {
  Value value = whole_value<std::uint32_t>(target, 5, 48);
  value.spell = [&target] { return target == 0 ? std::string() : std::to_string(target); };
  return value;
}

void add_town_options(Options& options, GenerateRequest& r) {
  gen::TownOptions& t = r.town;
  options.group("Town");
  options.add("--grid", size2_value(t.grid, {1, 1}, {1000, 1000}, "XxY"), "buildings along x and y",
              Role::content);
  options.add("--spacing", real_value(t.spacing_m, 0, 1000, "M"), "metres between neighbouring buildings",
              Role::content);
  options.add("--ground", on_off_value(t.ground), "a ground under the town, always visible", Role::content);
  options.add("--test-set", test_set_value(r.test_set),
              "a test set of the dissertation's table 1 instead of a town", Role::content, "none");
  options.add("--seed", whole_value<std::uint64_t>(r.seed, 0, limits::kMaxSeed),
              "of everything random: roofs, brick tints, extra objects, displaced times", Role::content);
}

void add_building_options(Options& options, GenerateRequest& r) {
  gen::TownOptions& t = r.town;
  options.group("Building");
  options.add("--brick", metres3_value(t.brick_m, 0.01, 10, "LxWxH"),
              "length, width (= wall thickness) and height of a brick in metres", Role::content);
  options.add("--building-size", size2_value(t.building_bricks, {2, 2}, {1000, 1000}, "WxL"),
              "width and length in brick lengths", Role::content);
  options.add("--floor-courses", whole_value<std::uint32_t>(t.floor_courses, 1, 1000),
              "height of a floor in courses of bricks", Role::content);
  options.add("--floors", whole_value<std::uint32_t>(t.floors, 1, 1000), "floors of a building",
              Role::content);
  options.add("--partitions", on_off_value(t.partitions), "inner walls with door openings", Role::content);
  options.add("--windows", on_off_value(t.windows), "openings with lintel, frame and glass", Role::content);
  options.add("--window", metres2_value(t.window_m, 0.1, 100, "WxH"),
              "width and height of a window in metres", Role::content);
  options.add("--roof",
              choice_value<gen::Roof>(t.roof,
                                      {{"mixed", gen::Roof::mixed},
                                       {"gabled", gen::Roof::gabled},
                                       {"flat", gen::Roof::flat},
                                       {"none", gen::Roof::none}},
                                      "ROOF"),
              "form of the roofs; mixed: most gabled, some flat", Role::content);
  options.add("--building-model", text_value(t.building_model, "FILE"),
              "a .glb or .gltf whose content stands in for each building", Role::content,
              "none: built of bricks");
}

void add_extra_options(Options& options, GenerateRequest& r) {
  options.group("Extra objects");
  options.add("--extras", whole_value<std::uint32_t>(r.town.extras_per_floor, 0, 100000),
              "extra objects per floor", Role::content);
  options.add("--extra-model",
              text_value(r.town.extra_model, "MODEL", "box, sphere:SLICES, or a .glb or .gltf file"),
              "what an extra object looks like", Role::content);
}

void add_machine_options(Options& options, GenerateRequest& r) {
  options.group("Machines");
  options.add("--machines", whole_value<std::uint32_t>(r.town.machines, 0, 300),
              "moving equipment, every third a tower crane that turns to where objects appear, the others "
              "lorries that drive round blocks",
              Role::content);
}

Value curve_value(std::optional<CurveKind>& target) {
  return choice_value<std::optional<CurveKind>>(target,
                                                {{"hilbert", CurveKind::hilbert},
                                                 {"morton", CurveKind::morton},
                                                 {"row-prime", CurveKind::row_prime},
                                                 {"none", std::nullopt}},
                                                "CURVE");
}

void add_appearance_options(Options& options, GenerateRequest& r) {
  options.group("Appearance");
  options.add("--curve", curve_value(r.curve), "curve along which objects appear; none makes a static scene",
              Role::content);
  add_curve_options(options, r.appearance);
}

void add_output_options(Options& options, GenerateRequest& r) {
  options.group("Output");
  options.add("-o,--output",
              text_value(r.output, "FILE", ".glb, .gltf with its .bin, - for a .glb on stdout"),
              "the file to write");
  add_file_options(options, r.file);
  options.add("--format", format_value(r.format), "form of what is printed on stdout");
  options.add("--report", text_value(r.report, "FILE"),
              "also write what was made, and how long it took, as JSON", Role::run, "none");
  options.flag("--dry-run", r.dry_run,
               "print objects, vertices, triangles, moments and bytes and write nothing; the scene is built "
               "in memory");
}

Value bits_value(std::uint32_t& target) {
  Value value = whole_value<std::uint32_t>(target, 0, 30, "BITS");
  value.range = "0, or 2 to 30";
  value.parse = [&target, parse = std::move(value.parse)](std::string_view text) -> Result<void> {
    const std::uint32_t before = target;
    if (auto taken = parse(text); !taken) return taken;
    if (target != 1) return {};
    target = before;
    return fail(ErrorKind::usage, "", "1 is out of range (0, or 2 to 30; nearest: 2)");
  };
  return value;
}

}  // namespace

Value order_value(timeline::AxisOrder& target) {
  return {Value::Kind::text, "AXES", "a sign and a letter per axis",
          [&target](std::string_view text) -> Result<void> {
            auto order = timeline::parse_axis_order(text);
            if (!order) return forward_error(order);
            target = *order;
            return {};
          },
          [&target] { return timeline::str(target); }};
}

void add_curve_options(Options& options, timeline::AppearanceOptions& a) {
  constexpr double kLongest = 1e6;  // s
  options.add("--order", order_value(a.order),
              "axes from the fastest to the slowest, with directions (z is up): +x+y-z mirrors the curve in "
              "z; with row-prime it goes layer by layer, top-down",
              Role::content);
  options.add("--cells", size3_value(a.cells, glm::uvec3(1), glm::uvec3(limits::kMaxCellsPerAxis), "XxYxZ"),
              "grid of cells that the curve runs through", Role::content);
  options.add("--interval", real_value(a.interval_s, 1e-6, kLongest, "S"),
              "seconds between neighbouring cells: cell n appears at n times this", Role::content);
  options.add("--hold", real_value(a.hold_s, 0, kLongest, "S"), "seconds after the last event",
              Role::content);
  options.add("--coherence", real_value(a.coherence, 0, 1, "C"),
              "share of objects that appear with their own cell; the others are displaced in time",
              Role::content);
}

void add_visibility_option(Options& options, gltf::VisibilityEncoding& visibility) {
  options.add("--visibility", choice_value<gltf::VisibilityEncoding>(visibility, encodings(), "HOW"),
              "how hiding is written: animated scale plays everywhere, pointer is KHR_node_visibility",
              Role::content);
}

void add_file_options(Options& options, gltf::WriteOptions& file) {
  options.add("--layout", choice_value<gltf::Layout>(file.layout, layouts(), "LAYOUT"),
              "how objects become glTF nodes (docs/FORMAT.md); auto: instances from " +
                  std::to_string(gltf::kInstancesFrom) +
                  " objects on, else nodes; merged: large, but core glTF, and few nodes",
              Role::content);
  add_visibility_option(options, file.visibility);
}

Result<void> check_scene_output(const std::string& output) {
  if (output == "-") {
    if (!terminal(1)) return {};
    return fail(ErrorKind::usage, "--output",
                "a .glb is not for a terminal; send stdout to a file or a program");
  }
  const std::filesystem::path path(output);
  std::error_code ignored;
  const bool folder = std::filesystem::is_directory(path, ignored);
  if (path.extension() != ".glb" && path.extension() != ".gltf" && path.has_filename() && !folder) {
    return fail(ErrorKind::usage, "--output",
                "'" + output + "' ends neither in .glb nor in .gltf (nearest: '" +
                    std::filesystem::path(path).replace_extension(".glb").string() + "')");
  }
  return check_output_file(output);
}

void add_draco_options(Options& options, gltf::DracoOptions& draco) {
  options.group("Compression");
  options.flag("--draco", draco.on,
               "compress triangle meshes with KHR_draco_mesh_compression, where that makes them smaller; "
               "rounds vertices to the bits below, of the extent of each mesh, and reorders them",
               Role::content);
  options.add("--draco-level", whole_value<std::uint32_t>(draco.level, 0, 10), "0 is fast, 10 is small",
              Role::content);
  options.add("--draco-position-bits", bits_value(draco.position_bits), "0 keeps them exact", Role::content);
  options.add("--draco-normal-bits", bits_value(draco.normal_bits), "0 keeps them exact", Role::content);
  options.add("--draco-texcoord-bits", bits_value(draco.texcoord_bits), "0 keeps them exact", Role::content);
  options.add("--draco-color-bits", bits_value(draco.color_bits), "of vertex colours; 0 keeps them exact",
              Role::content);
  options.add("--draco-generic-bits", bits_value(draco.generic_bits), "of tangents; 0 keeps them exact",
              Role::content);
}

std::vector<Conflict> conflicts_of_draco(const gltf::DracoOptions& draco) {
  std::vector<Conflict> out;
  if (draco.on) return out;
  for (const char* name : {"--draco-level", "--draco-position-bits", "--draco-normal-bits",
                           "--draco-texcoord-bits", "--draco-color-bits", "--draco-generic-bits"})
    out.push_back({name, "needs --draco"});
  return out;
}

Options generate_options(GenerateRequest& r) {
  Options options("scenegen",
                  {"scenegen [options]              generate a scene",
                   "scenegen animate MODEL -o OUT [options]", "scenegen schedule MODEL PLAN -o OUT [options]",
                   "scenegen inspect FILE [options]", "scenegen diff A B [options]",
                   "scenegen optimize FILE -o OUT [options]", "scenegen sweep CONFIG -o DIR [options]"},
                  "makes a town of brick buildings that goes up along a space-filling curve, as glTF.");
  add_town_options(options, r);
  add_building_options(options, r);
  add_extra_options(options, r);
  add_machine_options(options, r);
  add_appearance_options(options, r);
  add_profile_options(options, r.profile, ProfileSource::curve);
  add_output_options(options, r);
  add_draco_options(options, r.file.draco);
  options.group("General");
  options.add("--threads", whole_value<std::uint32_t>(r.threads, 0, limits::kMaxThreads),
              "0: one per processor; never changes the file");
  options.add_config(r.dump_config);
  options.add_general(r.quiet);
  return options;
}

std::vector<Conflict> conflicts(const GenerateRequest& r) {
  std::vector<Conflict> out = conflicts_of_draco(r.file.draco);
  const auto refuse = [&out](std::initializer_list<const char*> names, const std::string& reason) {
    for (const char* name : names) out.push_back({name, reason});
  };
  if (r.test_set != 0) {
    refuse({"--grid", "--spacing", "--ground", "--brick", "--building-size", "--floor-courses", "--floors",
            "--partitions", "--windows", "--window", "--roof", "--building-model", "--extras",
            "--extra-model", "--machines"},
           "cannot be used with --test-set, which fixes the scene");
  }
  if (!r.town.building_model.empty()) {
    refuse({"--brick", "--building-size", "--floor-courses", "--floors", "--partitions", "--windows",
            "--window", "--roof", "--extras", "--extra-model"},
           "cannot be used with --building-model, which replaces the bricks and their rooms");
  }
  if (!r.town.windows) refuse({"--window"}, "cannot be used with --windows off");
  if (r.town.extras_per_floor == 0) refuse({"--extra-model"}, "needs --extras of 1 or more");
  if (!r.curve) {
    refuse({"--order", "--cells", "--interval", "--hold", "--coherence", "--visibility", "--profile",
            "--profile-duration", "--highlight", "--color", "--drop-height", "--move-offset", "--machines"},
           "cannot be used with --curve none, which makes a static scene");
  } else {
    for (Conflict& conflict : profile_conflicts(r.profile, std::span(&r.profile.profile, 1)))
      out.push_back(std::move(conflict));
  }
  add_stdout_conflicts(r.dry_run ? "" : r.output, r.report, out);
  return out;
}

void settle(GenerateRequest& r) {
  const unsigned processors = std::max(1U, std::thread::hardware_concurrency());
  const unsigned threads = r.threads != 0 ? r.threads : std::min(processors, limits::kMaxThreads);
  r.town.seed = r.seed;
  r.appearance.seed = r.seed;
  r.appearance.threads = threads;
  r.file.threads = threads;
  if (r.curve) r.appearance.curve = *r.curve;
}

std::string layout_name(gltf::Layout layout) {
  return name_in(layouts(), layout);
}

std::string visibility_name(gltf::VisibilityEncoding encoding) {
  return name_in(encodings(), encoding);
}

}  // namespace scenegen::tools
