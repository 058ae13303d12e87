// Broken and hostile files: one located error each, never a crash, never memory beyond the file's size.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "scene/random.h"
#include "scene/validate.h"
#include "tests/support/gltf_text.h"
#include "tests/support/synthetic_scene.h"
#include "tests/timeline/random_scene.h"

namespace {

using namespace scenegen;
using testing::GltfText;

std::string s(std::size_t i) {
  return std::to_string(i);
}

/// The error of a document that must not be read.
Error error_of(const std::string& text) {
  const auto read = gltf::read_memory({text.begin(), text.end()}, "f", "");
  if (read) {
    FAIL_CHECK("was read: " << text);
    return {};
  }
  CHECK(read.error().str().find('\n') == std::string::npos);
  return read.error();
}

void check_error(const std::string& text, const std::string& where, const std::string& what) {
  const Error error = error_of(text);
  INFO(text.substr(0, 2000) << "\n-> " << error.str());
  CHECK(error.kind == ErrorKind::bad_input);
  CHECK(error.where == "f" + (where.empty() ? "" : ": " + where));
  CHECK(error.what.find(what) != std::string::npos);
}

/// A document with a triangle, an animated node and accessors to point at.
struct Animated {
  GltfText g;
  std::string mesh = g.triangle_mesh();
  std::string times = s(g.floats("SCALAR", 2, {0, 1}));
  std::string equal_times = s(g.floats("SCALAR", 2, {1, 1}));
  std::string negative_times = s(g.floats("SCALAR", 2, {-1, 1}));
  std::string nan_times = s(g.floats("SCALAR", 2, {0, NAN}));
  std::string booleans = s(g.accessor("SCALAR", 2, std::vector<std::uint8_t>{0, 1}));
  std::string three = s(g.floats("SCALAR", 3, {0, 1, 0}));
  std::string vec3 = s(g.floats("VEC3", 2, {0, 0, 0, 1, 1, 1}));
  std::string vec4 = s(g.floats("VEC4", 2, {0, 0, 0, 0, 0, 0, 0, 1}));

  [[nodiscard]] std::string with(const std::string& input, const std::string& output,
                                 const std::string& interpolation, const std::string& channels) const {
    return g.str(mesh +
                 R"(,"materials":[{}],"nodes":[{"mesh":0,"extensions":{"KHR_node_visibility":{}}},{"mesh":0},
        {"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}],"animations":[{"samplers":[{"input":)" +
                 input + ",\"output\":" + output + ",\"interpolation\":\"" + interpolation +
                 R"("}],"channels":[)" + channels + "]}]");
  }
};

std::string channel(const std::string& target) {
  return "{\"sampler\":0,\"target\":" + target + "}";
}

std::string to(const std::string& pointer) {
  return channel(R"({"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":")" + pointer +
                 R"("}}})");
}

}  // namespace

TEST_CASE("documents that are not glTF") {
  for (const char* const text : {"",
                                 " ",
                                 "{",
                                 "}",
                                 "[]",
                                 "1",
                                 "null",
                                 "{}",
                                 "{\"asset\":{}}",
                                 "{\"asset\":{\"version\":\"1.0\"}}",
                                 "glT",
                                 "glTF",
                                 "{\"asset\":{\"version\":\"2.0\"}} x",
                                 "{\"asset\":{\"version\":\"2.0\"}}}",
                                 "{\"asset\":{\"version\":\"2.0\"}",
                                 "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[}",
                                 "{\"asset\":{\"version\":\"2.0\"},\"nodes\":{}}",
                                 "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[[[[[[[[}",
                                 "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[],\"nodes\":[]}",
                                 "{\"asset\":{\"version\":\"2.0\xff\"}}"}) {
    INFO(text);
    error_of(text);
  }
  CHECK(error_of(std::string(1'000'000, '[')).kind == ErrorKind::bad_input);
  const std::string deep = R"({"asset":{"version":"2.0"},"extras":)" + std::string(2'000'000, '[') +
                           std::string(2'000'000, ']') + "}";
  CHECK(gltf::read_memory({deep.begin(), deep.end()}, "f", ""));  // nothing recurses
}

TEST_CASE("containers that are cut off or lie about their length") {
  const auto glb = [](std::uint32_t version, std::uint32_t length, std::uint32_t chunk, std::uint32_t type,
                      std::string json) {
    std::string out = "glTF";
    for (const std::uint32_t word : {version, length, chunk, type})
      out.append(reinterpret_cast<const char*>(&word), 4);
    return out + json;
  };
  const std::string json = R"({"asset":{"version":"2.0"}} )";
  const auto size = static_cast<std::uint32_t>(json.size());
  CHECK(gltf::read_memory(
      [&] {
        const auto g = glb(2, 20 + size, size, 0x4E4F534A, json);
        return std::vector<std::uint8_t>(g.begin(), g.end());
      }(),
      "f", ""));
  check_error(glb(1, 20 + size, size, 0x4E4F534A, json), "", "version 1");
  check_error(glb(2, 21 + size, size, 0x4E4F534A, json), "", "truncated");
  check_error(glb(2, 0xFFFFFFFF, size, 0x4E4F534A, json), "", "4294967295 bytes");
  check_error(glb(2, 20 + size, 0xFFFFFFFF, 0x4E4F534A, json), "", "chunk 0 has 4294967295 bytes");
  check_error(glb(2, 20 + size, size, 0x004E4942, json), "", "not JSON");
  check_error("glTF\2\0\0\0", "", "");
}

TEST_CASE("counts and offsets beyond what is there") {
  const auto with = [](const std::string& accessor,
                       const std::string& view = R"({"buffer":0,"byteLength":36})") {
    return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"data:;base64,)" +
           testing::base64(std::vector<std::uint8_t>(36)) + R"("}],"bufferViews":[)" + view +
           R"(],"accessors":[)" + accessor +
           R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  };
  const auto accessor = [](const std::string& count, const std::string& more = "") {
    return R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":)" + count + more + "}";
  };
  REQUIRE(gltf::read_memory(
      [&] {
        const auto t = with(accessor("3"));
        return std::vector<std::uint8_t>(t.begin(), t.end());
      }(),
      "f", ""));
  check_error(with(accessor("4")), "/accessors/0", "4 elements end at byte 48 of a buffer view of 36");
  check_error(with(accessor("4294967295")), "/accessors/0", "elements end at byte");
  check_error(with(accessor("9007199254740991")), "/accessors/0", "elements end at byte");
  check_error(with(accessor("18446744073709551615")), "/accessors/0/count", "is more than");
  check_error(with(accessor("0")), "/accessors/0/count", "at least 1");
  check_error(with(accessor("-1")), "/accessors/0/count", "integer");
  check_error(with(accessor("1.5")), "/accessors/0/count", "integer");
  check_error(with(accessor("\"3\"")), "/accessors/0/count", "integer");
  check_error(with(accessor("3", ",\"byteOffset\":4")), "/accessors/0", "byte 40");
  check_error(with(accessor("3", ",\"byteOffset\":9007199254740991")), "/accessors/0",
              "of a buffer view of 36");
  check_error(with(R"({"componentType":5126,"type":"VEC3","count":4294967295})"), "/accessors/0", "unfolds");
  check_error(with(R"({"componentType":5126,"type":"VEC9","count":3})"), "/accessors/0/type", "VEC9");
  check_error(with(R"({"componentType":5130,"type":"VEC3","count":3})"), "/accessors/0/componentType",
              "5130");
  check_error(with(R"({"bufferView":7,"componentType":5126,"type":"VEC3","count":3})"),
              "/accessors/0/bufferView", "index 7 of 1");
  check_error(with(accessor("3"), R"({"buffer":0,"byteLength":37})"), "/bufferViews/0", "in a buffer of 36");
  check_error(with(accessor("3"), R"({"buffer":0,"byteLength":36,"byteOffset":9007199254740991})"),
              "/bufferViews/0", "in a buffer of 36");
  check_error(with(accessor("3"), R"({"buffer":1,"byteLength":36})"), "/bufferViews/0/buffer",
              "index 1 of 1");
  check_error(with(accessor("3"), R"({"buffer":0,"byteLength":36,"byteStride":3})"),
              "/bufferViews/0/byteStride", "");
  check_error(with(accessor("3"), R"({"buffer":0,"byteLength":36,"byteStride":8})"), "/accessors/0",
              "byteStride of 8");
  const std::string sparse =
      R"(,"sparse":{"count":COUNT,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}})";
  const auto sparse_of = [&](const std::string& count) {
    return std::string(sparse).replace(sparse.find("COUNT"), 5, count);
  };
  check_error(with(accessor("3", sparse_of("4"))), "/accessors/0/sparse/count", "4 of 3");
  check_error(with(accessor("3", sparse_of("4294967295"))), "/accessors/0/sparse/count", "of 3");
  check_error(with(accessor("3", sparse_of("2"))), "/accessors/0/sparse/indices", "not strictly increasing");
  check_error(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":37,"uri":"data:;base64,AAAA"}]})",
              "/buffers/0/byteLength", "only 3");
  check_error(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":3,"uri":"data:;base64,A*AA"}]})",
              "/buffers/0/uri", "base64");
}

TEST_CASE("one accessor named a million times does not fill the memory") {
  GltfText g;
  const std::size_t positions = g.floats("VEC3", 100'000, std::vector<float>(300'000));
  std::string primitives;
  for (int i = 0; i < 2000;
       ++i) {  // 12 bytes of text are 1.2 MB of geometry, all different by their (equal) indices
    const std::size_t index = g.accessor_on("0", 5125, "SCALAR", 3);
    primitives += (i == 0 ? "{" : ",{") + std::string(R"("attributes":{"POSITION":)") + s(positions) +
                  "},\"indices\":" + s(index) + "}";
  }
  const std::string text = g.str("\"meshes\":[{\"primitives\":[" + primitives + "]}]");
  CHECK(error_of(text).what.find("unfolds") != std::string::npos);
}

TEST_CASE("meshes and materials") {
  GltfText g;
  const std::string position = s(g.floats("VEC3", 3, std::vector<float>(9)));
  const std::string two = s(g.floats("VEC3", 2, std::vector<float>(6)));
  const std::string nan = s(g.floats("VEC3", 3, {0, 0, 0, 0, INFINITY, 0, 0, 0, 0}));
  const std::string index = s(g.accessor("SCALAR", 3, std::vector<std::uint16_t>{0, 1, 3}));
  const auto mesh = [&](const std::string& primitive) {
    return g.str(R"("meshes":[{"primitives":[)" + primitive + "]}]");
  };
  check_error(mesh(R"({"attributes":{"POSITION":)" + position + "},\"indices\":" + index + "}"),
              "/meshes/0/primitives/0/indices", "element 2 is 3 of 3");
  check_error(mesh(R"({"attributes":{"POSITION":)" + position + ",\"NORMAL\":" + two + "}}"),
              "/meshes/0/primitives/0/attributes/NORMAL", "2 elements");
  check_error(mesh(R"({"attributes":{"POSITION":)" + nan + "}}"), "/accessors/" + nan,
              "element 1 is not finite");
  check_error(mesh(R"({"attributes":{"POSITION":99}})"), "/meshes/0/primitives/0/attributes/POSITION",
              "index 99 of 4");
  check_error(mesh(R"({"attributes":{"POSITION":)" + index + "}}"), "/accessors/" + index + "/type",
              "wants 3");
  check_error(mesh(R"({"attributes":{"POSITION":)" + position + "},\"material\":0}"),
              "/meshes/0/primitives/0/material", "index 0 of 0");
  check_error(mesh(R"({"attributes":{"POSITION":)" + position + "},\"mode\":7}"),
              "/meshes/0/primitives/0/mode", "more than 6");
  check_error(mesh(""), "/meshes/0/primitives", "empty");
  const auto material = [&](const std::string& m) { return g.str("\"materials\":[" + m + "]"); };
  check_error(material(R"({"normalTexture":{"index":0}})"), "/materials/0/normalTexture/index",
              "index 0 of 0");
  check_error(material(R"({"normalTexture":{}})"), "/materials/0/normalTexture/index", "missing");
  check_error(material(R"({"alphaMode":"blend"})"), "/materials/0/alphaMode", "'blend'");
  check_error(material(R"({"emissiveFactor":[1,2,3]})"), "/materials/0/emissiveFactor", "not in");
  check_error(material(R"({"emissiveFactor":[1,1]})"), "/materials/0/emissiveFactor", "2 numbers; wanted 3");
  check_error(material(R"({"emissiveFactor":[1,1,1,1]})"), "/materials/0/emissiveFactor",
              "4 numbers; wanted 3");
  check_error(material(R"({"pbrMetallicRoughness":{"metallicFactor":1e999}})"),
              "/materials/0/pbrMetallicRoughness/metallicFactor", "");
  check_error(material(R"({"doubleSided":1})"), "/materials/0/doubleSided", "true or false");
}

TEST_CASE("nodes") {
  GltfText g;
  const std::string mesh = g.triangle_mesh();
  const auto nodes = [&](const std::string& list, const std::string& more = "") {
    return g.str(mesh + more + ",\"nodes\":[" + list + "]");
  };
  check_error(nodes(R"({"children":[0]})"), "/nodes/0/children/0", "its own child");
  check_error(nodes(R"({"children":[1]},{"children":[0]})"), "/nodes/0", "its own ancestor");
  check_error(nodes(R"({"children":[1]},{"children":[2]},{"children":[1]})"), "/nodes/2/children/0",
              "already a child of node 0");
  check_error(nodes(R"({},{"children":[2]},{"children":[3]},{"children":[1]})"), "/nodes/1",
              "its own ancestor");
  check_error(nodes(R"({"children":[9]})"), "/nodes/0/children/0", "index 9 of 1");
  check_error(nodes(R"({"mesh":1})"), "/nodes/0/mesh", "index 1 of 1");
  check_error(nodes(R"({"camera":0})"), "/nodes/0/camera", "index 0 of 0");
  check_error(nodes(R"({"rotation":[0,0,0,0]})"), "/nodes/0/rotation", "not a rotation");
  check_error(nodes(R"({"translation":[0,0,1e39]})"), "/nodes/0/translation/2", "float32");
  check_error(nodes(R"({"translation":[0,0,NaN]})"), "/nodes/0/translation/2", "");
  check_error(nodes(R"({"translation":[0,0,"x"]})"), "/nodes/0/translation/2", "a number");
  check_error(nodes(R"({"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]})"), "/nodes/0/matrix", "last row");
  check_error(nodes(R"({"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"scale":[1,1,1]})"), "/nodes/0/matrix",
              "together");
  check_error(nodes(R"({"extensions":{"KHR_node_visibility":{"visible":"yes"}}})"),
              "/nodes/0/extensions/KHR_node_visibility/visible", "true or false");
  check_error(nodes(R"({"mesh":0})", R"(,"scene":1,"scenes":[{}])"), "/scene", "index 1 of 1");
  check_error(nodes(R"({"mesh":0})", R"(,"scenes":[{"nodes":[0,0]}])"), "/scenes/0/nodes/1", "twice");
  check_error(nodes(R"({"children":[1]},{})", R"(,"scenes":[{"nodes":[1]}])"), "/scenes/0/nodes/0",
              "not a root");
  check_error(nodes("{}", R"(,"extensionsRequired":["KHR_draco_mesh_compression","ACME_magic"])"),
              "/extensionsRequired/1", "ACME_magic");
  std::string deep;
  for (int i = 0; i < 600; ++i) deep += "{\"children\":[" + s(static_cast<std::size_t>(i) + 1) + "]},";
  check_error(nodes(deep + "{\"mesh\":0}"), "/nodes/512", "deeper than 512");
  check_error(nodes(R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{}}})"),
              "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", "none of");
  check_error(
      nodes(R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":5}}}})"),
      "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION", "index 5 of 1");
}

TEST_CASE("animations: what the validator does not notice, too") {
  const Animated a;
  const std::string at = "/animations/0/channels/0";
  const std::string visible = "/extensions/KHR_node_visibility/visible";
  const auto scale = channel(R"({"node":0,"path":"scale"})");
  {
    const std::string text = a.with(a.times, a.booleans, "STEP", to("/nodes/0" + visible));
    REQUIRE(gltf::read_memory({text.begin(), text.end()}, "f", ""));
  }
  check_error(a.with(a.times, a.booleans, "STEP", to("/nodes/9" + visible)), at + "/target",
              "index 9 of 3 nodes");
  check_error(a.with(a.times, a.booleans, "STEP", to("/nodes/1" + visible)), at,
              "no extensions.KHR_node_visibility");
  check_error(a.with(a.times, a.booleans, "LINEAR", to("/nodes/0" + visible)), at, "STEP");
  check_error(a.with(a.times, a.vec3, "STEP", to("/nodes/0" + visible)), at, "3 components");
  check_error(a.with(a.times, a.vec3, "STEP", to("/materials/0/pbrMetallicRoughness/baseColorFactor")), at,
              "wants 4");
  check_error(a.with(a.times, a.vec3, "STEP", to("/materials/1/emissiveFactor")), at + "/target",
              "index 1 of 1");
  check_error(a.with(a.times, a.three, "STEP", to("/nodes/0" + visible)), "/animations/0/samplers/0",
              "2 times, but 3 values");
  check_error(a.with(a.times, a.vec3, "CUBICSPLINE", scale), "/animations/0/samplers/0", "three a time");
  check_error(a.with(a.times, a.booleans, "STEP", to("/nodes/0" + visible) + "," + to("/nodes/0" + visible)),
              "/animations/0/channels/1", "second channel");
  check_error(a.with(a.times, a.vec3, "STEP", scale + "," + to("/nodes/0/scale")), "/animations/0/channels/1",
              "second channel");
  check_error(a.with(a.times, a.vec3, "STEP",
                     to("/materials/0/emissiveFactor") + "," + to("/materials/0/emissiveFactor")),
              "/animations/0/channels/1", "second channel");
  {  // gltf-transform leaves such channels behind: the rest of the file plays, and the channel is named
    const std::string text = a.with(a.times, a.booleans, "STEP", channel(R"({"path":"pointer"})"));
    const auto r = gltf::read_memory({text.begin(), text.end()}, "f", "");
    REQUIRE(r);
    REQUIRE(r->ignored.size() == 1);
    CHECK(r->ignored[0].where == at + "/target");
    CHECK(r->scene.tracks.empty());
  }
  check_error(
      a.with(
          a.times, a.booleans, "STEP",
          channel(
              R"({"path":"pointer","node":0,"extensions":{"KHR_animation_pointer":{"pointer":"/nodes/0/scale"}}})")),
      at + "/target/node", "absent");
  check_error(a.with(a.times, a.booleans, "STEP", channel(R"({"path":"visible","node":0})")),
              at + "/target/path", "'visible'");
  check_error(a.with(a.equal_times, a.vec3, "STEP", scale), "/animations/0/samplers/0/input",
              "do not increase at element 1");
  check_error(a.with(a.negative_times, a.vec3, "STEP", scale), "/animations/0/samplers/0/input", "negative");
  check_error(a.with(a.nan_times, a.vec3, "STEP", scale), "/accessors/" + a.nan_times, "not finite");
  check_error(a.with(a.times, a.vec3, "STEPPED", scale), "/animations/0/samplers/0/interpolation",
              "'STEPPED'");
  check_error(a.with("77", a.vec3, "STEP", scale), "/animations/0/samplers/0/input", "index 77");
  check_error(a.with(a.times, "77", "STEP", scale), "/animations/0/samplers/0/output", "index 77");
  check_error(a.with(a.times, a.vec4, "LINEAR", channel(R"({"node":0,"path":"rotation"})")), at,
              "key 0 is not a rotation");
  check_error(a.with(a.times, a.vec3, "STEP", channel(R"({"node":3,"path":"scale"})")), at + "/target",
              "index 3 of 3");
  check_error(a.with(a.times, a.vec3, "STEP", channel(R"({"node":2,"path":"scale"})")), at, "matrix");
  check_error(a.with(a.times, a.vec3, "STEP", R"({"sampler":1,"target":{"node":0,"path":"scale"}})"),
              at + "/sampler", "index 1 of 1");
}

TEST_CASE("nested visibility tracks may not unfold without bound") {
  // One parent of 20 000 keys and children with 2 distinct keys each would be 20 000 x children keys.
  GltfText g;
  const std::string mesh = g.triangle_mesh();
  constexpr std::size_t kKeys = 20'000, kChildren = 400;
  std::vector<float> times(kKeys), values;
  for (std::size_t i = 0; i < kKeys; ++i) times[i] = static_cast<float>(i);
  for (std::size_t i = 0; i < kKeys; ++i) values.insert(values.end(), 3, static_cast<float>(i % 2));
  std::string samplers = R"({"input":)" + s(g.floats("SCALAR", kKeys, times)) +
                         ",\"output\":" + s(g.floats("VEC3", kKeys, values)) + ",\"interpolation\":\"STEP\"}";
  std::string channels = R"({"sampler":0,"target":{"node":0,"path":"scale"}})";
  const std::string out = s(g.floats("VEC3", 2, {0, 0, 0, 1, 1, 1}));
  std::string children, nodes;
  for (std::size_t i = 1; i <= kChildren; ++i) {
    children += (i == 1 ? "" : ",") + s(i);
    nodes += ",{\"mesh\":0}";
    samplers += R"(,{"input":)" + s(g.floats("SCALAR", 2, {0, static_cast<float>(i)})) +
                ",\"output\":" + out + ",\"interpolation\":\"STEP\"}";
    channels += ",{\"sampler\":" + s(i) + R"(,"target":{"node":)" + s(i) + R"(,"path":"scale"}})";
  }
  const std::string text =
      g.str(mesh + ",\"nodes\":[{\"children\":[" + children + "]}" + nodes +
            R"(],"animations":[{"samplers":[)" + samplers + "],\"channels\":[" + channels + "]}]");
  CHECK(error_of(text).what.find("unfold") != std::string::npos);
}

namespace {

std::vector<std::uint8_t> file_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Reading damaged bytes either fails in one line or gives a valid scene.
void check_damaged(std::vector<std::uint8_t> bytes) {
  const auto read = gltf::read_memory(std::move(bytes), "f", "");
  if (!read) {
    if (read.error().what.empty() || read.error().str().find('\n') != std::string::npos)
      FAIL("error: " << read.error().str());
    return;
  }
  for (const Finding& f : validate(read->scene, 1))
    FAIL("rule " << f.rule << ": " << f.where << ": " << f.what);
}

/// `good` with something wrong.
template <class Below>
std::vector<std::uint8_t> damaged(const std::vector<std::uint8_t>& good, const Below& below) {
  std::vector<std::uint8_t> bad = good;
  switch (below(4)) {
    case 0:  // a bit
      bad[below(bad.size())] ^= static_cast<std::uint8_t>(1U << below(8));
      break;
    case 1: {  // a digit of the JSON
      const std::uint64_t from = below(bad.size());
      for (std::uint64_t k = from; k < bad.size(); ++k) {
        if (bad[k] < '0' || bad[k] > '9') continue;
        bad[k] = static_cast<std::uint8_t>('0' + below(10));
        break;
      }
      break;
    }
    case 2:  // cut off, the header made to agree
      bad.resize(below(bad.size()));
      if (bad.size() >= 12) {
        const auto size = static_cast<std::uint32_t>(bad.size());
        std::memcpy(&bad[8], &size, 4);
      }
      break;
    default: {  // a piece copied over another
      const std::uint64_t length = 1 + below(64);
      const std::uint64_t a = below(bad.size() - length), b = below(bad.size() - length);
      std::memmove(&bad[a], &bad[b], length);
    }
  }
  return bad;
}

}  // namespace

TEST_CASE("every file of ours, damaged a thousand times") {
  std::string name = (std::filesystem::temp_directory_path() / "scenegen_damage_XXXXXX").string();
  REQUIRE(mkdtemp(name.data()) != nullptr);
  const Scene everything = testing::everything_scene();
  const Scene kinds = timeline::test::RandomScene(1).make_kinds(30, 2);  // with looks in groups
  std::uint64_t n = 0;
  const Random random(1, "damage");
  const auto below = [&](std::uint64_t most) { return random.below(n++, most); };
  for (const auto layout :
       {gltf::Layout::nodes, gltf::Layout::groups, gltf::Layout::instances, gltf::Layout::merged}) {
    for (const auto visibility : {gltf::VisibilityEncoding::scale, gltf::VisibilityEncoding::pointer,
                                  gltf::VisibilityEncoding::both}) {
      for (const Scene* const scene : {&everything, &kinds}) {
        REQUIRE(gltf::write(*scene, name + "/f.glb", {layout, visibility, 1}));
        const std::vector<std::uint8_t> good = file_bytes(name + "/f.glb");
        for (int i = 0; i < 1000; ++i) check_damaged(damaged(good, below));
      }
    }
  }
  std::filesystem::remove_all(name);
}
