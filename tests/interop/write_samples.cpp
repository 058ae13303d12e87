// write_samples FOLDER: the test scenes in every layout, visibility encoding and file form, for the
// validator.
#include <filesystem>
#include <iostream>
#include <string>

#include "scene/gltf/write.h"
#include "tests/support/synthetic_scene.h"
#include "tests/timeline/random_scene.h"

namespace {

using scenegen::gltf::Layout;
using scenegen::gltf::VisibilityEncoding;

bool write_all(const scenegen::Scene& scene, const std::filesystem::path& folder, const std::string& name) {
  const std::pair<Layout, const char*> layouts[] = {{Layout::nodes, "nodes"},
                                                    {Layout::groups, "groups"},
                                                    {Layout::instances, "instances"},
                                                    {Layout::merged, "merged"}};
  const std::pair<VisibilityEncoding, const char*> encodings[] = {{VisibilityEncoding::scale, "scale"},
                                                                  {VisibilityEncoding::pointer, "pointer"},
                                                                  {VisibilityEncoding::both, "both"}};
  for (const auto& [layout, layout_name] : layouts) {
    for (const auto& [encoding, encoding_name] : encodings) {
      for (const char* form : {".glb", ".gltf"}) {
        const std::filesystem::path path = folder / (name + "_" + layout_name + "_" + encoding_name + form);
        const auto report = scenegen::gltf::write(scene, path.string(), {layout, encoding, 1});
        if (!report) {
          std::cerr << "error: " << report.error().str() << '\n';
          return false;
        }
      }
    }
  }
  return true;
}

bool write_compressed(const scenegen::Scene& scene, const std::filesystem::path& folder) {
  for (const Layout layout : {Layout::nodes, Layout::instances}) {
    scenegen::gltf::WriteOptions options(layout, VisibilityEncoding::scale);
    options.draco.on = true;
    options.id_table = layout == Layout::instances;
    const std::string name = layout == Layout::nodes ? "draco_nodes.gltf" : "draco_instances.glb";
    const auto report = scenegen::gltf::write(scene, (folder / name).string(), options);
    if (!report || report->draco_geometries == 0) {
      std::cerr << "error: " << (report ? "nothing was compressed" : report.error().str()) << '\n';
      return false;
    }
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write_samples FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  scenegen::Scene bare;  // nothing at all, and one static object
  scenegen::Scene one = scenegen::testing::town_scene(1, 1);
  one.objects.visibility[0] = {};
  one.tracks.clear();
  const bool ok = write_all(scenegen::testing::everything_scene(), folder, "every thing #1") &&
                  write_all(scenegen::testing::town_scene(2400, 64), folder, "town") &&
                  write_compressed(scenegen::testing::town_scene(2400, 64), folder) &&
                  write_all(scenegen::timeline::test::RandomScene(1).make_kinds(90, 5), folder, "kinds") &&
                  write_all(bare, folder, "bare") && write_all(one, folder, "one");
  return ok ? 0 : 1;
}
