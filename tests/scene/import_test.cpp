// Models of other formats, from Debian's assimp-testmodels and made by hand.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "scene/import/import.h"
#include "scene/validate.h"
#include "tests/support/gltf_file.h"

namespace {

using namespace scenegen;
using nlohmann::json;
using testing::file_bytes;

std::string model(const std::string& name) {
  return std::string(ASSIMP_TESTMODELS) + "/" + name;
}

gltf::ReadResult read(const std::string& path, const import::ImportOptions& options = {}) {
  auto result = import::read_model(path, options);
  INFO(path << ": " << (result ? "" : result.error().str()));
  REQUIRE(result);
  REQUIRE(result->source != nullptr);
  CHECK(validate(result->scene).empty());
  return std::move(*result);
}

Box bounds(const Scene& scene) {
  Box out;
  for (const Box& box : object_bounds(scene)) out.add(box);
  return out;
}

void check_box(const Box& box, const glm::vec3& lo, const glm::vec3& hi, float tolerance = 1e-4F) {
  for (int k = 0; k < 3; ++k) {
    INFO("axis " << k);
    CHECK(box.lo[k] == Approx(lo[k]).margin(tolerance));
    CHECK(box.hi[k] == Approx(hi[k]).margin(tolerance));
  }
}

void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

/// A box of 1 x 2 x 3 from the origin on, unlike along every axis.
std::string obj_box() {
  std::string out;
  for (const char* v : {"0 0 0", "1 0 0", "1 2 0", "0 2 0", "0 0 3", "1 0 3", "1 2 3", "0 2 3"})
    out += std::string("v ") + v + "\n";
  return out + "f 1 2 3 4\nf 5 6 7 8\n";
}

std::string stl_box() {
  return "solid box\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 2 3\nendloop\n"
         "endfacet\nendsolid box\n";
}

std::string collada_triangle(const std::string& unit, const std::string& up) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>)" +
         unit + "<up_axis>" + up + R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 1 0 0 1 2 3</float_array>
<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="thing"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

}  // namespace

TEST_CASE("an IFC house keeps its storeys, names, global ids, materials and metres") {
  const gltf::ReadResult house = read(model("IFC/AC14-FZK-Haus.ifc"));
  CHECK(house.scene.objects.size() == 110);
  CHECK(house.scene.materials.size() == 11);
  CHECK(house.scene.meshes.size() < house.scene.objects.size());  // mapped items are shared
  const json document = json::parse(house.source->json);
  std::vector<std::string> storeys;
  std::size_t with_guid = 0;
  for (const json& node : document["nodes"]) {
    const json extras = node.value("extras", json::object());
    if (extras.value("ifcClass", "") == "IfcBuildingStorey") {
      storeys.push_back(extras["ifcName"]);
      CHECK(node["children"].size() > 5);
    }
    if (extras.contains("guid")) {
      CHECK(extras["guid"].get<std::string>().size() == 22);
      ++with_guid;
    }
    CHECK(node["name"].get<std::string>().find("$Rel") == std::string::npos);
  }
  CHECK(storeys == std::vector<std::string>{"0.Erdgeschoss", "1.Dachgeschoss"});
  CHECK(with_guid > 80);
  const glm::vec3 size = bounds(house.scene).size();
  CHECK(size.x == Approx(18.0F).margin(0.1));  // the plot; the house is 12 m by 10 m
  CHECK(size.y == Approx(7.32F).margin(0.1));
}

TEST_CASE("an FBX file's axes and unit are obeyed") {
  const testing::TemporaryFolder folder;
  const std::string whole = file_bytes(model("FBX/cubes_with_names.fbx"));
  const Box centimetres = bounds(read(model("FBX/cubes_with_names.fbx")).scene);
  CHECK(centimetres.size().x < 1.0F);  // centimetres
  const std::string inches = replaced(whole, R"("UnitScaleFactor", "double", "Number", "",1)",
                                      R"("UnitScaleFactor", "double", "Number", "",2.54)");
  write(folder.path("inch.fbx"), inches);
  check_box(bounds(read(folder.path("inch.fbx")).scene), 2.54F * centimetres.lo, 2.54F * centimetres.hi);
  std::string z_up =
      replaced(whole, R"("UpAxis", "int", "Integer", "",1)", R"("UpAxis", "int", "Integer", "",2)");
  z_up = replaced(z_up, R"("FrontAxis", "int", "Integer", "",2)", R"("FrontAxis", "int", "Integer", "",1)");
  z_up = replaced(z_up, R"("FrontAxisSign", "int", "Integer", "",1)",
                  R"("FrontAxisSign", "int", "Integer", "",-1)");
  write(folder.path("z.fbx"), z_up);
  const Box turned = bounds(read(folder.path("z.fbx")).scene);
  check_box(turned, {centimetres.lo.x, centimetres.lo.z, -centimetres.hi.y},
            {centimetres.hi.x, centimetres.hi.z, -centimetres.lo.y});
  import::ImportOptions options;
  options.up = import::UpAxis::y;
  options.metres_per_unit = 0.01;
  check_box(bounds(read(folder.path("z.fbx"), options).scene), centimetres.lo, centimetres.hi);
}

TEST_CASE("formats have an up axis and a unit of their own") {
  const testing::TemporaryFolder folder;
  import::ImportOptions options;
  write(folder.path("box.obj"), obj_box());
  check_box(bounds(read(folder.path("box.obj")).scene), {0, 0, 0}, {1, 2, 3});
  options.up = import::UpAxis::x;
  check_box(bounds(read(folder.path("box.obj"), options).scene), {-2, 0, 0}, {0, 1, 3});
  write(folder.path("box.stl"), stl_box());
  check_box(bounds(read(folder.path("box.stl")).scene), {0, 0, -2}, {1, 3, 0});
  options.up = import::UpAxis::y;
  options.metres_per_unit = 0.001;
  check_box(bounds(read(folder.path("box.stl"), options).scene), {0, 0, 0}, {0.001F, 0.002F, 0.003F}, 1e-7F);
  check_box(bounds(read(model("3MF/box.3mf")).scene), {0, 0, -0.02F}, {0.01F, 0.03F, 0},
            1e-6F);  // millimetres
}

TEST_CASE("a Collada file's unit and axis are obeyed, and options replace them") {
  const testing::TemporaryFolder folder;
  const std::string path = folder.path("t.dae");
  write(path, collada_triangle(R"(<unit name="inch" meter="0.0254"/>)", "Z_UP"));
  check_box(bounds(read(path).scene), 0.0254F * glm::vec3(0, 0, -2), 0.0254F * glm::vec3(1, 3, 0), 1e-6F);
  import::ImportOptions options;
  options.metres_per_unit = 1;
  check_box(bounds(read(path, options).scene), {0, 0, -2}, {1, 3, 0}, 1e-5F);
  options.up = import::UpAxis::y;
  check_box(bounds(read(path, options).scene), {0, 0, 0}, {1, 2, 3}, 1e-5F);
  write(path, collada_triangle("", "Y_UP"));
  check_box(bounds(read(path).scene), {0, 0, 0}, {1, 2, 3});
}

TEST_CASE("materials, textures beside the model, cameras and shared meshes come along") {
  const gltf::ReadResult duck = read(model("Collada/duck.dae"));
  REQUIRE(duck.scene.images.size() == 1);
  CHECK(duck.scene.cameras.size() == 1);
  REQUIRE(duck.scene.materials.size() == 1);
  CHECK(duck.scene.materials[0].base_color_texture.texture.valid());
  CHECK(duck.source->json.find("KHR_lights_punctual") != std::string::npos);
  const gltf::ReadResult embedded = read(model("BLEND/TexturedPlane_ImageUvPacked_248.blend"));
  CHECK(embedded.scene.images.size() == 1);
  const gltf::ReadResult cubes = read(model("Collada/anims_with_full_rotations_between_keys.DAE"));
  CHECK(cubes.scene.objects.size() == 64);
  CHECK(cubes.scene.meshes.size() == 1);
}

TEST_CASE("a material's colour, opacity and finish become metallic-roughness, a bitmap a PNG") {
  const testing::TemporaryFolder folder;
  // A 24-bit BMP of 1 x 1 texels.
  const std::string bmp(
      "BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\1\0\0\0\1\0\0\0\1\0\x18\0"
      "\0\0\0\0\4\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x10\x20\x30\0",
      58);
  std::filesystem::create_directory(folder.path("maps"));
  write(folder.path("maps/Brick.BMP"), bmp);
  write(folder.path("m.mtl"),
        "newmtl Glass\nKd 0.5 0.5 1\nd 0.25\nPr 0.3\nPm 0.75\nmap_Kd C:\\maps\\brick.bmp\n");
  write(folder.path("m.obj"), "mtllib m.mtl\nusemtl Glass\n" + obj_box());
  const gltf::ReadResult result = read(folder.path("m.obj"));
  REQUIRE(result.scene.materials.size() == 1);
  const Material& glass = result.scene.materials[0];
  CHECK(glass.name == "Glass");
  CHECK(glass.base_color.x == Approx(0.2140F));  // sRGB 0.5 in linear light
  CHECK(glass.base_color.z == Approx(1.0F));
  CHECK(glass.base_color.w == Approx(0.25F));
  CHECK(glass.alpha_mode == AlphaMode::blend);
  CHECK(glass.roughness == Approx(0.3F));
  CHECK(glass.metallic == Approx(0.75F));
  REQUIRE(result.scene.images.size() == 1);
  CHECK(result.scene.images[0].mime_type == "image/png");
  std::filesystem::remove_all(folder.path("maps"));
  const gltf::ReadResult without = read(folder.path("m.obj"));
  CHECK(without.scene.images.empty());
  REQUIRE(without.ignored.size() == 1);
  CHECK(without.ignored[0].what.find("brick.bmp") != std::string::npos);
}

TEST_CASE("point clouds and lines are drawn as such, and empty models are refused") {
  CHECK(read(model("OBJ/point_cloud.obj")).scene.geometries.at(0).topology == Topology::points);
  CHECK(read(model("PLY/points.ply")).scene.geometries.at(0).topology == Topology::points);
  CHECK(read(model("OBJ/testline.obj")).scene.geometries.at(0).topology == Topology::lines);
  const auto empty = import::read_model(model("OpenGEX/light_issue1262.ogex"));
  REQUIRE_FALSE(empty);
  CHECK(empty.error().what == "nothing to draw: it holds no meshes");
}

TEST_CASE("what cannot be read is one line") {
  const testing::TemporaryFolder folder;
  const auto check = [](const std::string& path, ErrorKind kind, const std::string& what) {
    const auto result = import::read_model(path);
    INFO(path);
    REQUIRE_FALSE(result);
    INFO(result.error().str());
    CHECK(result.error().kind == kind);
    CHECK(result.error().where == path);
    CHECK(result.error().what.find(what) != std::string::npos);
    CHECK(result.error().str().find('\n') == std::string::npos);
  };
  check(folder.path("no.fbx"), ErrorKind::io, "No such file");
  check(folder.path("."), ErrorKind::io, "not a regular file");
  check(model("invalid/empty.3ds"), ErrorKind::bad_input, "empty");
  check(model("invalid/malformed.obj"), ErrorKind::bad_input, "Assimp: OBJ: Invalid face index.");
  check(model("RAW/WithColor.raw"), ErrorKind::bad_input, "Assimp");  // 5.2 crashes on it
  check(model("invalid/OutOfMemory.off"), ErrorKind::bad_input, "Assimp");
  const std::string house = file_bytes(model("IFC/AC14-FZK-Haus.ifc"));
  const std::string cut = house.substr(0, house.size() * 2 / 3);
  write(folder.path("cut.ifc"), cut.substr(0, cut.rfind('\n') + 1));
  check(folder.path("cut.ifc"), ErrorKind::bad_input, "ends before END-ISO-10303-21;");
  write(folder.path("more.ifc"), house + "/* exported on a Friday */\r\n\n");
  CHECK(import::read_model(folder.path("more.ifc")));
  write(folder.path("text.xyzzy"), "hello");
  check(folder.path("text.xyzzy"), ErrorKind::bad_input, "'.xyzzy' is no model format that is read");
}

TEST_CASE("the same model gives the same document") {
  for (const char* name : {"IFC/AC14-FZK-Haus.ifc", "3DS/test1.3ds"}) {
    const gltf::ReadResult a = read(model(name));
    const gltf::ReadResult b = read(model(name));
    CHECK(a.source->json == b.source->json);
    CHECK(a.source->buffers == b.source->buffers);
  }
}
