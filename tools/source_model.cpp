#include "tools/source_model.h"

#include <filesystem>

namespace scenegen::tools {

namespace {

Value up_value(import::UpAxis& target) {
  using import::UpAxis;
  return choice_value<UpAxis>(
      target, {{"auto", UpAxis::automatic}, {"x", UpAxis::x}, {"y", UpAxis::y}, {"z", UpAxis::z}}, "AXIS");
}

Value unit_value(double& target) {
  Value value = real_value(target, 1e-9, 1e9, "M");
  value.spell = [&target] { return target == 0 ? std::string() : shortest(target); };
  return value;
}

}  // namespace

void add_import_options(Options& options, import::ImportOptions& target) {
  options.add("--up", up_value(target.up),
              "the model's axis that points up; auto: what the file says, else what its format means",
              Role::content);
  options.add("--unit", unit_value(target.metres_per_unit), "metres in a unit of the model", Role::content,
              "what the file says, else 1");
}

void add_import_conflicts(const std::string& model, std::vector<Conflict>& conflicts) {
  if (!import::is_gltf(model)) return;
  for (const char* name : {"--up", "--unit"})
    conflicts.push_back({name, "cannot be used with glTF, which is in metres and Y up"});
}

Result<SourceModel> read_source_model(const std::string& path, const import::ImportOptions& options,
                                      gltf::Split split) {
  SourceModel out;
  auto read = import::read_model(path, options);
  if (!read) return forward_error(read);
  for (const gltf::Ignored& left_out : read->ignored) {
    if (left_out.where == path)  // by the import; what a glTF holds beyond a scene stays in its document
      out.notes.push_back("not imported: " + human_count(left_out.count) + " x " + left_out.what);
  }
  if (read->scene.objects.size() == 0)
    return fail(ErrorKind::bad_input, path, "has no objects: no node that is drawn has a mesh");
  if (read->source->merged) {
    const std::string stem = path == "-" ? "model" : std::filesystem::path(path).stem().string();
    return fail(ErrorKind::bad_input, path,
                "is of layout merged, in which objects have no nodes that could get a timeline: scenegen "
                "optimize gives them some (--layout nodes -o " +
                    stem + "_nodes.glb)");
  }
  if (!gltf::needs_restructuring(*read, split)) {
    out.read = std::move(*read);
    return out;
  }
  auto again = gltf::restructure(std::move(*read), split);
  if (!again) return forward_error(again);
  out.read = std::move(again->read);
  out.split_objects = again->split_objects;
  out.expanded = again->expanded;
  out.notes.insert(out.notes.end(), again->notes.begin(), again->notes.end());
  return out;
}

}  // namespace scenegen::tools
