// Splitting meshes and expanding instances: the same triangles, in more objects.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "scene/gltf/restructure.h"
#include "scene/gltf/restructure_parts.h"
#include "scene/gltf/write.h"
#include "scene/validate.h"
#include "tests/support/gltf_file.h"
#include "tests/support/gltf_text.h"
#include "tests/support/synthetic_scene.h"
#include "timeline/compare.h"

namespace {

using namespace scenegen;
using gltf::Split;
using nlohmann::json;
using testing::GltfText;

gltf::ReadResult read_text(const std::string& text) {
  gltf::ReadOptions options;
  options.keep_source = true;
  auto read = gltf::read_memory({text.begin(), text.end()}, "test.gltf", "", options);
  if (!read) FAIL(read.error().str() << "\n" << text);
  return std::move(*read);
}

gltf::Restructured restructured(gltf::ReadResult read, Split split) {
  auto out = gltf::restructure(std::move(read), split);
  if (!out) FAIL(out.error().str());
  for (const Finding& f : validate(out->read.scene)) FAIL_CHECK(f.where << ": " << f.what);
  return std::move(*out);
}

std::vector<std::string> names(const Scene& scene) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) out.emplace_back(scene.objects.names[i]);
  return out;
}

/// Every corner of everything drawn, in the world, with its attributes and material; elements sorted.
std::vector<std::vector<float>> everything_drawn(const Scene& scene) {
  std::vector<std::vector<float>> out;
  const auto frames = rest_frame_matrices(scene);
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const glm::mat4 world = rest_world_from_object(scene, frames, ObjectId(o));
    for (const Primitive& primitive : scene.meshes[scene.objects.mesh[o].value].primitives) {
      const Geometry& g = scene.geometries[primitive.geometry.value];
      const std::uint32_t size = std::max(gltf::element_size(g.topology), 1U);
      std::vector<std::uint32_t> corners = gltf::element_corners(g);
      for (std::uint32_t v = 0; corners.empty() && v < g.vertex_count(); ++v) corners.push_back(v);
      for (std::size_t c = 0; c < corners.size(); c += size) {
        auto& element = out.emplace_back();
        element.push_back(primitive.material.valid() ? static_cast<float>(primitive.material.value) : -1.0F);
        for (std::size_t k = c; k < c + size; ++k) {
          const std::uint32_t v = corners[k];
          const glm::vec4 p = world * glm::vec4(g.positions_m[v], 1);
          element.insert(element.end(), {p.x, p.y, p.z});
          if (!g.normals.empty()) element.insert(element.end(), &g.normals[v].x, &g.normals[v].x + 3);
          if (!g.tangents.empty()) element.insert(element.end(), &g.tangents[v].x, &g.tangents[v].x + 4);
          for (const auto& uv : g.texcoords)
            if (!uv.empty()) element.insert(element.end(), {uv[v].x, uv[v].y});
          if (!g.colors.empty()) element.insert(element.end(), &g.colors[v].x, &g.colors[v].x + 4);
        }
      }
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// Two quads apart from each other, each of two triangles that share no vertex: connected only by position.
/// The quads' triangles alternate.
struct TwoQuads {
  std::vector<float> positions{0, 0, 0, 1, 0, 0, 1, 1, 0, 5, 0, 0, 6, 0, 0, 6, 1, 0,
                               0, 0, 0, 1, 1, 0, 0, 1, 0, 5, 0, 0, 6, 1, 0, 5, 1, 0};
  std::vector<float> normals;
  std::vector<std::uint8_t> heat;
  TwoQuads() {
    for (std::uint8_t v = 0; v < 12; ++v) {
      normals.insert(normals.end(), {0, v % 2 == 0 ? 0.0F : 1.0F, v % 2 == 0 ? 1.0F : 0.0F});
      heat.insert(heat.end(), {static_cast<std::uint8_t>(10 * v), 1, 2});
    }
  }
};

}  // namespace

TEST_CASE("components are what hangs together by position, with all their attributes") {
  GltfText text;
  const TwoQuads quads;
  const std::string p = std::to_string(text.floats("VEC3", 12, quads.positions));
  const std::string n = std::to_string(text.floats("VEC3", 12, quads.normals));
  const std::string h = std::to_string(text.accessor("VEC3", 12, quads.heat, ",\"normalized\":true"));
  const std::string document = text.str(
      R"("meshes":[{"name":"m","primitives":[{"attributes":{"POSITION":)" + p + ",\"NORMAL\":" + n +
      ",\"_HEAT\":" + h +
      R"(},"extras":{"keep":1}}]}],"nodes":[{"name":"a","mesh":0,"extras":{"tag":"x"}},)" +
      R"({"name":"b","mesh":0,"translation":[0,3,0],"children":[2]},{"name":"c"}],"scenes":[{"nodes":[0,1]}])");
  const gltf::ReadResult before = read_text(document);
  const gltf::Restructured after = restructured(read_text(document), Split::components);
  CHECK(after.split_objects == 2);
  CHECK(after.notes.empty());
  CHECK(names(after.read.scene) == std::vector<std::string>{"a/part_0", "a/part_1", "b/part_0", "b/part_1"});
  CHECK(after.read.scene.objects.mesh[0] == after.read.scene.objects.mesh[2]);  // still shared
  CHECK(everything_drawn(before.scene) == everything_drawn(after.read.scene));
  const auto boxes = object_bounds(after.read.scene);
  CHECK(boxes[0].hi.x == 1.0F);
  CHECK(boxes[1].lo.x == 5.0F);
  const json made = json::parse(after.read.source->json);
  CHECK(made["nodes"][0]["extras"]["tag"] == "x");
  CHECK_FALSE(made["nodes"][0].contains("mesh"));
  CHECK(made["nodes"][2] == json{{"name", "c"}});
  const json& part = made["meshes"].back()["primitives"][0];
  CHECK(part["extras"]["keep"] == 1);
  const json& heat = made["accessors"][part["attributes"]["_HEAT"].get<std::size_t>()];
  CHECK(heat["normalized"] == true);
  CHECK(heat["componentType"] == 5121);
  const json& view = made["bufferViews"][heat["bufferView"].get<std::size_t>()];
  CHECK(view["byteStride"] == 4);
  const auto at = view["byteOffset"].get<std::size_t>() + heat["byteOffset"].get<std::size_t>();
  CHECK(after.read.source->buffers[0][at] == 30);  // vertex 3 is the second quad's first
  CHECK(after.read.source->buffers[0][at + 4] == 40);
}

TEST_CASE("strips, fans and lines come apart like lists") {
  for (const int mode : {1, 5, 6}) {
    GltfText text;
    // Two far pieces in one strip: degenerate triangles of equal corners join them by index, as exporters do.
    const std::string p = std::to_string(
        text.floats("VEC3", 8, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 9, 0, 0, 9, 1, 0, 8, 0, 0, 8, 1, 0}));
    const gltf::ReadResult before = read_text(text.str(
        R"("meshes":[{"primitives":[{"mode":)" + std::to_string(mode) + R"(,"attributes":{"POSITION":)" + p +
        R"(}}]}],"nodes":[{"name":"n","mesh":0}],"scenes":[{"nodes":[0]}])"));
    gltf::ReadResult copy = before;
    const gltf::Restructured after = restructured(std::move(copy), Split::components);
    INFO("mode " << mode);
    CHECK(everything_drawn(before.scene) == everything_drawn(after.read.scene));
    CHECK(after.read.scene.objects.size() == (mode == 1 ? 4 : 1));
  }
}

TEST_CASE("primitives become parts with vertices of their own only where they share them") {
  GltfText text;
  const TwoQuads quads;
  const std::string p = std::to_string(text.floats("VEC3", 12, quads.positions));
  const std::string near = std::to_string(text.accessor<std::uint16_t>("SCALAR", 6, {0, 1, 2, 6, 7, 8}));
  const std::string far = std::to_string(text.accessor<std::uint16_t>("SCALAR", 6, {3, 4, 5, 9, 10, 11}));
  const auto primitive = [&](const std::string& indices) {
    return R"({"attributes":{"POSITION":)" + p + R"(},"indices":)" + indices + "}";
  };
  const std::string document =
      text.str(R"("meshes":[{"primitives":[)" + primitive(near) + "," + primitive(far) +
               R"(]}],"nodes":[{"name":"n","mesh":0}],"scenes":[{"nodes":[0]}])");
  const gltf::ReadResult before = read_text(document);
  const gltf::Restructured after = restructured(read_text(document), Split::primitives);
  CHECK(names(after.read.scene) == std::vector<std::string>{"n/part_0", "n/part_1"});
  CHECK(everything_drawn(before.scene) == everything_drawn(after.read.scene));
  CHECK(object_bounds(after.read.scene)[1].lo.x == 5.0F);
}

TEST_CASE("morphed, skinned and single-piece meshes stay whole, and it is said") {
  GltfText text;
  const TwoQuads quads;
  const std::string p = std::to_string(text.floats("VEC3", 12, quads.positions));
  const std::string one = std::to_string(text.floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0}));
  const gltf::ReadResult before = read_text(text.str(
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":)" + p + R"(},"targets":[{"POSITION":)" + p +
      R"(}]}]},{"primitives":[{"attributes":{"POSITION":)" + p +
      R"(}}]},{"primitives":[{"attributes":{"POSITION":)" + one +
      R"(}}]}],"skins":[{"joints":[0]}],"nodes":[{"name":"morph","mesh":0},{"name":"skin","mesh":1,"skin":0},)" +
      R"({"name":"one","mesh":2}],"scenes":[{"nodes":[0,1,2]}])"));
  gltf::ReadResult copy = before;
  const gltf::Restructured after = restructured(std::move(copy), Split::components);
  CHECK(names(after.read.scene) == std::vector<std::string>{"morph", "skin", "one"});
  CHECK(after.split_objects == 0);
  CHECK(after.notes ==
        std::vector<std::string>{"left whole: 1 that have morph targets", "left whole: 1 that are skinned"});
}

TEST_CASE("instances become nodes with the names they had") {
  const testing::TemporaryFolder folder;
  gltf::WriteOptions options;
  options.layout = gltf::Layout::instances;
  REQUIRE(gltf::write(testing::town_scene(500, 7), folder.path("town.glb"), options));
  gltf::ReadOptions keep;
  keep.keep_source = true;
  const auto before = gltf::read(folder.path("town.glb"), keep);
  REQUIRE(before);
  REQUIRE(gltf::needs_restructuring(*before, Split::none));
  const gltf::Restructured after = restructured(*before, Split::none);
  CHECK(after.expanded > 400);
  CHECK(after.read.source->instance_of_object.empty());
  CHECK(after.read.source->json.find("EXT_mesh_gpu_instancing") == std::string::npos);
  const timeline::Comparison same = timeline::compare(before->scene, after.read.scene);
  CHECK(same.equal());
  for (const auto& d : same.differences) UNSCOPED_INFO(d.where << ": " << d.what);
  CHECK(names(before->scene) == names(after.read.scene));  // in the same order
  CHECK_FALSE(gltf::needs_restructuring(after.read, Split::none));
}

TEST_CASE("every model of the corpus draws the same after a split") {
  std::size_t models = 0;
  std::size_t split = 0;
  std::vector<std::string> paths;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::string(ASSIMP_TESTMODELS) + "/glTF2")) {
    if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb")
      paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  for (const std::string& path : paths) {
    gltf::ReadOptions keep;
    keep.keep_source = true;
    const auto before = gltf::read(path, keep);
    if (!before) continue;
    ++models;
    for (const Split how : {Split::primitives, Split::components}) {
      INFO(path << " " << static_cast<int>(how));
      const gltf::Restructured after = restructured(*before, how);
      split += after.split_objects;
      const bool same = everything_drawn(before->scene) == everything_drawn(after.read.scene);
      CHECK(same);
    }
  }
  CHECK(models > 25);
  CHECK(split > 50);
}
