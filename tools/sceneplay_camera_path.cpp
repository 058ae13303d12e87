// sceneplay camera-path FILE PATH -o OUT.json: a camera path that other renderers can follow.
#include "scene/gltf/read.h"
#include "tools/camera_paths.h"
#include "tools/output.h"
#include "tools/read_gltf.h"
#include "tools/sceneplay.h"
#include "tools/verb.h"

namespace scenegen::tools {
namespace {

struct CameraPathRequest {
  std::string file, path, output;
  bool quiet = false;
};

Result<void> save(const CameraPathRequest& r) {
  auto read = read_gltf(r.file, {});
  if (!read) return forward_error(read);
  auto path = camera_path_of(r.path, read->scene);
  if (!path) return forward_error(path);
  if (auto written = write_file(r.output, render::camera_path_json(*path)); !written) return written;
  if (r.quiet || r.output == "-") return {};
  const double begin_s = path->keys.front().time_s;
  return write_stdout(r.output + "  " + counted(path->keys.size(), "key") + "  " + human_real(begin_s, 3) +
                      " to " + human_real(path->keys.back().time_s, 3) + " s\n");
}

}  // namespace

int camera_path_verb(std::span<const std::string> arguments) {
  CameraPathRequest r;
  Options options("sceneplay camera-path", {"sceneplay camera-path FILE PATH -o OUT.json"},
                  "writes a camera path that is made from a scene, so that other renderers can follow it.");
  options.positional("FILE", r.file, "a .glb or .gltf file");
  options.positional("PATH", r.path, camera_path_range() + " (docs/CAMERA_PATH.md)");
  options.group("Output");
  options.add("-o,--output", text_value(r.output, "FILE"), "the path as JSON; - for stdout");
  options.group("General");
  options.add_general(r.quiet);
  const auto check = [&]() -> Result<void> {
    if (r.output.empty())
      return fail(ErrorKind::usage, "--output",
                  "missing (usage: sceneplay camera-path FILE PATH -o OUT.json)");
    if (auto known = check_camera_path(r.path); !known) {
      if (known.error().where == "--camera-path") known.error().where = "PATH";
      return known;
    }
    if (auto writable = check_output_file(r.output); !writable) return writable;
    return check_distinct_files({{"--output", r.output}}, {{"FILE", r.file}, {"PATH", r.path}});
  };
  return run_verb(options, arguments, {.check = check, .work = [&]() -> Result<int> {
                                         auto saved = save(r);
                                         return saved ? Result<int>(0) : forward_error(saved);
                                       }});
}

}  // namespace scenegen::tools
