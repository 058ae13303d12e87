// Layout merged: the file draws what the scene draws, corner by corner, and says what it was made of.
#include <algorithm>
#include <catch2/catch.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <map>

#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "scene/validate.h"
#include "tests/support/gltf_file.h"
#include "tests/support/synthetic_scene.h"
#include "tests/timeline/random_scene.h"

using namespace scenegen;
using gltf::Layout;
using gltf::VisibilityEncoding;
using nlohmann::json;
using testing::GltfFile;

namespace {

const gltf::WriteOptions kMerged{Layout::merged, VisibilityEncoding::scale, 1};

struct Corner {
  glm::dvec3 position{0}, normal{0};
  glm::dvec4 tangent{0}, color{0};
  glm::dvec2 uv{0};
};
/// Corners of triangles (by threes), lines (by twos) or points of one object with one material, in order.
using Key = std::tuple<std::uint32_t, int, int>;  // object, material, corners a piece
using Drawn = std::map<Key, std::vector<Corner>>;

/// Indices of list corners as the specification draws them.
std::vector<std::size_t> corners(const Geometry& g) {
  std::vector<std::size_t> v, out;
  for (std::size_t k = 0; k < g.drawn_vertex_count(); ++k) v.push_back(g.indices.empty() ? k : g.indices[k]);
  const std::size_t n = v.size();
  const auto add = [&](std::initializer_list<std::size_t> of) {
    for (const std::size_t k : of) out.push_back(v[k]);
  };
  switch (g.topology) {
    case Topology::triangle_strip:
      for (std::size_t k = 0; k + 2 < n; ++k) add({k, k + 1 + k % 2, k + 2 - k % 2});
      return out;
    case Topology::triangle_fan:
      for (std::size_t k = 0; k + 2 < n; ++k) add({k + 1, k + 2, 0});
      return out;
    case Topology::line_strip:
      for (std::size_t k = 0; k + 1 < n; ++k) add({k, k + 1});
      return out;
    case Topology::line_loop:
      for (std::size_t k = 0; k < n; ++k) add({k, (k + 1) % n});
      return out;
    default:
      return v;
  }
}

int corners_a_piece(Topology t) {
  return t == Topology::points ? 1 : t < Topology::triangles ? 2 : 3;
}

Drawn drawn_by_scene(const Scene& scene) {
  Drawn out;
  const auto frames = rest_frame_matrices(scene);
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    const glm::dmat4 world(rest_world_from_object(scene, frames, ObjectId(i)));
    const glm::dmat3 linear(world);
    const bool mirrored = glm::determinant(linear) < 0;
    for (const Primitive& p : scene.meshes[scene.objects.mesh[i].value].primitives) {
      const Geometry& g = scene.geometries[p.geometry.value];
      const int piece = corners_a_piece(g.topology);
      std::vector<std::size_t> order = corners(g);
      for (std::size_t k = 0; k + 2 < order.size() && piece == 3 && mirrored; k += 3)
        std::swap(order[k + 1], order[k + 2]);
      auto& to = out[{i, p.material.valid() ? static_cast<int>(p.material.value) : -1, piece}];
      for (const std::size_t v : order) {
        Corner c;
        c.position = glm::dvec3(world * glm::dvec4(g.positions_m[v], 1));
        if (!g.normals.empty())
          c.normal = glm::normalize(glm::inverseTranspose(linear) * glm::dvec3(g.normals[v]));
        if (!g.tangents.empty())
          c.tangent = {glm::normalize(linear * glm::dvec3(g.tangents[v])),
                       g.tangents[v].w * (mirrored ? -1 : 1)};
        if (!g.texcoords[0].empty()) c.uv = g.texcoords[0][v];
        if (!g.colors.empty()) c.color = g.colors[v];
        to.push_back(c);
      }
    }
  }
  return out;
}

Drawn drawn_by_file(const GltfFile& file) {
  Drawn out;
  const auto parents = file.parents();
  const json& nodes = file.json["nodes"];
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (!nodes[n].contains("mesh")) continue;
    glm::dmat4 world(1);
    for (int at = static_cast<int>(n); at >= 0; at = parents[static_cast<std::size_t>(at)])
      world = file.local_matrix(static_cast<std::size_t>(at)) * world;
    const glm::dmat3 linear(world), for_normals = glm::inverseTranspose(linear);
    REQUIRE(glm::determinant(linear) > 0);  // else the player would turn triangles over
    for (const json& primitive : file.json["meshes"][nodes[n]["mesh"].get<std::size_t>()]["primitives"]) {
      const auto numbers = [&](const char* name) {
        const json& attributes = primitive["attributes"];
        return attributes.contains(name) ? file.numbers(attributes[name]) : std::vector<double>();
      };
      const auto p = numbers("POSITION"), nn = numbers("NORMAL"), t = numbers("TANGENT"),
                 uv = numbers("TEXCOORD_0"), color = numbers("COLOR_0"), id = numbers("_OBJECT_ID");
      std::vector<double> order;
      if (primitive.contains("indices")) order = file.numbers(primitive["indices"]);
      for (std::size_t v = 0; v < p.size() / 3 && !primitive.contains("indices"); ++v)
        order.push_back(static_cast<double>(v));
      const int piece = corners_a_piece(static_cast<Topology>(primitive.value("mode", 4)));
      for (const double index : order) {
        const auto v = static_cast<std::size_t>(index);
        Corner c;
        c.position = glm::dvec3(world * glm::dvec4(p[3 * v], p[3 * v + 1], p[3 * v + 2], 1));
        if (!nn.empty())
          c.normal = glm::normalize(for_normals * glm::dvec3(nn[3 * v], nn[3 * v + 1], nn[3 * v + 2]));
        if (!t.empty())
          c.tangent = {glm::normalize(linear * glm::dvec3(t[4 * v], t[4 * v + 1], t[4 * v + 2])),
                       t[4 * v + 3]};
        if (!uv.empty()) c.uv = {uv[2 * v], uv[2 * v + 1]};
        if (!color.empty()) c.color = {color[4 * v], color[4 * v + 1], color[4 * v + 2], color[4 * v + 3]};
        const auto object = static_cast<std::uint32_t>(id[2 * v] + 65536 * id[2 * v + 1]);
        out[{object, primitive.value("material", -1), piece}].push_back(c);
      }
    }
  }
  return out;
}

void check_drawn(const Drawn& a, const Drawn& b, double tolerance) {
  REQUIRE(a.size() == b.size());
  for (const auto& [key, expected] : a) {
    INFO("object " << std::get<0>(key) << " material " << std::get<1>(key));
    REQUIRE(b.count(key) == 1);
    const std::vector<Corner>& found = b.at(key);
    REQUIRE(found.size() == expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      INFO("corner " << k);
      CHECK(glm::length(found[k].position - expected[k].position) < tolerance);
      CHECK(glm::length(found[k].normal - expected[k].normal) < 1e-5);
      CHECK(glm::length(found[k].tangent - expected[k].tangent) < 1e-5);
      CHECK(found[k].uv == expected[k].uv);
      CHECK(found[k].color == expected[k].color);
    }
  }
}

GltfFile written(const Scene& scene, const gltf::WriteOptions& options = kMerged) {
  const testing::TemporaryFolder folder;
  const auto report = gltf::write(scene, folder.path("a.glb"), options);
  if (!report) FAIL(report.error().str());
  return GltfFile::from_glb(testing::file_bytes(folder.path("a.glb")));
}

/// Every topology, with every vertex stream, placed so that something can go wrong.
Scene all_kinds_of_geometry() {
  Scene scene;
  scene.materials.resize(2);
  const Topology topologies[] = {Topology::points,      Topology::lines,     Topology::line_loop,
                                 Topology::line_strip,  Topology::triangles, Topology::triangle_strip,
                                 Topology::triangle_fan};
  for (const Topology topology : topologies) {
    for (const bool indexed : {false, true}) {
      Geometry g;
      g.topology = topology;
      for (int v = 0; v < 6; ++v) {
        const auto f = static_cast<float>(v);
        g.positions_m.emplace_back(f, f * f * 0.25F, 1.0F / (f + 1));
        g.normals.push_back(glm::normalize(glm::vec3(1, f, 2)));
        const glm::vec3 side = glm::normalize(glm::cross(g.normals.back(), glm::vec3(0, 0, 1)));
        g.tangents.emplace_back(side, v % 2 == 0 ? 1.0F : -1.0F);
        g.texcoords[0].emplace_back(f, -f);
        g.colors.emplace_back(f / 8, 0.5F, 0, 1);
      }
      if (topology == Topology::lines) g.tangents.clear();
      if (indexed) g.indices = {5, 4, 3, 0, 1, 2};
      scene.meshes.push_back({"", {{GeometryId(scene.geometries.size()), MaterialId(indexed ? 1 : 0)}}});
      scene.geometries.push_back(std::move(g));
    }
  }
  const glm::vec3 scales[] = {{1, 1, 1}, {2, 3, 0.5F}, {-1, 1, 1}, {-2, -1, -0.5F}, {1, -3, -1}};
  const glm::quat turned = glm::normalize(glm::quat(0.5F, 0.1F, -0.7F, 0.3F));
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    for (int s = 0; s < 5; ++s) {
      const Transform t{{static_cast<float>(m), static_cast<float>(s), -2}, turned, scales[s]};
      scene.objects.add(std::to_string(m) + "_" + std::to_string(s), MeshId(m), t);
    }
  }
  return scene;
}

}  // namespace

TEST_CASE("a merged file draws every corner of every object where the scene has it") {
  SECTION("all topologies, mirrored and stretched") {
    const Scene scene = all_kinds_of_geometry();
    REQUIRE(validate(scene).empty());
    const GltfFile file = written(scene);
    check_drawn(drawn_by_scene(scene), drawn_by_file(file), 1e-5);
    CHECK(file.json["nodes"].size() == 1);
    CHECK(!file.json.contains("extensionsUsed"));
  }
  SECTION("on frames, with many tracks") {
    Scene scene = timeline::test::RandomScene(3).make(80, 4);
    scene.object_mesh_tracks.clear();
    for (Frame& f : scene.frames) f.has_matrix = false;
    check_drawn(drawn_by_scene(scene), drawn_by_file(written(scene)), 1e-4);
  }
  SECTION("more vertices than 16 bits count") {
    const Scene scene = testing::town_scene(3000, 1);
    const GltfFile file = written(scene);
    check_drawn(drawn_by_scene(scene), drawn_by_file(file), 1e-4);
    const json& merged = file.json["meshes"].back();
    CHECK(merged["primitives"].size() == 3);  // one a material
    for (const json& primitive : merged["primitives"]) CHECK(!primitive.contains("indices"));
  }
}

TEST_CASE("indices of merged meshes are as wide as they must be") {
  Scene scene = all_kinds_of_geometry();
  scene.objects = {};
  for (int i = 0; i < 12000; ++i) scene.objects.add("o" + std::to_string(i), MeshId(9), {});  // 6 vertices
  const auto type_of = [](const GltfFile& file) {
    const json& primitive = file.json["meshes"].back()["primitives"][0];
    return file.json["accessors"][primitive["indices"].get<std::size_t>()]["componentType"].get<int>();
  };
  const GltfFile wide = written(scene);
  CHECK(type_of(wide) == 5125);
  check_drawn(drawn_by_scene(scene), drawn_by_file(wide), 1e-6);
  Scene few = scene;
  few.objects = {};
  for (int i = 0; i < 100; ++i) few.objects.add("o" + std::to_string(i), MeshId(9), {});
  CHECK(type_of(written(few)) == 5123);
}

TEST_CASE("a flat object keeps normals of unit length") {
  Scene scene = all_kinds_of_geometry();
  scene.objects = {};
  scene.objects.add("flat", MeshId(8), {{0, 0, 0}, {1, 0, 0, 0}, {1, 0, 1}});
  scene.objects.add("nothing", MeshId(8), {{0, 0, 0}, {1, 0, 0, 0}, {0, 0, 0}});
  const GltfFile file = written(scene);
  const json& attributes = file.json["meshes"].back()["primitives"][0]["attributes"];
  const auto normals = file.numbers(attributes["NORMAL"]);
  for (std::size_t v = 0; v < normals.size() / 3; ++v) {
    const glm::dvec3 n(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]);
    CHECK(glm::length(n) == Approx(1.0));
    if (v > 0 && v < 6) CHECK(std::abs(n.y) == Approx(1.0));  // the first one lies in the plane
  }
}

TEST_CASE("what cannot be merged is refused before a byte is written") {
  Scene scene = all_kinds_of_geometry();
  SECTION("more than a .glb holds") {
    scene.geometries[8].positions_m.resize(99999);
    scene.geometries[8].normals.clear();
    scene.geometries[8].tangents.clear();
    scene.geometries[8].texcoords[0].clear();
    scene.geometries[8].colors.clear();
    for (int i = 0; i < 3000; ++i) scene.objects.add("big" + std::to_string(i), MeshId(8), {});
  }
  SECTION("vertices beyond float32") {
    scene.geometries[8].positions_m[3].x = 1e30F;
    scene.objects.add("huge", MeshId(8), {{0, 0, 0}, {1, 0, 0, 0}, {1e30F, 1, 1}});
  }
  const testing::TemporaryFolder folder;
  for (const bool dry : {false, true}) {
    const std::string path = folder.path("a.glb");
    const auto report = dry ? gltf::predict(scene, path, kMerged) : gltf::write(scene, path, kMerged);
    REQUIRE(!report.has_value());
    CHECK(report.error().kind == ErrorKind::bad_input);
    CHECK(folder.files().empty());
  }
}

TEST_CASE("a merged file whose objects another tool has spoiled is read as what others see") {
  const testing::TemporaryFolder folder;
  const Scene scene = testing::town_scene(300, 5);
  REQUIRE(gltf::write(scene, folder.path("town.gltf"), kMerged));
  const std::string good = testing::file_bytes(folder.path("town.gltf"));
  const auto spoil = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
    return gltf::read_memory({text.begin(), text.end()}, "town.gltf", folder.path(""));
  };
  const json document = json::parse(good);
  const json first = document["nodes"][0]["extras"]["scenegen"]["objects"][0];
  const std::string ids = "\"_OBJECT_ID\":" + first["_OBJECT_ID"].dump();
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {ids, "\"_OBJECT_ID\":0"},                // no integers
           {ids, "\"_OBJECT_ID\":999999"},           // no accessor
           {ids, ids.substr(0, ids.find(':') + 1) +  // another set's: twice
                     document["nodes"][1]["extras"]["scenegen"]["objects"][0]["_OBJECT_ID"].dump()},
           {"\"merged\":{\"meshes\":3}", "\"merged\":{\"meshes\":99}"},
           {"\"objects\":[{\"mesh\":0", "\"objects\":[{\"mesh\":3"}}) {
    INFO(from << " -> " << to);
    const auto read = spoil(from, to);
    if (!read) FAIL(read.error().str());
    CHECK(validate(read->scene).empty());
    CHECK(read->scene.objects.size() == 5);  // a merged mesh a moment
    CHECK(read->scene.meshes.size() == 8);
    REQUIRE(read->ignored.size() == 1);
    CHECK(read->ignored[0].what.find("merged objects is damaged") != std::string::npos);
  }
}
