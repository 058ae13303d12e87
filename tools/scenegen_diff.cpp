// scenegen diff A B: are two files the same scene, at every time?
#include "scene/gltf/read.h"
#include "timeline/compare.h"
#include "tools/output.h"
#include "tools/read_gltf.h"
#include "tools/scenegen.h"
#include "tools/verb.h"

namespace scenegen::tools {

namespace {

using nlohmann::ordered_json;

struct DiffRequest {
  std::string a;
  std::string b;
  double tolerance = 1e-5;
  double color_tolerance = 1e-5;
  double geometry_tolerance = 0;
  double normal_tolerance = 0;
  std::uint64_t most = 20;
  Format format = Format::table;
  bool quiet = false;
};

std::string listed(const timeline::Comparison& comparison) {
  std::string out;
  for (const timeline::Difference& difference : comparison.differences) {
    out += difference.where + ": " + difference.what + "\n";
  }
  const std::uint64_t rest = comparison.difference_count - comparison.differences.size();
  if (rest > 0) out += "... and " + human_count(rest) + " more\n";
  return out + "different: " + counted(comparison.difference_count, "difference") + "\n";
}

Report report(const DiffRequest& r, const timeline::Comparison& comparison, std::uint64_t objects) {
  ordered_json list = ordered_json::array();
  for (const timeline::Difference& difference : comparison.differences) {
    list.push_back({{"where", difference.where}, {"what", difference.what}});
  }
  Report out("scenegen/diff", 1);
  out.add({"a", "", r.a, ""});
  out.add({"b", "", r.b, ""});
  out.add({"equal", "", comparison.equal(), ""});
  out.add({"objects", "", objects, ""});
  out.add({"timesCompared", "", comparison.times_compared, ""});
  out.add({"differenceCount", "", comparison.difference_count, ""});
  out.add({"differences", "", std::move(list), ""});
  return out;
}

/// The exit code: 1 when they differ.
Result<int> diff(const DiffRequest& r) {
  auto a = read_gltf(r.a);
  if (!a) return forward_error(a);
  auto b = read_gltf(r.b);
  if (!b) return forward_error(b);
  timeline::CompareOptions options;
  options.transform_tolerance = static_cast<float>(r.tolerance);
  options.color_tolerance = static_cast<float>(r.color_tolerance);
  options.geometry_tolerance = static_cast<float>(r.geometry_tolerance);
  options.normal_tolerance = static_cast<float>(r.normal_tolerance);
  options.most = r.most;
  const timeline::Comparison comparison = timeline::compare(a->scene, b->scene, options);
  const int code = comparison.equal() ? 0 : static_cast<int>(ErrorKind::bad_input);
  const std::uint64_t objects = a->scene.objects.size();
  std::string text;
  if (r.format != Format::table) {
    text = report(r, comparison, objects).str(r.format);
  } else if (r.quiet) {
    return code;
  } else if (comparison.equal()) {
    text = "equal  " + counted(objects, "object") + "  " + counted(comparison.times_compared, "time") +
           " compared\n";
  } else {
    text = listed(comparison);
  }
  if (auto written = write_stdout(text); !written) return forward_error(written);
  return code;
}

}  // namespace

int diff_verb(std::span<const std::string> arguments) {
  DiffRequest request;
  Options options(
      "scenegen diff", {"scenegen diff A B [options]"},
      "compares two glTF files as scenes, at every event time of either; exit code 1 when they differ.");
  options.positional("A", request.a, "a .glb or .gltf file");
  options.positional("B", request.b, "another one");
  options.group("Comparison");
  options.add("--tolerance", real_value(request.tolerance, 0, 1, "X"),
              "of places and sizes, relative to the size of the scene");
  options.add("--color-tolerance", real_value(request.color_tolerance, 0, 1, "X"), "of colours");
  options.add("--geometry-tolerance", real_value(request.geometry_tolerance, 0, 0.1, "X"),
              "of vertex positions and texture coordinates, relative to their extent in the mesh; above 0, "
              "triangles are compared in any order (files made with --draco: 1e-3)");
  options.add("--normal-tolerance", real_value(request.normal_tolerance, 0, 0.5, "X"),
              "of normals, tangents and vertex colours, likewise (files made with --draco: 0.03)");
  options.add("--most", whole_value<std::uint64_t>(request.most, 1, 1'000'000), "differences to list");
  options.group("Output");
  options.add("--format", format_value(request.format), "form of what is printed on stdout");
  options.group("General");
  options.add_general(request.quiet);
  return run_verb(options, arguments, {.work = [&] { return diff(request); }});
}

}  // namespace scenegen::tools
