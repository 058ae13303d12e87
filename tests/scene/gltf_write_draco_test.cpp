// --draco: what the writer compresses, what it leaves alone, and that the scene is the same within rounding.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "scene/gltf/write_draco.h"
#include "scene/random.h"
#include "tests/support/gltf_file.h"
#include "tests/support/synthetic_scene.h"
#include "timeline/compare.h"

namespace {

using namespace scenegen;
using nlohmann::json;

/// A bumpy sphere with normals, texture coordinates and, if wanted, tangents and colors; one seam.
Geometry globe(std::uint32_t slices, bool all_streams = false) {
  Geometry g;
  const std::uint32_t stacks = slices / 2;
  for (std::uint32_t y = 0; y <= stacks; ++y) {
    for (std::uint32_t x = 0; x <= slices; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(slices);
      const float v = static_cast<float>(y) / static_cast<float>(stacks);
      const float around = 6.2831853F * static_cast<float>(x % slices) / static_cast<float>(slices);
      const glm::vec3 n(std::sin(3.1415927F * v) * std::cos(around), std::cos(3.1415927F * v),
                        std::sin(3.1415927F * v) * std::sin(around));
      g.positions_m.push_back(n * (2.0F + 0.1F * std::sin(5.0F * around) * std::sin(9.0F * v)));
      g.normals.push_back(n);
      g.texcoords[0].emplace_back(u, v);
      if (!all_streams) continue;
      g.texcoords[1].emplace_back(v, 3.0F * u);
      g.tangents.emplace_back(1, 0, 0, x < slices / 2 ? 1 : -1);
      g.colors.emplace_back(u, v, 0.5F, 1.0F);
    }
  }
  for (std::uint32_t y = 0; y < stacks; ++y) {
    for (std::uint32_t x = 0; x < slices; ++x) {
      const std::uint32_t a = y * (slices + 1) + x, b = a + slices + 1;
      for (const std::uint32_t i : {a, a + 1, b, b, a + 1, b + 1}) g.indices.push_back(i);
    }
  }
  return g;
}

Geometry triangle() {
  Geometry g;
  g.positions_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  return g;
}

/// Objects 0 and 1 share the globe; a strip, a line and a triangle that Draco would only make larger.
Scene sample() {
  Scene s;
  Geometry strip = globe(16);
  strip.topology = Topology::triangle_strip;
  Geometry line = triangle();
  line.topology = Topology::line_strip;
  s.geometries = {globe(64), strip, line, triangle(), globe(24, true)};
  s.materials.resize(2);
  for (std::uint32_t g = 0; g < s.geometries.size(); ++g)
    s.meshes.push_back({"mesh " + std::to_string(g), {{GeometryId(g), MaterialId(0)}}});
  s.meshes.push_back({"other material", {{GeometryId(0), MaterialId(1)}}});
  for (std::uint32_t m = 0; m < s.meshes.size(); ++m)
    s.objects.add("object " + std::to_string(m), MeshId(m), {{4.0F * static_cast<float>(m), 0, 0}});
  return s;
}

gltf::WriteOptions compressed() {
  gltf::WriteOptions options;
  options.layout = gltf::Layout::nodes;
  options.draco.on = true;
  return options;
}

Scene read_back(const std::string& path) {
  auto read = gltf::read(path);
  if (!read) FAIL(read.error().str());
  CHECK(read->ignored.empty());
  return std::move(read->scene);
}

timeline::CompareOptions within_rounding() {
  timeline::CompareOptions options;
  options.geometry_tolerance = 1e-3F;
  options.normal_tolerance = 0.03F;
  return options;
}

}  // namespace

TEST_CASE("triangle lists are compressed, everything else stays as it is") {
  const testing::TemporaryFolder folder;
  const Scene scene = sample();
  const auto report = gltf::write(scene, folder.path("a.glb"), compressed());
  REQUIRE(report);
  CHECK(report->draco_geometries == 2);
  CHECK(report->draco_left == 3);
  CHECK(report->notes.size() == 2);
  const auto plain =
      gltf::write(scene, folder.path("plain.glb"), {gltf::Layout::nodes, gltf::VisibilityEncoding::scale});
  REQUIRE(plain);
  CHECK(report->bytes * 3 < plain->bytes);
  CHECK(plain->draco_geometries == 0);

  const testing::GltfFile file = testing::GltfFile::from_glb(testing::file_bytes(folder.path("a.glb")));
  const json required = json::array({"KHR_draco_mesh_compression"});
  CHECK(file.json["extensionsRequired"] == required);
  CHECK(file.json["extensionsUsed"] == required);
  const json& globe_primitive = file.json["meshes"][0]["primitives"][0];
  const json& extension = globe_primitive["extensions"]["KHR_draco_mesh_compression"];
  CHECK(extension["attributes"].size() == 3);
  CHECK(file.json["meshes"][5]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] == extension);
  for (const int plain_mesh : {1, 2, 3})
    CHECK_FALSE(file.json["meshes"][plain_mesh]["primitives"][0].contains("extensions"));

  // Accessors of compressed data: no buffer view, and exactly what the stream decodes to.
  const Scene back = read_back(folder.path("a.glb"));
  const Geometry& decoded = back.geometries[0];
  const json& position = file.json["accessors"][globe_primitive["attributes"]["POSITION"].get<int>()];
  CHECK_FALSE(position.contains("bufferView"));
  CHECK(position["count"] == decoded.vertex_count());
  CHECK(file.json["accessors"][globe_primitive["indices"].get<int>()]["count"] == decoded.indices.size());
  const Box box = decoded.bounds();
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(position["min"][axis].get<float>() == box.lo[axis]);
    CHECK(position["max"][axis].get<float>() == box.hi[axis]);
  }

  const timeline::Comparison close = timeline::compare(scene, back, within_rounding());
  for (const auto& d : close.differences) WARN(d.where + ": " + d.what);
  CHECK(close.equal());
  CHECK_FALSE(timeline::compare(scene, back).equal());
}

TEST_CASE("more bits, less rounding; 0 bits, none") {
  const testing::TemporaryFolder folder;
  Scene scene = sample();
  gltf::WriteOptions options = compressed();
  options.draco.position_bits = 20;
  options.draco.normal_bits = options.draco.texcoord_bits = options.draco.color_bits = 16;
  options.draco.generic_bits = 16;
  REQUIRE(gltf::write(scene, folder.path("fine.glb"), options));
  timeline::CompareOptions fine;
  fine.geometry_tolerance = 2e-5F;
  fine.normal_tolerance = 1e-3F;
  CHECK(timeline::compare(scene, read_back(folder.path("fine.glb")), fine).equal());
  REQUIRE(gltf::write(scene, folder.path("coarse.glb"), compressed()));
  CHECK_FALSE(timeline::compare(scene, read_back(folder.path("coarse.glb")), fine).equal());

  options.draco = {};
  options.draco.on = true;
  options.draco.position_bits = options.draco.normal_bits = options.draco.texcoord_bits = 0;
  options.draco.color_bits = options.draco.generic_bits = 0;
  REQUIRE(gltf::write(scene, folder.path("exact.glb"), options));
  timeline::CompareOptions exact;
  exact.geometry_tolerance = 1e-9F;
  CHECK(timeline::compare(scene, read_back(folder.path("exact.glb")), exact).equal());
}

TEST_CASE("every level and layout gives the scene back, the same bytes each time") {
  const testing::TemporaryFolder folder;
  const Scene scene = testing::everything_scene();
  for (std::uint32_t level = 0; level <= 10; ++level) {
    gltf::WriteOptions options = compressed();
    options.draco.level = level;
    options.layout = static_cast<gltf::Layout>(1 + level % 3);
    REQUIRE(gltf::write(scene, folder.path("a.glb"), options));
    CHECK(timeline::compare(scene, read_back(folder.path("a.glb")), within_rounding()).equal());
    REQUIRE(gltf::write(scene, folder.path("b.glb"), options));
    CHECK(testing::file_bytes(folder.path("a.glb")) == testing::file_bytes(folder.path("b.glb")));
    const auto predicted = gltf::predict(scene, folder.path("b.glb"), options);
    REQUIRE(predicted);
    CHECK(predicted->bytes == std::filesystem::file_size(folder.path("b.glb")));
  }
}

TEST_CASE("geometry that Draco cannot give back stays as it is") {
  const testing::TemporaryFolder folder;
  Scene scene = sample();
  for (glm::vec3& p : scene.geometries[0].positions_m) p *= 1.4e38F;  // the extent overflows float32
  scene.geometries[4].indices.assign(300, 7);                         // no triangle has an area
  const auto report = gltf::write(scene, folder.path("a.glb"), compressed());
  REQUIRE(report);
  CHECK(report->draco_geometries == 0);
  CHECK(read_back(folder.path("a.glb")).geometries[0] == scene.geometries[0]);
}

TEST_CASE("any triangles at all: shared by many, on edges of many, collapsed, unused vertices, no indices") {
  const testing::TemporaryFolder folder;
  const Random random(4, "draco");
  std::uint64_t n = 0;
  std::uint64_t encoded = 0;
  const auto real = [&] { return static_cast<float>(random.below(n++, 1000)) / 500.0F; };
  for (int round = 0; round < 150; ++round) {
    Scene scene;
    Geometry& g = scene.geometries.emplace_back();
    const std::uint64_t vertices = 3 + random.below(n++, 40), faces = 10 + random.below(n++, 200);
    const bool lattice = round % 3 == 0;  // many vertices in one place
    for (std::uint64_t v = 0; v < vertices; ++v) {
      const glm::vec3 p(real(), real(), real());
      g.positions_m.push_back(lattice ? glm::round(p) : p);
      g.normals.push_back(glm::normalize(p + glm::vec3(0.01F)));
      if (round % 4 == 0) g.texcoords[0].emplace_back(real(), real());
    }
    for (std::uint64_t k = 0; k < 3 * faces && round % 5 != 0; ++k)
      g.indices.push_back(static_cast<std::uint32_t>(random.below(n++, vertices)));
    scene.meshes = {{"m", {{GeometryId(0), {}}}}};
    scene.objects.add("o", MeshId(0), {});
    gltf::WriteOptions options = compressed();
    options.draco.level = static_cast<std::uint32_t>(round % 11);
    const auto report = gltf::write(scene, folder.path("a.glb"), options);
    REQUIRE(report);
    encoded += report->draco_geometries;
    const auto result = timeline::compare(scene, read_back(folder.path("a.glb")), within_rounding());
    INFO("round " << round << (result.equal() ? "" : ": " + result.differences[0].what));
    CHECK(result.equal());
  }
  CHECK(encoded > 50);
}

#ifdef SCENEGEN_DRACO_ENCODER  // Debian package draco
namespace {

void write_obj(const Geometry& g, const std::string& path) {
  std::ofstream out(path);
  out.precision(9);
  for (const glm::vec3& p : g.positions_m) out << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const glm::vec2& t : g.texcoords[0]) out << "vt " << t.x << ' ' << t.y << '\n';
  for (const glm::vec3& n : g.normals) out << "vn " << n.x << ' ' << n.y << ' ' << n.z << '\n';
  for (std::size_t k = 0; k < g.indices.size(); k += 3) {
    out << 'f';
    for (std::size_t c = 0; c < 3; ++c) {
      const std::string i = std::to_string(g.indices[k + c] + 1);
      out << ' ' << i << '/' << i << '/' << i;
    }
    out << '\n';
  }
}

}  // namespace

TEST_CASE("within 5 % of draco_encoder at equal settings") {
  struct Settings {
    int level, position, texcoord, normal;
  };
  const testing::TemporaryFolder folder;
  for (const std::uint32_t slices : {12U, 64U, 200U}) {
    for (const Settings& set : {Settings{7, 11, 10, 8}, Settings{10, 14, 12, 10}, Settings{0, 11, 10, 8}}) {
      const Geometry geometry = globe(slices);
      write_obj(geometry, folder.path("m.obj"));
      const std::string command = SCENEGEN_DRACO_ENCODER " -i '" + folder.path("m.obj") + "' -o '" +
                                  folder.path("m.drc") + "' -cl " + std::to_string(set.level) + " -qp " +
                                  std::to_string(set.position) + " -qt " + std::to_string(set.texcoord) +
                                  " -qn " + std::to_string(set.normal) + " > /dev/null";
      REQUIRE(std::system(command.c_str()) == 0);
      Scene scene;
      scene.geometries = {geometry};
      scene.meshes = {{"m", {{GeometryId(0), {}}}}};
      gltf::DracoOptions options;
      options.on = true;
      options.level = static_cast<std::uint32_t>(set.level);
      options.position_bits = static_cast<std::uint32_t>(set.position);
      options.texcoord_bits = static_cast<std::uint32_t>(set.texcoord);
      options.normal_bits = static_cast<std::uint32_t>(set.normal);
      const gltf::DracoStreams streams = gltf::encode_draco(scene, options);
      REQUIRE(streams.find(0) != nullptr);
      const auto theirs = static_cast<double>(std::filesystem::file_size(folder.path("m.drc")));
      const auto ours = static_cast<double>(streams.find(0)->bytes.size());
      UNSCOPED_INFO(slices << " slices, level " << set.level << ": " << ours << " bytes, draco_encoder "
                           << theirs);
      CHECK(ours <= 1.05 * theirs);
    }
  }
}
#endif
