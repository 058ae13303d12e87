// What is in the files: the validator's blind spots, what is shared, and that the file says what the scene
// says.
#include "scene/gltf/write.h"

#include <catch2/catch.hpp>
#include <map>
#include <optional>
#include <set>

#include "tests/support/gltf_file.h"
#include "tests/support/synthetic_scene.h"

using namespace scenegen;
using gltf::Layout;
using gltf::VisibilityEncoding;
using nlohmann::json;
using testing::GltfFile;

namespace {

struct Written {
  GltfFile file;
  gltf::WriteReport report;
};

Written write_glb(const Scene& scene, Layout layout, VisibilityEncoding encoding) {
  const testing::TemporaryFolder folder;
  const auto report = gltf::write(scene, folder.path("a.glb"), {layout, encoding, 1});
  REQUIRE(report.has_value());
  return {GltfFile::from_glb(testing::file_bytes(folder.path("a.glb"))), *report};
}

/// Value of a STEP sampler at a time, component 0; of anything when `component` is given.
double step_value(const GltfFile& file, const json& sampler, double time_s, std::size_t component = 0) {
  const std::vector<double> times = file.numbers(sampler.at("input"));
  const std::vector<double> values = file.numbers(sampler.at("output"));
  const std::size_t width = values.size() / times.size();
  std::size_t key = 0;
  while (key + 1 < times.size() && times[key + 1] <= time_s) ++key;
  return values.at(key * width + component);
}

/// Plays visibility from the file alone.
class FilePlayer {
 public:
  explicit FilePlayer(const GltfFile& file) : file_(file), parents_(file.parents()) {
    if (!file.json.contains("animations")) return;
    const json& animation = file.json["animations"][0];
    for (const json& channel : animation["channels"]) {
      const json& sampler = animation["samplers"].at(channel["sampler"].get<std::size_t>());
      const json& target = channel["target"];
      if (target["path"] == "pointer") {
        const std::string pointer = target["extensions"]["KHR_animation_pointer"]["pointer"];
        if (pointer.starts_with("/nodes/"))
          pointer_[static_cast<std::size_t>(std::stoul(pointer.substr(7)))] = &sampler;
      } else if (target["path"] == "scale") {
        scale_[target["node"]] = &sampler;
      }
    }
  }
  bool shown(std::size_t node, double time_s, bool by_pointer, bool by_scale) const {
    for (int n = static_cast<int>(node); n >= 0; n = parents_[static_cast<std::size_t>(n)]) {
      const auto at = static_cast<std::size_t>(n);
      if (by_pointer && pointer_.contains(at) && step_value(file_, *pointer_.at(at), time_s) == 0.0)
        return false;
      if (by_scale && scale_.contains(at) && step_value(file_, *scale_.at(at), time_s) == 0.0) return false;
    }
    return true;
  }

 private:
  const GltfFile& file_;
  std::vector<int> parents_;
  std::map<std::size_t, const json*> pointer_, scale_;
};

struct Place {
  std::size_t node = 0;
  std::optional<glm::dmat4> instance;
};

/// Where every object of the scene is in the file, found by what FORMAT.md says.
std::vector<Place> places_of(const GltfFile& file, const Scene& scene) {
  std::vector<std::optional<Place>> places(scene.objects.size());
  const json& nodes = file.json["nodes"];
  if (file.json["asset"]["extras"]["scenegen"]["layout"] != "instances") {
    for (std::size_t i = 0; i < places.size(); ++i) {
      CHECK(nodes[i]["name"] == std::string(scene.objects.names[i]));
      places[i] = Place{i, {}};
    }
  } else {
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const json extras = nodes[n].value("/extras/scenegen"_json_pointer, json::object());
      if (extras.contains("object")) {
        CHECK(nodes[n]["name"] == std::string(scene.objects.names[extras["object"]]));
        places[extras["object"]] = Place{n, {}};
      }
      const json::json_pointer at("/extensions/EXT_mesh_gpu_instancing/attributes");
      if (!nodes[n].contains(at)) continue;
      const json& attributes = nodes[n][at];
      const std::vector<double> ids = file.numbers(attributes.at("_OBJECT_ID"));
      std::vector<double> t = file.numbers(attributes.at("TRANSLATION")), r, s;
      for (std::size_t k = 0; k < ids.size(); ++k) {
        r.insert(r.end(), {0, 0, 0, 1});
        s.insert(s.end(), {1, 1, 1});
      }
      if (attributes.contains("ROTATION")) r = file.numbers(attributes["ROTATION"]);
      if (attributes.contains("SCALE")) s = file.numbers(attributes["SCALE"]);
      REQUIRE(t.size() == ids.size() * 3);
      REQUIRE(r.size() == ids.size() * 4);
      REQUIRE(s.size() == ids.size() * 3);
      for (std::size_t k = 0; k < ids.size(); ++k) {
        const auto part = [k](const std::vector<double>& v, std::size_t w) {
          return std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(k * w),
                                     v.begin() + static_cast<std::ptrdiff_t>((k + 1) * w));
        };
        auto& place = places.at(static_cast<std::size_t>(ids[k]));
        CHECK(!place.has_value());
        place = Place{n, testing::trs_matrix(part(t, 3), part(r, 4), part(s, 3))};
      }
    }
  }
  std::vector<Place> all;
  for (const auto& place : places) {
    REQUIRE(place.has_value());
    all.push_back(*place);
  }
  return all;
}

bool visible_in_scene(const Scene& scene, std::size_t object, double time_s) {
  const TrackId track = scene.objects.visibility[object];
  if (!track.valid()) return true;
  const auto times = scene.times_s(track);
  std::size_t key = 0;
  while (key + 1 < times.size() && static_cast<double>(times[key + 1]) <= time_s) ++key;
  return scene.values(track)[key] != 0.0F;
}

/// Every key time of the scene, just before it, and the ends.
std::set<double> interesting_times(const Scene& scene) {
  std::set<double> times{0.0, static_cast<double>(scene.duration_s)};
  for (const float t : scene.track_times_s) {
    times.insert(static_cast<double>(t));
    if (t > 0.0F) times.insert(static_cast<double>(t) - 1e-3);
  }
  return times;
}

void check_visibility(const Scene& scene, const GltfFile& file, VisibilityEncoding encoding) {
  const FilePlayer player(file);
  const std::vector<Place> places = places_of(file, scene);
  for (const double time_s : interesting_times(scene)) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      // Scale of what an object hangs on is tested apart: frames of the test scene never shrink to zero.
      const bool expected = visible_in_scene(scene, i, time_s);
      CAPTURE(time_s, i, scene.objects.names[i]);
      if (encoding != VisibilityEncoding::scale)
        CHECK(player.shown(places[i].node, time_s, true, false) == expected);
      if (encoding != VisibilityEncoding::pointer)
        CHECK(player.shown(places[i].node, time_s, false, true) == expected);
    }
  }
}

void check_transforms_and_meshes(const Scene& scene, const GltfFile& file) {
  const std::vector<int> parents = file.parents();
  const std::vector<glm::mat4> frames = rest_frame_matrices(scene);
  const std::vector<Place> places = places_of(file, scene);
  for (std::size_t i = 0; i < places.size(); ++i) {
    glm::dmat4 world = places[i].instance.value_or(glm::dmat4(1.0));
    for (int n = static_cast<int>(places[i].node); n >= 0; n = parents[static_cast<std::size_t>(n)])
      world = file.local_matrix(static_cast<std::size_t>(n)) * world;
    const glm::mat4 expected = rest_world_from_object(scene, frames, ObjectId(i));
    CAPTURE(i, scene.objects.names[i]);
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 4; ++r)
        CHECK(world[c][r] == Approx(static_cast<double>(expected[c][r])).margin(1e-5));
    }
    const json& node = file.json["nodes"][places[i].node];
    if (node.contains("mesh")) {
      CHECK(node["mesh"] == scene.objects.mesh[i].value);
    } else {
      CHECK(node["extras"]["scenegen"]["mesh"] == scene.objects.mesh[i].value);
    }
  }
}

std::string resolve(const json& document, const std::string& pointer) {
  // /nodes/N/extensions/KHR_node_visibility/visible has a default; its owner must be there.
  const std::string owner = pointer.ends_with("/visible") ? pointer.substr(0, pointer.size() - 8) : pointer;
  return document.contains(json::json_pointer(owner)) ? "" : pointer;
}

/// INTEROP 4: what the validator does not see.
void check_animation(const Scene& scene, const GltfFile& file) {
  REQUIRE(file.json["animations"].size() == 1);
  const json& animation = file.json["animations"][0];
  CHECK(animation["name"] == "timeline");
  std::set<std::string> targets;
  std::set<std::size_t> used_samplers;
  for (const json& channel : animation["channels"]) {
    const json& target = channel["target"];
    CHECK(targets.insert(target.dump()).second);  // no two channels on one property
    used_samplers.insert(channel["sampler"].get<std::size_t>());
    const json& sampler = animation["samplers"].at(channel["sampler"].get<std::size_t>());
    const json& output = file.json["accessors"].at(sampler["output"].get<std::size_t>());
    if (target["path"] == "pointer") {
      CHECK(!target.contains("node"));
      const std::string pointer = target["extensions"]["KHR_animation_pointer"]["pointer"];
      CHECK(resolve(file.json, pointer).empty());
      if (pointer.ends_with("/visible")) {
        CHECK(sampler["interpolation"] == "STEP");
        CHECK(output["componentType"] == 5121);
        CHECK(output["type"] == "SCALAR");
      } else {
        CHECK(output["type"] == (pointer.ends_with("/emissiveFactor") ? "VEC3" : "VEC4"));
      }
    } else {
      CHECK(target["node"].get<std::size_t>() < file.json["nodes"].size());
      CHECK(!file.json["nodes"][target["node"].get<std::size_t>()].contains("matrix"));
      CHECK(output["type"] == (target["path"] == "rotation" ? "VEC4" : "VEC3"));
    }
  }
  CHECK(used_samplers.size() == animation["samplers"].size());

  std::set<std::string> samplers;
  std::map<std::size_t, std::vector<double>> inputs, outputs;
  for (const json& sampler : animation["samplers"]) {
    CHECK(samplers.insert(sampler.dump()).second);
    const std::vector<double> times = file.numbers(sampler["input"]);
    const std::vector<double> values = file.numbers(sampler["output"]);
    inputs[sampler["input"]] = times;
    outputs[sampler["output"]] = values;
    const std::size_t elements = file.json["accessors"][sampler["output"].get<std::size_t>()]["count"];
    const bool spline = sampler["interpolation"] == "CUBICSPLINE";
    CHECK(elements == times.size() * (spline ? 3 : 1));
    CHECK(times.front() == 0.0);
    CHECK(times.back() == static_cast<double>(scene.duration_s));
    for (std::size_t k = 1; k < times.size(); ++k) CHECK(times[k] > times[k - 1]);
    const json& input = file.json["accessors"][sampler["input"].get<std::size_t>()];
    CHECK(input["min"][0].get<float>() == 0.0F);
    CHECK(input["max"][0].get<float>() == scene.duration_s);
  }
  const auto all_distinct = [](const auto& accessors) {
    std::set<std::vector<double>> contents;
    for (const auto& [index, numbers] : accessors) contents.insert(numbers);
    return contents.size() == accessors.size();
  };
  CHECK(all_distinct(inputs));
  for (auto& [index, numbers] : outputs)  // equal numbers of another type are another accessor
    numbers.push_back(
        1e6 * static_cast<double>(file.json["accessors"][index]["type"].get<std::string>().back()) +
        file.json["accessors"][index]["componentType"].get<double>());
  CHECK(all_distinct(outputs));
}

void check_hierarchy_and_names(const GltfFile& file) {
  const json& nodes = file.json["nodes"];
  const std::vector<int> parents = file.parents();
  std::set<std::size_t> roots = file.json["scenes"][0]["nodes"].get<std::set<std::size_t>>();
  CHECK(roots.size() == file.json["scenes"][0]["nodes"].size());
  std::set<std::string> names;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    CHECK((parents[n] < 0) == roots.contains(n));
    CHECK(names.insert(nodes[n].at("name")).second);
    if (nodes[n].contains("children")) CHECK(!nodes[n]["children"].empty());
    std::size_t depth = 0;  // reaches a root: no cycle
    for (int at = static_cast<int>(n); at >= 0 && depth <= nodes.size();
         at = parents[static_cast<std::size_t>(at)])
      ++depth;
    CHECK(depth <= nodes.size());
  }
}

void check_accessors(const GltfFile& file) {
  for (std::size_t a = 0; a < file.json["accessors"].size(); ++a) CHECK(!file.numbers(a).empty());
  for (const json& mesh : file.json["meshes"]) {
    for (const json& primitive : mesh["primitives"]) {
      const json& position = file.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
      CHECK(position.contains("min"));
      CHECK(position.contains("max"));
      for (const auto& [name, accessor] : primitive["attributes"].items()) {
        const json& view =
            file.json["bufferViews"]
                     [file.json["accessors"][accessor.get<std::size_t>()]["bufferView"].get<std::size_t>()];
        CHECK(view.contains("byteStride"));
      }
    }
  }
}

constexpr std::pair<Layout, VisibilityEncoding> kCombinations[] = {
    {Layout::nodes, VisibilityEncoding::scale},     {Layout::nodes, VisibilityEncoding::pointer},
    {Layout::nodes, VisibilityEncoding::both},      {Layout::groups, VisibilityEncoding::scale},
    {Layout::groups, VisibilityEncoding::pointer},  {Layout::groups, VisibilityEncoding::both},
    {Layout::instances, VisibilityEncoding::scale}, {Layout::instances, VisibilityEncoding::pointer},
    {Layout::instances, VisibilityEncoding::both}};

}  // namespace

TEST_CASE("every combination says what the scene says") {
  const Scene scene = testing::everything_scene();
  for (const auto& [layout, encoding] : kCombinations) {
    const Written written = write_glb(scene, layout, encoding);
    const GltfFile& file = written.file;
    INFO("layout " << static_cast<int>(layout) << " encoding " << static_cast<int>(encoding));
    CHECK(written.report.layout == layout);
    check_hierarchy_and_names(file);
    check_accessors(file);
    check_animation(scene, file);
    check_transforms_and_meshes(scene, file);
    check_visibility(scene, file, encoding);
    CHECK(written.report.nodes == file.json["nodes"].size());
    CHECK(written.report.accessors == file.json["accessors"].size());
    CHECK(written.report.samplers == file.json["animations"][0]["samplers"].size());
    CHECK(written.report.channels == file.json["animations"][0]["channels"].size());
  }
}

TEST_CASE("extensions are declared exactly when they are used") {
  const Scene scene = testing::everything_scene();
  for (const auto& [layout, encoding] : kCombinations) {
    const json document = write_glb(scene, layout, encoding).file.json;
    std::set<std::string> in_use;
    const auto collect = [&](const json& tree, const auto& self) -> void {
      if (tree.is_object() && tree.contains("extensions"))
        for (const auto& [name, ignored] : tree["extensions"].items()) in_use.insert(name);
      if (tree.is_structured())
        for (const auto& child : tree) self(child, self);
    };
    collect(document, collect);
    CHECK(document["extensionsUsed"].get<std::set<std::string>>() == in_use);
    std::set<std::string> required;
    if (layout == Layout::instances) required.insert("EXT_mesh_gpu_instancing");
    CHECK(document.value("extensionsRequired", std::set<std::string>{}) == required);
    CHECK(in_use.contains("KHR_node_visibility") == (encoding != VisibilityEncoding::scale));
  }
}

TEST_CASE("a static scene is core glTF without animation") {
  Scene scene = testing::town_scene(10, 1);
  for (TrackId& track : scene.objects.visibility) track = {};
  const json document = write_glb(scene, Layout::automatic, VisibilityEncoding::both).file.json;
  CHECK(!document.contains("animations"));
  CHECK(!document.contains("extensionsUsed"));
  CHECK(document["nodes"].size() == 10);
}

TEST_CASE("times, values and samplers are shared as far as they are equal") {
  // 2400 objects of 2 sizes and 3 meshes at 64 moments; both sizes and all meshes occur at every moment.
  const Scene town = testing::town_scene(2400, 64);
  const std::uint64_t moments = 64, geometry = 2,
                      lists = 22;  // lists: of rotations and of scales, all different
  struct Expected {
    Layout layout;
    VisibilityEncoding encoding;
    std::uint64_t channels, samplers, accessors, nodes;
  };
  const Expected table[] = {
      {Layout::nodes, VisibilityEncoding::scale, 2400, 2 * moments, geometry + moments + 2, 2400},
      {Layout::nodes, VisibilityEncoding::pointer, 2400, moments, geometry + moments + 1, 2400},
      {Layout::nodes, VisibilityEncoding::both, 4800, 3 * moments, geometry + moments + 3, 2400},
      {Layout::groups, VisibilityEncoding::scale, moments, moments, geometry + moments + 1, 2400 + moments},
      {Layout::groups, VisibilityEncoding::both, 2 * moments, 2 * moments, geometry + moments + 2,
       2400 + moments},
      {Layout::instances, VisibilityEncoding::scale, 3 * moments, moments,
       geometry + moments + 1 + 2 * 3 * moments + lists, 3 * moments},
  };
  for (const Expected& expected : table) {
    const auto report = gltf::predict(town, "a.glb", {expected.layout, expected.encoding, 1});
    REQUIRE(report.has_value());
    CAPTURE(static_cast<int>(expected.layout), static_cast<int>(expected.encoding));
    CHECK(report->channels == expected.channels);
    CHECK(report->samplers == expected.samplers);
    CHECK(report->accessors == expected.accessors);
    CHECK(report->nodes == expected.nodes);
  }
}

TEST_CASE("equal tracks under other ids, looks and frame tracks share accessors") {
  // 16 tracks have 11 distinct sets of times (with the added keys), visibility 4 distinct courses.
  const Scene scene = testing::everything_scene();
  for (const auto& [layout, encoding] : kCombinations) {
    const json document = write_glb(scene, layout, encoding).file.json;
    std::set<int> inputs, bytes;
    for (const json& sampler : document["animations"][0]["samplers"]) {
      inputs.insert(sampler["input"].get<int>());
      if (document["accessors"][sampler["output"].get<std::size_t>()]["componentType"] == 5121)
        bytes.insert(sampler["output"].get<int>());
    }
    CHECK(inputs.size() == 11);
    CHECK(bytes.size() == (encoding == VisibilityEncoding::scale ? 0 : 4));
  }
}

TEST_CASE("exactly one look of an object is shown at a time, the one of its mesh track") {
  const Scene scene = testing::everything_scene();
  const GltfFile file = write_glb(scene, Layout::nodes, VisibilityEncoding::pointer).file;
  const FilePlayer player(file);
  REQUIRE(scene.object_mesh_tracks.size() == 3);
  for (const ObjectMeshTrack& t : scene.object_mesh_tracks) {
    const std::vector<std::size_t> children = file.json["nodes"][t.object.value]["children"];
    const auto times = scene.times_s(t.track);
    for (const double time_s : interesting_times(scene)) {
      std::size_t key = 0;
      while (key + 1 < times.size() && static_cast<double>(times[key + 1]) <= time_s) ++key;
      std::vector<double> shown;
      for (std::size_t k = 0; k < children.size(); ++k) {
        const json& child = file.json["nodes"][children[k]];
        CHECK(child["extras"]["scenegen"]["look"] == k);
        CHECK(child["name"] ==
              std::string(scene.objects.names[t.object.value]) + "/look_" + std::to_string(k));
        if (player.shown(children[k], time_s, false, true)) shown.push_back(child["mesh"].get<double>());
      }
      CHECK(shown == std::vector<double>{static_cast<double>(scene.values(t.track)[key])});
    }
  }
}

TEST_CASE("frame and material tracks keep keys, interpolation and tangents; what is added holds") {
  const Scene scene = testing::everything_scene();
  const GltfFile file = write_glb(scene, Layout::nodes, VisibilityEncoding::scale).file;
  const json& animation = file.json["animations"][0];
  const auto sampler_of = [&](const auto& wanted) -> json {
    for (const json& channel : animation["channels"]) {
      if (wanted(channel["target"])) return animation["samplers"][channel["sampler"].get<std::size_t>()];
    }
    FAIL("no such channel");
    return {};
  };
  const std::size_t first_frame = scene.objects.size();
  const json hook =
      sampler_of([&](const json& t) { return t["path"] == "translation" && t["node"] == first_frame + 1; });
  CHECK(hook["interpolation"] == "CUBICSPLINE");
  CHECK(file.numbers(hook["input"]) == std::vector<double>{0, 0.5, 2, 4, 6});
  CHECK(file.numbers(hook["output"]) ==
        std::vector<double>{0, 0,  0, 0, 5, 0, 0, 0,  0,    // added, flat
                            0, 0,  0, 0, 5, 0, 0, 1,  0,    // in-tangent 9 9 9 made flat
                            0, 1,  0, 0, 3, 0, 0, -1, 0,    // as it was
                            0, -1, 0, 0, 5, 0, 0, 0,  0,    // out-tangent 7 7 7 made flat
                            0, 0,  0, 0, 5, 0, 0, 0,  0});  // added, flat
  const json still =
      sampler_of([&](const json& t) { return t["path"] == "translation" && t["node"] == first_frame + 2; });
  CHECK(file.numbers(still["input"]) == std::vector<double>{0, 6});
  CHECK(still["interpolation"] == "CUBICSPLINE");
  const json crane = sampler_of([&](const json& t) { return t["path"] == "rotation"; });
  CHECK(crane["interpolation"] == "LINEAR");
  CHECK(file.numbers(crane["input"]) == std::vector<double>{0, 1, 3, 6});
  const auto pointing = [](const char* pointer) {
    return [pointer](const json& t) {
      return t["path"] == "pointer" && t["extensions"]["KHR_animation_pointer"]["pointer"] == pointer;
    };
  };
  const json fade = sampler_of(pointing("/materials/6/pbrMetallicRoughness/baseColorFactor"));
  CHECK(file.numbers(fade["input"]) == std::vector<double>{0, 1, 4, 6});
  // Light up to 3 is written as strength 4 times factors up to 1.
  const json glow = sampler_of(pointing("/materials/6/emissiveFactor"));
  CHECK(file.numbers(glow["output"]) == std::vector<double>{0, 0, 0, 0.75, 0.5, 0.25, 0.75, 0.5, 0.25});
  const json& material = file.json["materials"][6];
  CHECK(material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] == 4);
  CHECK(material["pbrMetallicRoughness"]["baseColorFactor"] == json::array({1, 1, 1, 1}));
}

TEST_CASE("materials, textures and images come through tinygltf unharmed") {
  const Scene scene = testing::everything_scene();
  const GltfFile file = write_glb(scene, Layout::nodes, VisibilityEncoding::scale).file;
  const json& materials = file.json["materials"];
  REQUIRE(materials.size() == scene.materials.size());
  CHECK(materials[0]["pbrMetallicRoughness"]["baseColorFactor"].dump() ==
        "[0.7,0.3,0.2,1]");  // float32, not 0.699999988…
  CHECK(materials[1]["name"] == "plaster \"rough\"");
  const json& base = materials[1]["pbrMetallicRoughness"]["baseColorTexture"];
  CHECK(base["texCoord"] == 1);
  CHECK(base["extensions"]["KHR_texture_transform"].dump() ==
        R"({"offset":[0.25,0.1],"rotation":0.5,"scale":[2,3]})");
  CHECK(materials[1]["normalTexture"]["scale"].get<float>() == 0.4F);
  CHECK(materials[1]["occlusionTexture"]["strength"].get<float>() == 0.7F);
  CHECK(materials[2]["alphaMode"] == "BLEND");
  CHECK(materials[2]["doubleSided"] == true);
  CHECK(materials[3]["alphaMode"] == "MASK");
  CHECK(materials[3]["alphaCutoff"].get<float>() == 0.3F);
  CHECK(materials[4]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] == 8);
  for (std::size_t c = 0; c < 3; ++c)
    CHECK(materials[4]["emissiveFactor"][c].get<float>() * 8.0F ==
          scene.materials[4].emissive[static_cast<int>(c)]);
  CHECK(materials[5]["extensions"].contains("KHR_materials_unlit"));
  CHECK(file.json["samplers"].size() == 1);  // the default sampler is none
  CHECK(file.json["samplers"][0]["wrapT"] == 33648);
  for (std::size_t i = 0; i < scene.images.size(); ++i) {
    const json& image = file.json["images"][i];
    CHECK(image["mimeType"] == "image/png");
    const json& view = file.json["bufferViews"][image["bufferView"].get<std::size_t>()];
    CHECK(file.binary.substr(view["byteOffset"], view["byteLength"]) ==
          std::string(scene.images[i].bytes.begin(), scene.images[i].bytes.end()));
  }
}

TEST_CASE("geometry is shared, indices are as narrow as they can be") {
  Scene scene = testing::everything_scene();
  const GltfFile small = write_glb(scene, Layout::nodes, VisibilityEncoding::scale).file;
  const auto position = [](const GltfFile& file, std::size_t mesh, std::size_t primitive) {
    return file.json["meshes"][mesh]["primitives"][primitive]["attributes"]["POSITION"].get<int>();
  };
  CHECK(position(small, 0, 0) == position(small, 2, 1));
  CHECK(position(small, 1, 0) == position(small, 2, 0));
  CHECK(small.json["meshes"][3]["primitives"][0]["mode"] == 3);
  const auto component = [](const GltfFile& file) {
    return file
        .json["accessors"][file.json["meshes"][1]["primitives"][0]["indices"].get<std::size_t>()]
             ["componentType"]
        .get<int>();
  };
  CHECK(component(small) == 5123);
  Geometry& quad = scene.geometries[1];
  quad = Geometry{};
  quad.positions_m.resize(65536, {1, 2, 3});
  quad.indices = {0, 65535, 1};
  const GltfFile large = write_glb(scene, Layout::nodes, VisibilityEncoding::scale).file;
  CHECK(component(large) == 5125);
  CHECK(large.numbers(large.json["meshes"][1]["primitives"][0]["indices"].get<std::size_t>()) ==
        std::vector<double>{0, 65535, 1});
}

TEST_CASE("asset says where the file comes from") {
  const Scene scene = testing::everything_scene();
  const json extras =
      write_glb(scene, Layout::groups, VisibilityEncoding::both).file.json["asset"]["extras"]["scenegen"];
  CHECK(extras["format"] == 1);
  CHECK(extras["seed"] == 7);
  CHECK(extras["arguments"] == json(scene.info.arguments));
  CHECK(extras["objects"] == scene.objects.size());
  CHECK(extras["layout"] == "groups");
  CHECK(extras["visibility"] == "both");
  CHECK(extras["time"]["end"] == 6);
  const json& a = extras["appearance"];
  CHECK(a["curveVariant"] == "skilling-2004");
  CHECK(a["cells"] == json::array({4, 4, 2}));
  CHECK(a["gridMaxZUp"][0].get<float>() == 4.8F);
  CHECK(a["coherenceMeasured"] == 0.953125);
  CHECK(a["moments"] == 4);
}

TEST_CASE("names of objects stand in a front-coded table in layout instances") {
  const Scene scene = testing::everything_scene();
  const GltfFile file = write_glb(scene, Layout::instances, VisibilityEncoding::scale).file;
  const json names = file.json["scenes"][0]["extras"]["scenegen"]["names"];
  CHECK(names["count"] == scene.objects.size());
  CHECK(names["encoding"] == "front-coded-utf8");
  const json& view = file.json["bufferViews"][names["bufferView"].get<std::size_t>()];
  const std::string bytes = file.binary.substr(view["byteOffset"], view["byteLength"]);
  std::size_t at = 0;
  const auto leb128 = [&] {
    std::size_t value = 0;
    for (int shift = 0;; shift += 7) {
      const auto byte = static_cast<unsigned char>(bytes.at(at++));
      value |= std::size_t{byte & 0x7FU} << shift;
      if (byte < 0x80) return value;
    }
  };
  std::string name;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const std::size_t shared = leb128(), rest = leb128();
    REQUIRE(shared <= name.size());
    name = name.substr(0, shared) + bytes.substr(at, rest);
    at += rest;
    CHECK(name == scene.objects.names[i]);
  }
  CHECK(at == bytes.size());
}

TEST_CASE("instances fall back to groups when most groups hold one object") {
  const Scene scattered = testing::town_scene(90, 45);  // two objects a moment, of two meshes
  const auto report = gltf::predict(scattered, "a.glb", {Layout::instances, VisibilityEncoding::scale, 1});
  REQUIRE(report.has_value());
  CHECK(report->layout == Layout::groups);
  REQUIRE(report->notes.size() == 1);
  CHECK(report->notes[0].find("wrote layout groups instead") != std::string::npos);

  const auto town = gltf::predict(testing::town_scene(2400, 64), "a.glb",
                                  {Layout::automatic, VisibilityEncoding::scale, 1});
  REQUIRE(town.has_value());
  CHECK(town->layout == Layout::instances);
  CHECK(town->instance_groups == 192);
  CHECK(town->instanced_objects == 2400);
  CHECK(town->single_object_groups == 0);
  CHECK(town->notes.empty());
}

TEST_CASE("a matrix with shear is written and noted") {
  Scene scene = testing::everything_scene();
  scene.frames[3].matrix[1][0] = 0.25F;
  const Written written = write_glb(scene, Layout::nodes, VisibilityEncoding::scale);
  CHECK(written.file.json["nodes"][scene.objects.size() + 3]["matrix"][4] == 0.25);
  CHECK(written.report.notes.size() == 1);
}
