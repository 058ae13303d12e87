#include "tests/support/patch_sources.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/support/synthetic_scene.h"

namespace scenegen::testing {

namespace {

using nlohmann::json;

/// A buffer and the accessors on it.
class Data {
 public:
  std::size_t add(const std::string& type, int components, const std::vector<float>& values,
                  bool vertices = false, bool bounds = false) {
    json accessor = {{"bufferView", view(values)},
                     {"componentType", 5126},
                     {"count", values.size() / static_cast<std::size_t>(components)},
                     {"type", type}};
    if (vertices) views_.back()["target"] = 34962;
    if (bounds) add_bounds(accessor, values, static_cast<std::size_t>(components));
    accessors_.push_back(accessor);
    return accessors_.size() - 1;
  }
  std::size_t joints(std::size_t count) {
    const std::vector<std::uint8_t> zeros(count * 4, 0);
    accessors_.push_back(
        {{"bufferView", view(zeros)}, {"componentType", 5121}, {"count", count}, {"type", "VEC4"}});
    views_.back()["target"] = 34962;
    return accessors_.size() - 1;
  }

  template <class T>
  std::size_t view(const std::vector<T>& values) {
    const std::size_t offset = bytes.size();
    bytes.resize((offset + values.size() * sizeof(T) + 3) / 4 * 4);
    std::memcpy(bytes.data() + offset, values.data(), values.size() * sizeof(T));
    views_.push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", values.size() * sizeof(T)}});
    return views_.size() - 1;
  }

  void put(json& document, const std::string& uri) {
    document["accessors"] = accessors_;
    document["bufferViews"] = views_;
    document["buffers"] = {{{"byteLength", bytes.size()}, {"uri", uri}, {"name", "data"}}};
  }

  std::vector<char> bytes;

 private:
  static void add_bounds(json& accessor, const std::vector<float>& values, std::size_t components) {
    std::vector<float> lo(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(components)), hi = lo;
    for (std::size_t i = 0; i < values.size(); ++i) {
      lo[i % components] = std::min(lo[i % components], values[i]);
      hi[i % components] = std::max(hi[i % components], values[i]);
    }
    accessor["min"] = lo;
    accessor["max"] = hi;
  }

  json accessors_ = json::array(), views_ = json::array();
};

void add_meshes(json& document, Data& data) {
  const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::size_t position = data.add("VEC3", 3, corners, true, true);
  const std::size_t uv = data.add("VEC2", 2, {0, 0, 1, 0, 0, 1}, true);
  const std::size_t moved = data.add("VEC3", 3, {0, 0, 1, 0, 0, 1, 0, 0, 1}, true, true);
  const std::size_t weights = data.add("VEC4", 4, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, true);
  const std::size_t joints = data.joints(3);
  const json plain = {{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}}}, {"material", 0}};
  json second = {
      {"attributes", {{"POSITION", data.add("VEC3", 3, {0, 0, 0, 0, 2, 0, 0, 0, 2}, true, true)}}}};
  second["extras"] = {{"part", "second"}};
  json morphed = plain;
  morphed["targets"] = {{{"POSITION", moved}}};
  morphed["attributes"]["_HEAT"] = data.add("SCALAR", 1, {0.5F, 0.25F, 0}, true);
  json skinned = plain;
  skinned["attributes"]["JOINTS_0"] = joints;
  skinned["attributes"]["WEIGHTS_0"] = weights;
  document["meshes"] = {{{"name", "plain"}, {"primitives", {plain}}},
                        {{"name", "two parts"}, {"primitives", {plain, second}}, {"extras", {1, 2, 3}}},
                        {{"name", "morphed"}, {"primitives", {morphed}}, {"weights", {0.25}}},
                        {{"name", "skinned"}, {"primitives", {skinned}}}};
}

void add_materials(json& document) {
  document["materials"] = {{{"name", "glossy"},
                            {"pbrMetallicRoughness",
                             {{"baseColorTexture", {{"index", 0}}}, {"baseColorFactor", {1, 0.5, 0.5, 1}}}},
                            {"extensions", {{"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}}}}},
                            {"extras", {{"supplier", "ACME"}}}},
                           {{"doubleSided", true}, {"emissiveFactor", {0.5, 0, 0}}}};
  document["textures"] = {{{"source", 0}, {"sampler", 0}}};
  document["samplers"] = {{{"magFilter", 9729}, {"wrapS", 33071}}};
  document["images"] = {{{"uri", "picture.png"}, {"name", "a picture"}}};
}

void add_nodes(json& document, Data& data) {
  const json skewed = {1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1};
  const json placed = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 4, 0, 1, 1};
  document["nodes"] = {
      {{"name", "Root"},
       {"children", {1, 2, 3, 4, 5, 6, 7, 9}},
       {"translation", {0, 1.5, 0}},
       {"extras", "text"}},
      {{"name", "Crate"}, {"mesh", 1}, {"scale", {1, 2, 1}}, {"extras", {{"guid", "2O2Fr$t4X7Zf8NOew3FL"}}}},
      {{"name", "Arm"}, {"mesh", 0}, {"children", {8}}, {"translation", {1, 0, 0}}},
      {{"name", "Skewed"}, {"mesh", 0}, {"matrix", skewed}},
      {{"name", "Placed"},
       {"mesh", 1},
       {"matrix", placed},
       {"extensions", {{"VENDOR_thing", {{"a", {1, 2}}}}}}},
      {{"name", "Lamp"}, {"mesh", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
      {{"name", "Eye"}, {"mesh", 0}, {"children", {10}}, {"extras", {1, 2}}},
      {{"name", "Bone"}, {"mesh", 0}, {"translation", {0, 0, 2}}},
      {{"name", "Hand"}, {"mesh", 0}, {"scale", {1, 1, 1}}},
      {{"name", "Morphed"}, {"mesh", 2}, {"weights", {0.75}}, {"translation", {0, 3, 0}}},
      {{"name", "View"}, {"camera", 0}},
      {{"name", "Skinned"}, {"mesh", 3}, {"skin", 0}},
      {{"name", "Cube"},
       {"mesh", 0},
       {"translation", {5, 0, 0}},
       {"extras", {{"scenegen", {{"note", "mine"}}}}}},
      {{"name", "Cube"}, {"mesh", 0}, {"children", {14}}, {"translation", {6, 0, 0}}},
      {{"mesh", 0}, {"translation", {0, 0, 1}}, {"extras", 7}},
      {{"name", "nothing"}, {"mesh", 0}, {"scale", {0, 0, 0}}},
      {{"mesh", 1}, {"translation", {0, 0, 7}}}};
  document["scenes"] = {{{"name", "main"}, {"nodes", {0, 11, 12, 13, 15, 16}}},
                        {{"name", "other"}, {"nodes", {12, 16}}, {"extras", {{"kept", true}}}}};
  document["scene"] = 0;
  document["skins"] = {{{"joints", {7}}, {"name", "skin"}}};
  document["cameras"] = {
      {{"type", "perspective"}, {"name", "lens"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};

  const std::size_t input = data.add("SCALAR", 1, {0, 1, 2}, false, true);
  const float half = 0.70710677F;
  json samplers = {
      {{"input", input}, {"output", data.add("VEC4", 4, {0, 0, 0, 1, 0, half, 0, half, 0, 0, 0, 1})}},
      {{"input", input}, {"output", data.add("VEC3", 3, {1, 1, 1, 2, 1, 1, 1, 1, 1})}},
      {{"input", input}, {"output", data.add("SCALAR", 1, {0, 1, 0})}}};
  json channels = {
      {{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}},
      {{"sampler", 1}, {"target", {{"node", 8}, {"path", "scale"}}}},
      {{"sampler", 2}, {"target", {{"node", 9}, {"path", "weights"}}}, {"extras", {{"kept", 1}}}}};
  document["animations"] = {{{"name", "walk"}, {"samplers", samplers}, {"channels", channels}},
                            {{"name", "jump"},
                             {"samplers", {samplers[1], samplers[2]}},
                             {"channels",
                              {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "scale"}}}},
                               {{"sampler", 1}, {"target", {{"path", "weights"}, {"node", 9}}}}}}}};
}

}  // namespace

void write_everything_document(const std::string& path) {
  json document;
  Data data;
  document["asset"] = {{"version", "2.0"},
                       {"generator", "another program"},
                       {"copyright", "somebody"},
                       {"extras", {{"author", "somebody"}}}};
  document["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_clearcoat", "VENDOR_thing"};
  document["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}, {"name", "bulb"}}}}}},
                            {"VENDOR_thing", {{"b", nullptr}}}};
  document["extras"] = {{"anything", {true, false, nullptr, 1e-7, "\u00e9\u4e16"}}};
  add_materials(document);
  add_meshes(document, data);
  add_nodes(document, data);
  const std::filesystem::path place(path);
  data.put(document, place.stem().string() + ".bin");
  std::ofstream(place.parent_path() / (place.stem().string() + ".bin"), std::ios::binary)
      .write(data.bytes.data(), static_cast<std::streamsize>(data.bytes.size()));
  const std::vector<std::uint8_t> picture = everything_scene().images[0].bytes;
  std::ofstream(place.parent_path() / "picture.png", std::ios::binary)
      .write(reinterpret_cast<const char*>(picture.data()), static_cast<std::streamsize>(picture.size()));
  // Other spellings of what JSON can say.
  std::string text = document.dump(2);
  const auto respell = [&](const std::string& from, const std::string& to) {
    if (const std::size_t at = text.find(from); at != std::string::npos) text.replace(at, from.size(), to);
  };
  respell("1.5,", "1.50e0,");
  respell("ACME", "\\u0041CME");
  std::ofstream(path) << text << "\n\n";
}

void write_instanced_document(const std::string& path) {
  Data data;
  json document;
  document["asset"] = {{"version", "2.0"}};
  const std::size_t position = data.add("VEC3", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0}, true, true);
  document["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}}}}}};
  const std::size_t places = data.add("VEC3", 3, {0, 0, 0, 2, 0, 0, 4, 0, 0});
  document["nodes"] = {
      {{"mesh", 0},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}}};
  document["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  document["scenes"] = {{{"nodes", {0}}}};
  const std::filesystem::path place(path);
  data.put(document, place.stem().string() + ".bin");
  std::ofstream(place.parent_path() / (place.stem().string() + ".bin"), std::ios::binary)
      .write(data.bytes.data(), static_cast<std::streamsize>(data.bytes.size()));
  std::ofstream(path) << document.dump();
}

}  // namespace scenegen::testing
