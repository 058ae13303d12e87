// write_samples FOLDER: the test scenes in every layout, visibility encoding and file form, for the
// validator.
#include <filesystem>
#include <iostream>
#include <string>

#include "scene/gltf/patch.h"
#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "tests/support/patch_sources.h"
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

/// Times for every object (the skinned one: only by pointer), a fall and a look for some.
void author(scenegen::Scene& scene, bool by_pointer) {
  scenegen::Material highlight;
  highlight.name = "highlight";
  const scenegen::MaterialId material(scene.materials.size());
  scene.materials.push_back(highlight);
  const std::size_t objects = scene.objects.size();
  for (std::uint32_t i = 0; i < objects; ++i) {
    const bool skinned = scene.objects.names[i] == "Skinned";
    const float shown[] = {0.0F, 0.5F * static_cast<float>(i + 1)}, visible[] = {0, 1};
    if (!skinned || by_pointer)
      scene.objects.visibility[i] =
          scene.add_track(scenegen::Property::visibility, scenegen::Interpolation::step, shown, visible);
    if (!skinned && i % 3 == 0 && scene.objects.frame_from_object[i].scale != glm::vec3(0.0F)) {
      const float fall[] = {0, 3, 0, 0, 0, 0};
      const scenegen::FrameId frame(scene.frames.size());
      scene.frames.push_back({"fall", scene.objects.frame[i], {}, false, glm::mat4(1.0F)});
      scene.objects.frame[i] = frame;
      scene.frame_tracks.push_back({frame, scene.add_track(scenegen::Property::translation,
                                                           scenegen::Interpolation::linear, shown, fall)});
    }
    if (!skinned && i % 3 != 1) {
      scenegen::Mesh mesh = scene.meshes[scene.objects.mesh[i].value];
      for (scenegen::Primitive& p : mesh.primitives) p.material = material;
      const float looks[] = {static_cast<float>(scene.meshes.size()),
                             static_cast<float>(scene.objects.mesh[i].value)};
      scene.meshes.push_back(mesh);
      scene.object_mesh_tracks.push_back(
          {scenegen::ObjectId(i),
           scene.add_track(scenegen::Property::mesh, scenegen::Interpolation::step, shown, looks)});
    }
  }
  scene.duration_s = 0.5F * static_cast<float>(objects + 2);
  const float times[] = {0, 1}, colors[] = {1, 0, 0, 1, 0, 1, 0, 1};
  scene.material_tracks.push_back(
      {material,
       scene.add_track(scenegen::Property::base_color, scenegen::Interpolation::linear, times, colors)});
}

/// A document of another program, given times in every encoding and form.
bool patch_all(const std::filesystem::path& folder) {
  const std::filesystem::path input = folder / "source.gltf";
  scenegen::testing::write_everything_document(input.string());
  const auto source = scenegen::gltf::read(input.string(), {true, 1});
  for (const auto encoding :
       {VisibilityEncoding::scale, VisibilityEncoding::pointer, VisibilityEncoding::both}) {
    if (!source) break;
    scenegen::Scene scene = source->scene;
    author(scene, encoding == VisibilityEncoding::pointer);
    for (const char* form : {".glb", ".gltf"}) {
      const std::string name = "patched_" + std::to_string(static_cast<int>(encoding)) + form;
      const auto report =
          scenegen::gltf::patch(*source->source, scene, (folder / name).string(), {encoding, {}});
      if (report) continue;
      std::cerr << "error: " << report.error().str() << '\n';
      return false;
    }
  }
  return source.has_value();
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
                  write_all(bare, folder, "bare") && write_all(one, folder, "one") && patch_all(folder);
  return ok ? 0 : 1;
}
