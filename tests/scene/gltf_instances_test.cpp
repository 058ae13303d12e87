// Layout instances: what groups share, and the table of ids.
#include <catch2/catch.hpp>
#include <map>
#include <set>
#include <string>

#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "tests/support/gltf_file.h"
#include "tests/support/synthetic_scene.h"
#include "timeline/compare.h"

namespace {

using namespace scenegen;
using nlohmann::json;

gltf::WriteOptions instances(bool id_table) {
  gltf::WriteOptions options(gltf::Layout::instances, gltf::VisibilityEncoding::scale);
  options.id_table = id_table;
  return options;
}

gltf::ReadResult read_back(const std::string& path) {
  auto read = gltf::read(path);
  if (!read) FAIL(read.error().str());
  return std::move(*read);
}

std::vector<json> attributes_of(const json& document) {
  std::vector<json> out;
  for (const json& node : document["nodes"]) {
    const json::json_pointer at("/extensions/EXT_mesh_gpu_instancing/attributes");
    if (node.contains(at)) out.push_back(node[at]);
  }
  return out;
}

}  // namespace

TEST_CASE("equal lists of rotations and of scales are one accessor") {
  const testing::TemporaryFolder folder;
  const Scene scene = testing::town_scene(6000, 64);
  const auto report = gltf::write(scene, folder.path("a.glb"), instances(false));
  REQUIRE(report);
  const auto file = testing::GltfFile::from_glb(testing::file_bytes(folder.path("a.glb")));
  for (const char* name : {"ROTATION", "SCALE"}) {
    std::map<std::vector<double>, std::size_t> known;
    std::set<std::size_t> accessors;
    std::size_t uses = 0;
    for (const json& attributes : attributes_of(file.json)) {
      if (!attributes.contains(name)) continue;
      ++uses;
      const std::size_t accessor = attributes[name];
      accessors.insert(accessor);
      CHECK(known.emplace(file.numbers(accessor), accessor).first->second == accessor);
    }
    INFO(name << ": " << accessors.size() << " accessors of " << uses << " groups");
    CHECK(uses > 100);
    CHECK(accessors.size() < uses);
    CHECK(accessors.size() == known.size());
  }
  CHECK(file.json["accessors"].size() == report->accessors);
  CHECK(timeline::compare(scene, read_back(folder.path("a.glb")).scene).equal());
}

TEST_CASE("a table of ids stands for the attribute, but not where objects have looks") {
  const testing::TemporaryFolder folder;
  const Scene scene = testing::town_scene(6000, 64);
  const auto with = gltf::write(scene, folder.path("a.gltf"), instances(true));
  const auto without = gltf::write(scene, folder.path("b.glb"), instances(false));
  REQUIRE((with && without));
  CHECK(with->accessors + with->instance_groups == without->accessors);
  CHECK(gltf::predict(scene, folder.path("a.gltf"), instances(true))->bytes == with->bytes);
  const auto file = testing::GltfFile::from_gltf(folder.path("a.gltf"));
  for (const json& attributes : attributes_of(file.json)) CHECK_FALSE(attributes.contains("_OBJECT_ID"));
  const gltf::ReadResult read = read_back(folder.path("a.gltf"));
  CHECK(read.ignored.empty());
  CHECK(read.scene.objects.names == scene.objects.names);
  CHECK(timeline::compare(scene, read.scene).equal());

  const Scene everything = testing::everything_scene();
  REQUIRE(gltf::write(everything, folder.path("c.glb"), instances(true)));
  CHECK(timeline::compare(everything, read_back(folder.path("c.glb")).scene).equal());
}

TEST_CASE("a damaged table of ids costs names and order, and is told; wrong numbers are errors") {
  const testing::TemporaryFolder folder;
  REQUIRE(gltf::write(testing::town_scene(3000, 16), folder.path("a.gltf"), instances(true)));
  const std::string text = testing::file_bytes(folder.path("a.gltf"));
  const std::string folder_name = folder.path(".");
  const auto read = [&](const std::string& pointer, const json& value) {
    json document = json::parse(text);
    document[json::json_pointer(pointer)] = value;
    const std::string changed = document.dump();
    return gltf::read_memory({changed.begin(), changed.end()}, "f", folder_name);
  };
  const std::string ids = "/scenes/0/extras/scenegen/ids";
  const auto lost = read(ids + "/count", 1'000'000);
  REQUIRE(lost);
  CHECK(lost->scene.objects.size() == 3000);
  REQUIRE(lost->ignored.size() == 1);
  CHECK(lost->ignored[0].what.starts_with("the table of object indices is damaged (1000000 indices in "));
  CHECK(lost->ignored[0].where == ids);

  const auto short_table = read(ids + "/count", 10);
  REQUIRE(!short_table);
  CHECK(short_table.error().what.find(" of 10 indices") != std::string::npos);
  const auto encoding = read(ids + "/encoding", "zip");
  REQUIRE(!encoding);
  CHECK(encoding.error().str() == "f: " + ids + R"(/encoding: wanted "delta-leb128")");
  const auto twice = read("/nodes/1/extras/scenegen/ids", 0);
  REQUIRE(!twice);
  CHECK(twice.error().what.find("a second object with index") != std::string::npos);
}
