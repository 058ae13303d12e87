// Seeds for the fuzzer: make_corpus FOLDER. Small files of ours in every combination, and documents with what
// we do not write.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "tests/support/draco_quad.h"
#include "tests/support/gltf_text.h"
#include "tests/support/synthetic_scene.h"
#include "tests/timeline/random_scene.h"

namespace {

using namespace scenegen;

bool write_ours(const std::string& folder) {
  struct Source {
    const char* name;
    Scene scene;
  };
  const Source sources[] = {{"everything", testing::everything_scene()},
                            {"town", testing::town_scene(12, 3)},
                            {"kinds", timeline::test::RandomScene(1).make_kinds(16, 2)}};
  for (const Source& source : sources) {
    for (const auto layout :
         {gltf::Layout::nodes, gltf::Layout::groups, gltf::Layout::instances, gltf::Layout::merged}) {
      for (const auto visibility : {gltf::VisibilityEncoding::scale, gltf::VisibilityEncoding::pointer,
                                    gltf::VisibilityEncoding::both}) {
        const std::string path = folder + "/" + source.name + std::to_string(int(layout)) +
                                 std::to_string(int(visibility)) + ".glb";
        const auto written = gltf::write(source.scene, path, {layout, visibility, 1});
        if (written) continue;
        std::fprintf(stderr, "%s\n", written.error().str().c_str());
        return false;
      }
    }
  }
  gltf::WriteOptions small(gltf::Layout::instances, gltf::VisibilityEncoding::scale);
  small.id_table = true;
  small.draco.on = true;
  return gltf::write(testing::town_scene(60, 3), folder + "/id_table.glb", small).has_value();
}

std::string everything_foreign(int draco_method) {
  testing::GltfText g;
  const auto s = [](std::size_t i) { return std::to_string(i); };
  const std::string draco = s(g.view(testing::draco_quad(draco_method)));
  const std::string bare3 = s(g.accessor_on("", 5126, "VEC3", 4));
  const std::string bare2 = s(g.accessor_on("", 5126, "VEC2", 4));
  const std::string bare_index = s(g.accessor_on("", 5123, "SCALAR", 6));
  const std::string values = s(g.view(std::vector<float>{9, 9, 9}));
  const std::string indices = s(g.view(std::vector<std::uint16_t>{1}));
  const std::string sparse =
      s(g.accessor_on("", 5126, "VEC3", 3,
                      R"(,"sparse":{"count":1,"indices":{"bufferView":)" + indices +
                          R"(,"componentType":5123},"values":{"bufferView":)" + values + "}}"));
  const std::string strided =
      s(g.view(std::vector<std::int8_t>{127, 0, 0, 0, 0, 127, 0, 0, 0, 0, -128, 0}, ",\"byteStride\":4"));
  const std::string normal = s(g.accessor_on(strided, 5120, "VEC3", 3, ",\"normalized\":true"));
  const std::string index = s(g.accessor("SCALAR", 3, std::vector<std::uint8_t>{2, 1, 0}));
  const std::string times = s(g.floats("SCALAR", 2, {0, 1}));
  const std::string vec3 = s(g.floats("VEC3", 2, {0, 0, 0, 1, 1, 1}));
  const std::string spline = s(g.floats("VEC3", 6, std::vector<float>(18, 1.0F)));
  const std::string color = s(g.floats("VEC4", 2, {0, 0, 0, 1, 1, 1, 1, 1}));
  const std::string shown = s(g.accessor("SCALAR", 2, std::vector<std::uint8_t>{0, 1}));
  const auto sampler = [&](const std::string& output, const char* interpolation) {
    return "{\"input\":" + times + ",\"output\":" + output + ",\"interpolation\":\"" + interpolation + "\"}";
  };
  const auto pointer = [](int i, const char* to) {
    return "{\"sampler\":" + std::to_string(i) +
           R"(,"target":{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":")" + to +
           R"("}}}})";
  };
  return g.str(
      R"("extensionsUsed":["KHR_lights_punctual"],"extensionsRequired":["KHR_draco_mesh_compression"],"scene":0,"scenes":[{"nodes":[0,2,3]}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":)" +
      bare3 + ",\"NORMAL\":" + bare3 + ",\"TEXCOORD_0\":" + bare2 + "},\"indices\":" + bare_index +
      R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":)" + draco +
      R"(,"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}}}}]},
      {"primitives":[{"mode":1,"attributes":{"POSITION":)" +
      sparse + ",\"NORMAL\":" + normal + "},\"indices\":" + index + R"(,"material":0}]}],
      "images":[{"uri":"data:image/png;base64,iVBORw0KGgo="}],"samplers":[{"wrapS":33071}],"textures":[{"source":0,"sampler":0}],
      "materials":[{"emissiveFactor":[1,1,1],"extensions":{"KHR_materials_unlit":{},"KHR_materials_emissive_strength":{"emissiveStrength":4}},
        "pbrMetallicRoughness":{"baseColorFactor":[1,1,1,1],"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"offset":[0.1,0.2]}}}}}],
      "cameras":[{"perspective":{"yfov":1,"znear":0.1}},{"orthographic":{"xmag":1,"ymag":1,"znear":0,"zfar":5}}],
      "nodes":[{"name":"a\u00e9","mesh":0,"children":[1],"extensions":{"KHR_node_visibility":{"visible":false}}},{"mesh":1,"matrix":[1,0,0,0,0.5,1,0,0,0,0,1,0,0,0,0,1]},
        {"camera":0,"rotation":[0,0,0,1],"skin":0},{"mesh":1,"camera":1,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" +
      vec3 + R"(}}}}],
      "animations":[{"samplers":[)" +
      sampler(vec3, "STEP") + "," + sampler(spline, "CUBICSPLINE") + "," + sampler(color, "LINEAR") + "," +
      sampler(shown, "STEP") +
      R"(],"channels":[{"sampler":0,"target":{"node":0,"path":"scale"}},{"sampler":1,"target":{"node":2,"path":"translation"}},)" +
      pointer(2, "/materials/0/pbrMetallicRoughness/baseColorFactor") + "," +
      pointer(0, "/materials/0/emissiveFactor") + "," +
      pointer(3, "/nodes/0/extensions/KHR_node_visibility/visible") + "]}]");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::string folder = argv[1];
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (!write_ours(folder)) return 1;
  for (const int method : {0, 1})
    std::ofstream(folder + "/foreign" + std::to_string(method) + ".gltf", std::ios::binary)
        << everything_foreign(method);
  for (const auto& entry :
       std::filesystem::directory_iterator(folder)) {  // a seed that is refused at once is no seed
    const auto read = gltf::read(entry.path().string());
    if (read) continue;
    std::fprintf(stderr, "%s\n", read.error().str().c_str());
    return 1;
  }
  return 0;
}
