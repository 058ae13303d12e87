#include "gen/model.h"

#include <utility>

#include "scene/gltf/read.h"

namespace scenegen::gen {

Result<Scene> read_model(const std::string& path, const char* option, std::vector<std::string>& notes) {
  Result<gltf::ReadResult> read = gltf::read(path);
  if (!read) return forward_error(read);
  Scene& scene = read->scene;
  if (model_bounds(scene).empty()) {
    return fail(ErrorKind::bad_input, path,
                std::string("holds nothing to show, so it cannot serve as ") + option);
  }
  if (!scene.tracks.empty())
    notes.push_back(path + ": its timelines are left out; it is used as it is at rest");
  for (const gltf::Ignored& ignored : read->ignored)
    notes.push_back(path + ": " + ignored.where + ": " + ignored.what);
  return std::move(scene);
}

Box model_bounds(const Scene& scene) {
  Box bounds;
  for (const Box& b : object_bounds(scene)) bounds.add(b);
  return bounds;
}

}  // namespace scenegen::gen
