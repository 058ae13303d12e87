// Other people's glTF: what of it becomes a scene, and what is said to be ignored.
#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "scene/gltf/read.h"
#include "scene/validate.h"
#include "tests/support/gltf_text.h"

namespace {

using namespace scenegen;
using testing::GltfText;

gltf::ReadResult read_text(const std::string& text, const std::string& folder = "") {
  auto read = gltf::read_memory({text.begin(), text.end()}, "test.gltf", folder);
  if (!read) FAIL(read.error().str() << "\n" << text);
  for (const Finding& f : validate(read->scene))
    FAIL_CHECK("rule " << f.rule << ": " << f.where << ": " << f.what);
  return std::move(*read);
}

std::string s(std::size_t i) {
  return std::to_string(i);
}

/// Animation of sampler i for target i.
std::string animation(
    const std::vector<std::array<std::string, 4>>& channels) {  // input, output, interpolation, target
  std::string samplers, list;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const auto& [input, output, interpolation, target] = channels[i];
    samplers += (i == 0 ? "" : ",") + std::string("{\"input\":") + input + ",\"output\":" + output +
                ",\"interpolation\":\"" + interpolation + "\"}";
    list += (i == 0 ? "" : ",") + std::string("{\"sampler\":") + s(i) + ",\"target\":" + target + "}";
  }
  return "\"animations\":[{\"samplers\":[" + samplers + "],\"channels\":[" + list + "]}]";
}

std::string pointer(const std::string& to) {
  return R"({"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":")" + to + R"("}}})";
}

std::vector<float> to_vector(std::span<const float> v) {
  return {v.begin(), v.end()};
}

const gltf::Ignored* find_ignored(const gltf::ReadResult& r, std::string_view what) {
  for (const gltf::Ignored& i : r.ignored) {
    if (i.what == what) return &i;
  }
  return nullptr;
}

}  // namespace

TEST_CASE("a static file without scenes: every root, transforms bit for bit") {
  GltfText g;
  const std::string mesh = g.triangle_mesh();
  const auto r = read_text(g.str(mesh + R"(,"nodes":[
      {"mesh":0,"translation":[0.1,0.2,0.3],"rotation":[0,0.7071068,0,0.7071068],"scale":[1,2,3]},
      {"name":"group","children":[2,3]},{"mesh":0,"name":"a"},{"mesh":0,"name":"a"}])"));
  const Scene& scene = r.scene;
  REQUIRE(scene.objects.size() == 3);
  CHECK(scene.objects.names[0] == "node_0");
  CHECK(scene.objects.names[1] == "a");
  CHECK(scene.objects.names[2] == "a_2");
  CHECK(scene.frames.empty());  // "group" is bare
  CHECK(scene.objects.frame_from_object[0].translation_m == glm::vec3(0.1F, 0.2F, 0.3F));
  CHECK(scene.objects.frame_from_object[0].rotation.y == 0.7071068F);
  CHECK(scene.objects.frame_from_object[0].scale == glm::vec3(1, 2, 3));
  CHECK(r.ignored.empty());
  CHECK(scene.geometries[0].triangle_count() == 1);
}

TEST_CASE("the members of a document may come in any order") {
  GltfText g;
  const std::string mesh = g.triangle_mesh();
  std::string text = g.str(mesh);
  text = R"({"nodes":[{"mesh":0}],"scene":0,"scenes":[{"nodes":[0]}],)" + text.substr(1);
  CHECK(read_text(text).scene.objects.size() == 1);
}

TEST_CASE("parents that are not bare become frames, matrices decompose where they can") {
  GltfText g;
  const std::string mesh = g.triangle_mesh();
  const auto r = read_text(g.str(mesh + R"(,"scene":0,"scenes":[{"nodes":[0,3,4]}],"nodes":[
      {"name":"moved","translation":[1,0,0],"children":[1,2]},{"mesh":0,"translation":[0,1,0]},{"name":"empty"},
      {"mesh":0,"matrix":[2,0,0,0, 0,3,0,0, 0,0,4,0, 5,6,7,1]},
      {"mesh":0,"matrix":[1,0,0,0, 0.5,1,0,0, 0,0,1,0, 0,0,0,1]},{"mesh":0,"name":"outside"}])"));
  const Scene& scene = r.scene;
  REQUIRE(scene.objects.size() == 3);
  REQUIRE(scene.frames.size() == 2);
  CHECK(scene.frames[0].name == "moved");
  CHECK(scene.objects.frame_from_object[0].translation_m == glm::vec3(0, 1, 0));
  CHECK(scene.objects.frame[0] == FrameId(0));
  CHECK(!scene.objects.frame[1].valid());
  CHECK(scene.objects.frame_from_object[1].scale == glm::vec3(2, 3, 4));
  CHECK(scene.objects.frame_from_object[1].translation_m == glm::vec3(5, 6, 7));
  CHECK(scene.objects.frame[2] == FrameId(1));
  CHECK(scene.frames[1].has_matrix);
  CHECK(scene.frames[1].matrix[1][0] == 0.5F);
  REQUIRE(find_ignored(r, "nodes outside the scene") != nullptr);
  CHECK(find_ignored(r, "nodes outside the scene")->where == "/nodes/5");
}

TEST_CASE("sparse, strided, normalised and missing data") {
  GltfText g;
  const std::size_t values = g.view(std::vector<float>{9, 9, 9});
  const std::size_t indices = g.view(std::vector<std::uint16_t>{1});
  const std::size_t sparse =
      g.accessor_on("", 5126, "VEC3", 3,
                    ",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":" + s(indices) +
                        ",\"componentType\":5123},\"values\":{\"bufferView\":" + s(values) + "}}");
  const std::size_t strided =
      g.view(std::vector<std::int8_t>{127, 0, 0, 0, 0, 127, 0, 0, 0, 0, -128, 0}, ",\"byteStride\":4");
  const std::size_t normal = g.accessor_on(s(strided), 5120, "VEC3", 3, ",\"normalized\":true");
  const std::size_t color = g.accessor(
      "VEC3", 3, std::vector<std::uint16_t>{65535, 0, 0, 0, 65535, 0, 0, 0, 65535}, ",\"normalized\":true");
  const std::size_t index = g.accessor("SCALAR", 3, std::vector<std::uint8_t>{2, 1, 0});
  const auto r = read_text(g.str("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":" + s(sparse) +
                                 ",\"NORMAL\":" + s(normal) + ",\"COLOR_0\":" + s(color) +
                                 "},\"indices\":" + s(index) + "}]}],\"nodes\":[{\"mesh\":0}]"));
  const Geometry& geometry = r.scene.geometries.at(0);
  CHECK(geometry.positions_m == std::vector<glm::vec3>{{0, 0, 0}, {9, 9, 9}, {0, 0, 0}});
  CHECK(geometry.normals == std::vector<glm::vec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}});
  CHECK(geometry.colors == std::vector<glm::vec4>{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}});
  CHECK(geometry.indices == std::vector<std::uint32_t>{2, 1, 0});
}

TEST_CASE("a STEP scale between (0,0,0) and one value is visibility, anything else moves a frame") {
  GltfText g;
  const std::string mesh = g.triangle_mesh();
  const std::string times = s(g.floats("SCALAR", 3, {0, 1, 2}));
  const std::string appear = s(g.floats("VEC3", 3, {0, 0, 0, 2, 2, 2, 0, 0, 0}));
  const std::string grow = s(g.floats("VEC3", 3, {0, 0, 0, 1, 1, 1, 2, 2, 2}));
  const auto r = read_text(g.str(mesh + R"(,"nodes":[{"mesh":0},{"mesh":0},{"mesh":0}],)" +
                                 animation({{times, appear, "STEP", R"({"node":0,"path":"scale"})"},
                                            {times, grow, "STEP", R"({"node":1,"path":"scale"})"},
                                            {times, appear, "LINEAR", R"({"node":2,"path":"scale"})"}})));
  const Scene& scene = r.scene;
  REQUIRE(scene.objects.visibility[0].valid());
  CHECK(to_vector(scene.values(scene.objects.visibility[0])) == std::vector<float>{0, 1, 0});
  CHECK(scene.objects.frame_from_object[0].scale == glm::vec3(2));
  CHECK(!scene.objects.frame[0].valid());
  for (const std::size_t i : {1, 2}) {
    CHECK(!scene.objects.visibility[i].valid());
    CHECK(scene.objects.frame[i].valid());
    CHECK(scene.objects.frame_from_object[i] == Transform());
  }
  CHECK(scene.frame_tracks.size() == 2);
  CHECK(scene.duration_s == 2.0F);
}

TEST_CASE("visibility of ancestors is and-ed, equal tracks become one") {
  GltfText g;
  const std::string mesh = g.triangle_mesh();
  const std::string times = s(g.floats("SCALAR", 2, {0, 1}));
  const std::string later = s(g.floats("SCALAR", 3, {0, 2, 3}));
  const std::string on = s(g.accessor("SCALAR", 2, std::vector<std::uint8_t>{0, 1}));
  const std::string off = s(g.accessor("SCALAR", 3, std::vector<std::uint8_t>{1, 0, 1}));
  const std::string v = R"(,"extensions":{"KHR_node_visibility":{}}})";
  const std::string hidden = R"(,"extensions":{"KHR_node_visibility":{"visible":false}}})";
  const std::string to = "/extensions/KHR_node_visibility/visible";
  const auto r = read_text(g.str(mesh + R"(,"nodes":[{"children":[1,2,3])" + v + R"(,{"mesh":0)" + v +
                                 R"(,{"mesh":0},{"mesh":0},{"mesh":0)" + hidden + R"(,{"mesh":0}],)" +
                                 animation({{times, on, "STEP", pointer("/nodes/0" + to)},
                                            {later, off, "STEP", pointer("/nodes/1" + to)}})));
  const Scene& scene = r.scene;
  REQUIRE(scene.objects.size() == 5);  // nodes 1 … 5
  CHECK(to_vector(scene.times_s(scene.objects.visibility[0])) == std::vector<float>{0, 1, 2, 3});
  CHECK(to_vector(scene.values(scene.objects.visibility[0])) == std::vector<float>{0, 1, 0, 1});
  CHECK(to_vector(scene.times_s(scene.objects.visibility[1])) == std::vector<float>{0, 1});
  CHECK(scene.objects.visibility[1] == scene.objects.visibility[2]);
  CHECK(to_vector(scene.values(scene.objects.visibility[3])) == std::vector<float>{0});
  CHECK(!scene.objects.visibility[4].valid());
  CHECK(scene.tracks.size() == 3);
}

TEST_CASE("pointers: transforms and colours are played, others are named") {
  GltfText g;
  const std::string mesh = g.triangle_mesh();
  const std::string times = s(g.floats("SCALAR", 2, {0.5F, 1}));
  const std::string vec3 = s(g.floats("VEC3", 2, {0, 0, 0, 1, 0.5F, 0.25F}));
  const std::string vec4 = s(g.floats("VEC4", 2, {0, 0, 0, 1, 1, 1, 1, 1}));
  const std::string one = s(g.floats("SCALAR", 2, {0, 1}));
  const auto r = read_text(g.str(
      mesh +
      R"(,"materials":[{"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4}},"emissiveFactor":[1,1,1]}],
        "nodes":[{"mesh":0}],)" +
      animation({{times, vec3, "LINEAR", pointer("/nodes/0/translation")},
                 {times, vec4, "LINEAR", pointer("/materials/0/pbrMetallicRoughness/baseColorFactor")},
                 {times, vec3, "LINEAR", pointer("/materials/0/emissiveFactor")},
                 {times, one, "LINEAR", pointer("/materials/0/pbrMetallicRoughness/roughnessFactor")},
                 {times, one, "LINEAR", R"({"node":0,"path":"weights"})"}})));
  const Scene& scene = r.scene;
  REQUIRE(scene.material_tracks.size() == 2);
  REQUIRE(scene.frame_tracks.size() == 1);
  CHECK(scene.tracks[scene.frame_tracks[0].track.value].property == Property::translation);
  CHECK(scene.materials[0].emissive == glm::vec3(4));
  CHECK(to_vector(scene.values(scene.material_tracks[1].track)) == std::vector<float>{0, 0, 0, 4, 2, 1});
  const gltf::Ignored* const rough =
      find_ignored(r, "animation of /materials/*/pbrMetallicRoughness/roughnessFactor");
  REQUIRE(rough != nullptr);
  CHECK(rough->where == "/materials/0/pbrMetallicRoughness/roughnessFactor");
  CHECK(find_ignored(r, "animation of morph weights") != nullptr);
}

TEST_CASE("instances of a foreign file") {
  GltfText g;
  const std::string mesh = g.triangle_mesh();
  const std::string at = s(g.floats("VEC3", 3, {1, 0, 0, 2, 0, 0, 3, 0, 0}));
  const std::string turn = s(g.accessor(
      "VEC4", 3, std::vector<std::int8_t>{0, 0, 0, 127, 127, 0, 0, 0, 0, 90, 0, 90}, ",\"normalized\":true"));
  const auto r = read_text(g.str(
      mesh +
      R"(,"extensionsRequired":["EXT_mesh_gpu_instancing"],"nodes":[{"name":"tree","mesh":0,"translation":[0,5,0],
      "extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" +
      at + ",\"ROTATION\":" + turn + R"(,"_AGE":0}}}}])"));
  const Scene& scene = r.scene;
  REQUIRE(scene.objects.size() == 3);
  CHECK(scene.objects.names[2] == "tree/2");
  CHECK(scene.objects.frame_from_object[1].translation_m == glm::vec3(2, 0, 0));
  CHECK(scene.objects.frame_from_object[1].rotation.x == 1.0F);
  CHECK(std::abs(glm::length(scene.objects.frame_from_object[2].rotation) - 1) < 1e-6F);
  REQUIRE(scene.frames.size() == 1);
  CHECK(scene.frames[0].local.translation_m == glm::vec3(0, 5, 0));
  CHECK(find_ignored(r, "instance attribute _AGE") != nullptr);
}

TEST_CASE("materials") {
  GltfText g;
  const std::string mesh = g.triangle_mesh();
  const auto r = read_text(g.str(
      mesh + R"(,"nodes":[{"mesh":0}],"extensionsUsed":["KHR_materials_clearcoat","KHR_lights_punctual"],
      "images":[{"uri":"data:image/png;base64,iVBORw0KGgo="},{"uri":"data:image/webp;base64,UklGRg=="}],
      "samplers":[{"magFilter":9728,"wrapS":33071}],
      "textures":[{"source":0,"sampler":0},{"source":1}],
      "materials":[{"name":"m","alphaMode":"MASK","doubleSided":true,"extensions":{"KHR_materials_unlit":{},"KHR_materials_clearcoat":{}},
        "pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,0.75],"metallicFactor":0,"roughnessFactor":0.5,
          "baseColorTexture":{"index":0,"texCoord":0,"extensions":{"KHR_texture_transform":{"offset":[0.1,0.2],"rotation":1.5,"scale":[2,3],"texCoord":1}}}},
        "normalTexture":{"index":1,"scale":0.5},"occlusionTexture":{"index":0,"texCoord":5}}])"));
  const Material& m = r.scene.materials.at(0);
  CHECK(m.base_color == glm::vec4(0.5F, 0.25F, 1, 0.75F));
  CHECK(m.alpha_mode == AlphaMode::mask);
  CHECK(m.unlit);
  CHECK(m.double_sided);
  CHECK(m.metallic == 0);
  CHECK(m.base_color_texture.texcoord == 1);
  CHECK(m.base_color_texture.uv_offset == glm::vec2(0.1F, 0.2F));
  CHECK(m.base_color_texture.uv_rotation_rad == 1.5F);
  CHECK(m.base_color_texture.uv_scale == glm::vec2(2, 3));
  CHECK(m.normal_texture.strength == 0.5F);
  CHECK(!m.occlusion_texture.texture.valid());
  CHECK(r.scene.textures[0].sampler.wrap_s == 33071);
  CHECK(r.scene.textures[0].image == ImageId(0));
  CHECK(!r.scene.textures[1].image.valid());
  CHECK(r.scene.images[0].mime_type == "image/png");
  CHECK(find_ignored(r, "KHR_materials_clearcoat")->where ==
        "/materials/0/extensions/KHR_materials_clearcoat");
  CHECK(find_ignored(r, "KHR_lights_punctual")->where == "/extensionsUsed/1");
  CHECK(find_ignored(r, "images that are neither PNG nor JPEG") != nullptr);
  CHECK(find_ignored(r, "textures on TEXCOORD_2 and above") != nullptr);
}

TEST_CASE("cubic splines, cameras on moving nodes, escaped names, several animations") {
  GltfText g;
  const std::string mesh = g.triangle_mesh();
  const std::string times = s(g.floats("SCALAR", 2, {0, 4}));
  const std::string spline = s(g.floats("VEC3", 6, {0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 2, 2, 2, 0, 0, 0}));
  std::string play = animation({{times, spline, "CUBICSPLINE", R"({"node":0,"path":"translation"})"}});
  play.insert(play.size() - 1, R"(,{"samplers":[],"channels":[]})");
  const auto r = read_text(g.str(mesh + R"(,"cameras":[{"perspective":{"yfov":0.5,"znear":0.1}}],
      "nodes":[{"name":"B\u00fchne \"1\"","mesh":0,"camera":0,"scale":[1,1,2]}],)" +
                                 play));
  CHECK(r.scene.objects.names[0] == "B\xC3\xBChne \"1\"");
  REQUIRE(r.scene.frames.size() == 1);
  CHECK(r.scene.frames[0].local.scale == glm::vec3(1, 1, 2));
  REQUIRE(r.scene.cameras.size() == 1);
  CHECK(r.scene.cameras[0].frame == FrameId(0));
  CHECK(r.scene.cameras[0].zfar_m == 0);
  CHECK(r.scene.values(r.scene.frame_tracks[0].track).size() == 18);
  CHECK(find_ignored(r, "animations behind the first")->count == 1);
}

TEST_CASE("skins and morph targets are drawn at rest, and said to be") {
  GltfText g;
  const std::string position = s(g.floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0}));
  const auto r = read_text(
      g.str(R"("meshes":[{"primitives":[{"attributes":{"POSITION":)" + position + R"(,"JOINTS_0":)" +
            position + R"(},"targets":[{"POSITION":)" + position +
            R"(}]}]}],"skins":[{"joints":[0]}],"nodes":[{"mesh":0,"skin":0},{"mesh":0,"skin":0}])"));
  CHECK(r.scene.objects.size() == 2);
  CHECK(find_ignored(r, "skins are drawn at rest")->count == 2);
  CHECK(find_ignored(r, "morph targets are drawn at rest")->where == "/meshes/0/primitives/0/targets");
  CHECK(find_ignored(r, "vertex attribute JOINTS_0") != nullptr);
}

TEST_CASE("files beside the document: percent-encoding, folders, what is refused") {
  std::string name = (std::filesystem::temp_directory_path() / "scenegen_read_XXXXXX").string();
  REQUIRE(mkdtemp(name.data()) != nullptr);
  const std::filesystem::path folder = name;
  std::filesystem::create_directory(folder / "sub");
  const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::ofstream(folder / "a b.bin", std::ios::binary)
      .write(reinterpret_cast<const char*>(positions), sizeof positions);
  const auto text = [](const std::string& uri) {
    return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":")" + uri +
           R"("}],"bufferViews":[{"buffer":0,"byteLength":36}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"images":[{"uri":"missing.png"}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]})";
  };
  const auto read_as = [&](const std::string& uri, const char* file) {
    std::ofstream(folder / file) << text(uri);
    return gltf::read((folder / file).string());
  };
  const auto good = read_as("a%20b.bin", "x.gltf");
  REQUIRE(good);
  CHECK(good->scene.geometries[0].positions_m[1] == glm::vec3(1, 0, 0));
  CHECK(find_ignored(*good, "image files that cannot be read")->where == "/images/0/uri");
  CHECK(read_as("../a%20b.bin", "sub/x.gltf"));
  std::ofstream(folder / "missing.png") << "x";
  std::filesystem::resize_file(folder / "missing.png", 70U << 20);  // images may be larger than all the rest
  const auto large = read_as("a%20b.bin", "x.gltf");
  REQUIRE(large);
  CHECK(large->scene.images[0].bytes.size() == 70U << 20);
  CHECK(find_ignored(*large, "images that are neither PNG nor JPEG") != nullptr);
  const auto missing = read_as("c.bin", "x.gltf");
  REQUIRE(!missing);
  CHECK(missing.error().kind == ErrorKind::io);
  for (const char* const uri :
       {"http://a/b.bin", "file:///etc/passwd", "/etc/passwd", "a%00.bin", "a%2", "", "."}) {
    INFO(uri);
    CHECK(!read_as(uri, "x.gltf"));
  }
  const std::string plain = text("a%20b.bin");
  const auto no_folder = gltf::read_memory({plain.begin(), plain.end()}, "x", "");
  REQUIRE(!no_folder);
  CHECK(no_folder.error().where == "x: /buffers/0/uri");
  CHECK(gltf::read((folder / "none.glb").string()).error().kind == ErrorKind::io);
  CHECK(gltf::read(folder.string()).error().kind == ErrorKind::io);
  std::filesystem::remove_all(folder);
}

TEST_CASE("numbers of many digits are read right") {
  const gltf::ReadResult read = read_text(
      R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{}}]}],"nodes":[{"mesh":0,"translation":)"
      R"([-0.07904822439840125109869401756656,123456789.12345678901234567890,0.00000000000000000000000012345678]}]})");
  const glm::vec3 t = read.scene.objects.frame_from_object.at(0).translation_m;
  CHECK(t.x == -0.0790482244F);
  CHECK(t.y == 123456792.0F);
  CHECK(t.z == 1.2345678e-25F);
}
