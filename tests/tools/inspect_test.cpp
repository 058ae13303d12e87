// scenegen inspect: what it says of models of other formats, and the names that it lists for plans and rules.
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/gltf_text.h"
#include "tests/tools/process.h"

using namespace scenegen::test;
using nlohmann::json;

namespace {

const std::string kHouse = std::string(ASSIMP_TESTMODELS) + "/IFC/AC14-FZK-Haus.ifc";

// A storey of two walls, one of which carries a door; an instanced fence; a lamp at the root.
constexpr const char* kNodes = R"(,"materials":[{"name":"brick, red"},{}],"scenes":[{"nodes":[0,6]}],
  "nodes":[{"name":"storey","children":[1,3,4,5],"extras":{"guid":"S1","ifc":{"class":"Storey"}}},
  {"name":"wall a","mesh":0,"children":[2],"extras":{"guid":"A1","tags":[1,2],"ifc":{"class":"Wall"}}},
  {"name":"door","mesh":1},{"name":"wall b","mesh":0},{"mesh":1},{"name":"nothing below"},
  {"name":"lamp\u001b[31m","mesh":1,"extras":{"on":true,"watts":9.5}}])";

class Workplace {
 public:
  Workplace() {
    scenegen::testing::GltfText g;
    const std::size_t positions = g.floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::string primitive = R"({"attributes":{"POSITION":)" + std::to_string(positions) + "}";
    write_file(folder_.file("model.gltf"),
               g.str(R"("meshes":[{"primitives":[)" + primitive + R"(,"material":0},)" + primitive +
                     R"(,"material":0}]},{"primitives":[)" + primitive + R"(,"material":1}]}])" + kNodes));
  }
  ProcessResult call(const std::string& arguments) {
    return run(SCENEGEN_PROGRAM, words("inspect " + arguments), {.folder = folder_.path()});
  }
  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("inspect --objects: the tree of what plans can name") {
  Workplace w;
  const ProcessResult tree = w.call("model.gltf --objects");
  CHECK(tree.err.empty());
  REQUIRE(tree.code == 0);
  CHECK(tree.out ==
        "storey  (4 objects)  guid=S1  ifc.class=Storey\n"
        "  wall a  [brick, red]  (1 object below)  guid=A1  ifc.class=Wall\n"
        "    door\n"
        "  wall b  [brick, red]\n"
        "  node_4\n"
        "lamp?[31m  on=true  watts=9.5\n");
  const json list = json::parse(w.call("model.gltf --objects --format json").out);
  CHECK(list["schema"] == "scenegen/objects");
  REQUIRE(list["objects"].size() == 5);
  CHECK(list["objects"][1] == json{{"object", "door"},
                                   {"path", {"storey", "wall a", "door"}},
                                   {"materials", json::array()},
                                   {"extras", {{"guid", "A1"}, {"ifc.class", "Wall"}}}});
  const ProcessResult csv = w.call("model.gltf --objects --format csv");
  CHECK_THAT(csv.out,
             Catch::Matchers::StartsWith("object,path,materials,extras\n"
                                         "wall a,storey > wall a,\"brick, red\",guid=A1;ifc.class=Wall\n"));
  CHECK(w.call("model.gltf --objects -q").out.empty());
}

TEST_CASE("inspect --objects: instances are listed below their node") {
  Workplace w;
  REQUIRE(run(SCENEGEN_PROGRAM, words("--floors 1 --layout instances -q -o town.glb"),
              {.folder = w.folder().path()})
              .code == 0);
  const json facts = json::parse(w.call("town.glb --format json").out);
  const json list = json::parse(w.call("town.glb --objects --format json").out);
  CHECK(list["objects"].size() == facts["objects"]);
  const ProcessResult tree = w.call("town.glb --objects");
  CHECK(static_cast<std::size_t>(std::count(tree.out.begin(), tree.out.end(), '\n')) >
        list["objects"].size());
}

TEST_CASE("inspect reads what animate and schedule read, and says what is no model") {
  Workplace w;
  const json house = json::parse(w.call(kHouse + " --format json").out);
  CHECK(house["objects"] == 110);
  CHECK(house["bytes"] == read_file(kHouse).size());
  CHECK_THAT(house["importer"].get<std::string>(), Catch::Matchers::Contains("Assimp"));
  const json list = json::parse(w.call(kHouse + " --objects --format json").out);
  REQUIRE(list["objects"].size() == 110);
  const auto stairs = std::find_if(list["objects"].begin(), list["objects"].end(), [](const json& object) {
    return object["extras"].value("ifcClass", "") == "IfcStair";
  });
  REQUIRE(stairs != list["objects"].end());
  CHECK_THAT((*stairs)["path"][2].get<std::string>(), Catch::Matchers::StartsWith("IfcBuildingStorey_"));

  write_file(w.folder().file("plan.csv"), "id,start\n");
  write_file(w.folder().file("plan.glb"), "id,start\n");
  for (const char* options : {"", " --objects"}) {
    CHECK(
        w.call(std::string("plan.csv") + options).err ==
        "error: plan.csv: '.csv' is no model format that is read (glTF and what Assimp reads: .fbx .ifc .obj "
        ".dae .stl .3mf …)\n");
    CHECK(w.call(std::string("plan.glb") + options).err ==
          "error: plan.glb: is no glTF: it begins neither as a .glb nor as a JSON object\n");
  }
}
