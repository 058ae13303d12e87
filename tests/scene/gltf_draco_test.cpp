// KHR_draco_mesh_compression: streams made by the Draco encoder, whole, damaged and boasting; and our own.
#include <catch2/catch.hpp>

#include "scene/gltf/read.h"
#include "scene/random.h"
#include "scene/validate.h"
#include "tests/support/draco_quad.h"
#include "tests/support/gltf_text.h"

namespace {

using namespace scenegen;

std::string document(const std::vector<std::uint8_t>& stream,
                     const std::string& ids = R"("POSITION":0,"NORMAL":1,"TEXCOORD_0":2)") {
  testing::GltfText g;
  const std::string view = std::to_string(g.view(stream));
  const std::string vec3 = std::to_string(g.accessor_on("", 5126, "VEC3", 4));
  const std::string vec2 = std::to_string(g.accessor_on("", 5126, "VEC2", 4));
  const std::string index = std::to_string(g.accessor_on("", 5123, "SCALAR", 6));
  return g.str(
      R"("extensionsRequired":["KHR_draco_mesh_compression"],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":)" +
      vec3 + ",\"NORMAL\":" + vec3 + ",\"TEXCOORD_0\":" + vec2 + "},\"indices\":" + index +
      R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":)" + view + ",\"attributes\":{" + ids +
      "}}}}]}]");
}

Result<gltf::ReadResult> read_text(const std::string& text) {
  return gltf::read_memory({text.begin(), text.end()}, "f", "");
}

}  // namespace

TEST_CASE("both encoding methods are read") {
  for (const int method : {0, 1}) {
    const std::vector<std::uint8_t> stream = testing::draco_quad(method);
    REQUIRE(!stream.empty());
    const auto read = read_text(document(stream));
    if (!read) FAIL(read.error().str());
    const Geometry& g = read->scene.geometries.at(0);
    CHECK(g.triangle_count() == 2);
    CHECK(g.vertex_count() == 4);
    CHECK(g.bounds().lo == glm::vec3(0));
    CHECK(glm::length(g.bounds().hi - glm::vec3(1, 2, 0)) < 1e-3F);
    CHECK(g.texcoords[0].size() == 4);
    for (const glm::vec3& n : g.normals) CHECK(glm::length(n - glm::vec3(0, 0, 1)) < 1e-2F);
    CHECK(validate(read->scene).empty());
  }
}

TEST_CASE("broken streams") {
  std::vector<std::uint8_t> stream = testing::draco_quad(0);
  const std::string at = "f: /meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
  const auto missing = read_text(document(stream, R"("POSITION":7)"));
  REQUIRE(!missing);
  CHECK(missing.error().str() == at + "/attributes/POSITION: the Draco stream has no attribute 7");
  const auto narrow = read_text(document(stream, R"("POSITION":2)"));
  REQUIRE(!narrow);
  CHECK(narrow.error().what.find("2 components; wanted 3") != std::string::npos);

  std::vector<std::uint8_t> bomb(stream.begin(), stream.begin() + 11);
  for (const int byte : {0xFF, 0xFF, 0xFF, 0xFF, 0x04, 0x04})
    bomb.push_back(static_cast<std::uint8_t>(byte));  // 1.3 G faces
  const auto big = read_text(document(bomb));
  REQUIRE(!big);
  CHECK(big.error().what.find("more triangles than their size allows") != std::string::npos);
  for (const int method : {0, 1}) {
    stream = testing::draco_quad(method);
    const Random random(2, "draco");
    for (std::uint64_t i = 0; i < 3000; ++i) {
      std::vector<std::uint8_t> bad = stream;
      bad[random.below(3 * i, bad.size())] ^= static_cast<std::uint8_t>(1U << random.below(3 * i + 1, 8));
      if (i % 3 == 0) bad.resize(1 + random.below(3 * i + 2, bad.size()));
      const auto read = read_text(document(bad));
      if (read && !validate(read->scene, 1).empty()) FAIL("an invalid scene");
    }
  }
}
