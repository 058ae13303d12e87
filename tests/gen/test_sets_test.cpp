// Counts of the test sets against D's table 1 (tests/gen/test_sets.csv).
#include <catch2/catch.hpp>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "gen/generate.h"
#include "scene/validate.h"

using namespace scenegen;
using namespace scenegen::gen;

namespace {

std::map<int, Prediction> table() {
  std::ifstream file(SCENEGEN_TEST_SETS_CSV);
  std::map<int, Prediction> out;
  std::string line;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#' || line.starts_with("set,")) continue;
    std::stringstream fields(line);
    std::string set, kind, objects, vertices, triangles;
    std::getline(fields, set, ',');
    std::getline(fields, kind, ',');
    std::getline(fields, objects, ',');
    std::getline(fields, vertices, ',');
    std::getline(fields, triangles, ',');
    out[std::stoi(set)] = {std::stoull(objects), std::stoull(vertices), std::stoull(triangles)};
  }
  return out;
}

Prediction counted(const Scene& scene) {
  Prediction sum{scene.objects.size(), 0, 0};
  for (const MeshId mesh : scene.objects.mesh) {
    for (const Primitive& p : scene.meshes[mesh.value].primitives) {
      sum.vertices += scene.geometries[p.geometry.value].drawn_vertex_count();
      sum.triangles += scene.geometries[p.geometry.value].triangle_count();
    }
  }
  return sum;
}

void check_equal(const Prediction& a, const Prediction& b) {
  CHECK(a.objects == b.objects);
  CHECK(a.vertices == b.vertices);
  CHECK(a.triangles == b.triangles);
}

}  // namespace

TEST_CASE("every test set has the counts of table 1") {
  const std::map<int, Prediction> figures = table();
  REQUIRE(figures.size() == 48);
  for (int set = 5; set <= 48; ++set) {
    INFO("set " << set);
    const Result<Generated> generated = generate_test_set(set, 1);
    REQUIRE(generated);
    const Scene& scene = generated->scene;
    check_equal(counted(scene), figures.at(set));
    check_equal(*predict_test_set(set), figures.at(set));
    CHECK(validate(scene).empty());
    CHECK(scene.cameras.size() == 1);
    CHECK(generated->exempt == std::vector<std::uint8_t>(scene.objects.size(), 0));
    for (const Geometry& g : scene.geometries) {
      CHECK(g.indices.empty());
      CHECK(g.normals.size() == g.positions_m.size());
    }
    CHECK(scene.geometries.size() <= 2);
    CHECK((set < 41 || !scene.textures.empty()));
    std::set<std::string_view> names;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) names.insert(scene.objects.names[i]);
    CHECK(names.size() == scene.objects.size());
  }
}

TEST_CASE("test sets depend on the seed and on nothing else") {
  const Generated a = *generate_test_set(24, 5), b = *generate_test_set(24, 5), c = *generate_test_set(24, 6);
  CHECK(a.scene.objects.frame_from_object == b.scene.objects.frame_from_object);
  CHECK(a.scene.objects.frame_from_object != c.scene.objects.frame_from_object);
  CHECK(a.scene.objects.names == b.scene.objects.names);
}

TEST_CASE("other test sets are refused with a reason") {
  for (const int set : {-1, 0, 1, 4, 49, 1000}) {
    const Result<Prediction> r = predict_test_set(set);
    REQUIRE_FALSE(r);
    CHECK(r.error().kind == ErrorKind::usage);
    CHECK(r.error().where == "--test-set");
    CHECK(r.error().what.find("allowed 5 to 48") != std::string::npos);
    CHECK_FALSE(generate_test_set(set, 1));
  }
}
