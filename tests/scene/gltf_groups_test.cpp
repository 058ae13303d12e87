// Objects that share nodes: what a player that knows nothing of us shows of them, and when sharing pays.
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "scene/gltf/write.h"
#include "tests/support/gltf_file.h"
#include "tests/support/synthetic_scene.h"
#include "tests/timeline/random_scene.h"

using namespace scenegen;
using gltf::Layout;
using gltf::VisibilityEncoding;
using nlohmann::json;
using testing::GltfFile;

namespace {

/// Object -> mesh.
using Shown = std::map<std::uint32_t, std::uint32_t>;

float step_value(std::span<const float> times, std::span<const float> values, double time_s) {
  std::size_t key = 0;
  while (key + 1 < times.size() && static_cast<double>(times[key + 1]) <= time_s) ++key;
  return values[key];
}

Shown shown_by_scene(const Scene& scene, double time_s) {
  Shown out;
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    const TrackId track = scene.objects.visibility[i];
    if (!track.valid() || step_value(scene.times_s(track), scene.values(track), time_s) != 0.0F)
      out[i] = scene.objects.mesh[i].value;
  }
  for (const ObjectMeshTrack& t : scene.object_mesh_tracks) {
    const auto at = out.find(t.object.value);
    if (at != out.end())
      at->second =
          static_cast<std::uint32_t>(step_value(scene.times_s(t.track), scene.values(t.track), time_s));
  }
  return out;
}

/// Plays one of the two encodings and nothing else.
class Player {
 public:
  Player(const GltfFile& file, bool by_pointer) : file_(file), parents_(file.parents()) {
    const json& animation = file.json["animations"][0];
    for (const json& channel : animation["channels"]) {
      const json& target = channel["target"];
      const json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
      Keys keys{file.numbers(sampler["input"]), file.numbers(sampler["output"])};
      if (target["path"] == "pointer") {
        const std::string to = target["extensions"]["KHR_animation_pointer"]["pointer"];
        if (by_pointer && to.starts_with("/nodes/")) keys_[std::stoul(to.substr(7))].push_back(keys);
      } else if (target["path"] == "scale" && sampler["interpolation"] == "STEP") {
        keys_[target["node"]].push_back(keys);
      }
    }
  }

  /// Every object that is drawn, with what; an object drawn twice fails.
  Shown shown(double time_s) const {
    Shown out;
    const json& nodes = file_.json["nodes"];
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (!nodes[n].contains("mesh") || !visible(n, time_s)) continue;
      for (const std::uint32_t object : objects_of(n)) {
        INFO("object " << object << " at " << time_s << " s");
        CHECK(out.emplace(object, mesh_of(n, object)).second);
      }
    }
    return out;
  }

 private:
  struct Keys {
    std::vector<double> times, values;
  };
  bool visible(std::size_t node, double time_s) const {
    for (int n = static_cast<int>(node); n >= 0; n = parents_[static_cast<std::size_t>(n)]) {
      const auto found = keys_.find(static_cast<std::size_t>(n));
      if (found == keys_.end()) continue;
      for (const Keys& keys : found->second) {
        std::size_t key = 0;
        while (key + 1 < keys.times.size() && keys.times[key + 1] <= time_s) ++key;
        if (keys.values[key * keys.values.size() / keys.times.size()] == 0.0) return false;
      }
    }
    return true;
  }
  /// The mesh drawn; of a merged one, what it was merged from.
  std::uint32_t mesh_of(std::size_t node, std::uint32_t object) const {
    const json& n = file_.json["nodes"][node];
    const json extras = n.value("/extras/scenegen"_json_pointer, json::object());
    if (!extras.contains("objects")) return n["mesh"];
    if (extras.contains("shows")) return extras["shows"];
    for (const json& set : extras["objects"]) {
      const auto ids = file_.numbers(set["_OBJECT_ID"]);
      if (std::ranges::find(ids, object) != ids.end()) return set["mesh"];
    }
    FAIL("object " << object << " is drawn by a node that does not name it");
    return 0;
  }
  std::vector<std::uint32_t> objects_of(std::size_t node) const {
    const json& n = file_.json["nodes"][node];
    const json::json_pointer attributes("/extensions/EXT_mesh_gpu_instancing/attributes");
    if (n.contains(attributes)) {
      const auto ids = file_.numbers(n[attributes]["_OBJECT_ID"]);
      return {ids.begin(), ids.end()};
    }
    const json extras = n.value("/extras/scenegen"_json_pointer, json::object());
    if (extras.contains("objects")) {  // by what is drawn
      std::set<std::uint32_t> drawn;
      for (const json& primitive : file_.json["meshes"][n["mesh"].get<std::size_t>()]["primitives"]) {
        const auto halves = file_.numbers(primitive["attributes"]["_OBJECT_ID"]);
        for (std::size_t v = 0; v < halves.size(); v += 2)
          drawn.insert(static_cast<std::uint32_t>(halves[v] + 65536 * halves[v + 1]));
      }
      return {drawn.begin(), drawn.end()};
    }
    if (extras.contains("object")) return {extras["object"]};
    if (extras.contains("look") && parents_[node] >= 0)  // child of an object's own node
      return {file_.json["nodes"][static_cast<std::size_t>(parents_[node])]["extras"]["scenegen"].value(
          "object", static_cast<std::uint32_t>(parents_[node]))};
    return {static_cast<std::uint32_t>(node)};
  }

  const GltfFile& file_;
  std::vector<int> parents_;
  std::map<std::size_t, std::vector<Keys>> keys_;
};

std::set<double> interesting_times(const Scene& scene) {
  std::set<double> times{0.0, static_cast<double>(scene.duration_s)};
  for (const float t : scene.track_times_s) {
    times.insert(static_cast<double>(t));
    if (t > 0.0F) times.insert(static_cast<double>(t) - 1e-3);
  }
  return times;
}

gltf::WriteReport predicted(const Scene& scene, Layout layout) {
  const auto report = gltf::predict(scene, "a.glb", {layout, VisibilityEncoding::scale, 1});
  REQUIRE(report.has_value());
  return *report;
}

/// A house of one mesh that stands, and parts on frames of their own.
Scene house_with_machines(std::uint32_t bricks, std::uint32_t parts) {
  Scene scene = testing::town_scene(bricks, 4);
  for (std::uint32_t i = 0; i < parts; ++i) {
    Frame frame;
    frame.name = "joint_" + std::to_string(i);
    scene.frames.push_back(frame);
    const float times[] = {0.0F, 1.0F}, path[] = {0, 0, 0, 1, 0, static_cast<float>(i)};
    scene.frame_tracks.push_back(
        {FrameId(i), scene.add_track(Property::translation, Interpolation::linear, times, path)});
    scene.objects.add("part_" + std::to_string(i), MeshId(0), {}, FrameId(i));
  }
  return scene;
}

}  // namespace

TEST_CASE("every object is drawn once, with its look, exactly while it is visible") {
  const testing::TemporaryFolder folder;
  for (std::uint64_t seed = 20; seed < 24; ++seed) {
    const Scene scene = timeline::test::RandomScene(seed).make_kinds(70, 6);
    for (const Layout layout : {Layout::nodes, Layout::groups, Layout::instances, Layout::merged}) {
      for (const auto encoding :
           {VisibilityEncoding::scale, VisibilityEncoding::pointer, VisibilityEncoding::both}) {
        INFO("seed " << seed << " layout " << int(layout) << " encoding " << int(encoding));
        const auto report = gltf::write(scene, folder.path("a.glb"), {layout, encoding, 1});
        REQUIRE(report.has_value());
        CHECK(report->layout == layout);
        const GltfFile file = GltfFile::from_glb(testing::file_bytes(folder.path("a.glb")));
        CHECK(report->channels == file.json["animations"][0]["channels"].size());
        CHECK(report->nodes == file.json["nodes"].size());
        for (const bool by_pointer : {false, true}) {
          if (by_pointer && encoding == VisibilityEncoding::scale) continue;
          if (!by_pointer && encoding == VisibilityEncoding::pointer) continue;
          const Player player(file, by_pointer);
          for (const double time_s : interesting_times(scene)) {
            INFO("at " << time_s << " s, by pointer " << by_pointer);
            CHECK(player.shown(time_s) == shown_by_scene(scene, time_s));
          }
        }
      }
    }
  }
}

TEST_CASE("bricks that fall and change colour together are few nodes") {
  // 6000 bricks of 3 meshes at 20 moments: each moment one frame, one visibility track, one mesh track.
  Scene scene = testing::town_scene(6000, 20);
  const std::uint32_t moments = 20, meshes = 3;
  scene.meshes.push_back({"highlight", {{GeometryId(0), MaterialId(0)}}});
  std::vector<TrackId> looks;
  for (std::uint32_t m = 0; m < moments; ++m) {
    Frame frame;
    frame.name = "fall_" + std::to_string(m);
    scene.frames.push_back(frame);
    const float start_s = 0.01F * static_cast<float>(m);
    const float times[] = {start_s, start_s + 0.5F}, fall[] = {0, 5, 0, 0, 0, 0};
    scene.frame_tracks.push_back(
        {FrameId(m), scene.add_track(Property::translation, Interpolation::linear, times, fall)});
    for (std::uint32_t mesh = 0; mesh < meshes; ++mesh) {
      const float look[] = {3, static_cast<float>(mesh)};
      looks.push_back(scene.add_track(Property::mesh, Interpolation::step, times, look));
    }
  }
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    const std::uint32_t m = i * moments / 6000;
    scene.objects.frame[i] = FrameId(m);
    scene.object_mesh_tracks.push_back({ObjectId(i), looks[m * meshes + scene.objects.mesh[i].value]});
  }
  const gltf::WriteReport instances = predicted(scene, Layout::automatic);
  CHECK(instances.layout == Layout::instances);
  CHECK(instances.instanced_objects == 6000);
  CHECK(instances.instance_groups == moments * meshes);
  CHECK(instances.nodes == moments + moments * meshes * 2);     // two looks each
  CHECK(instances.channels == moments + moments * meshes * 2);  // a channel each
  CHECK(instances.single_object_groups == 0);
  CHECK(instances.bytes < 6000 * 80);

  const gltf::WriteReport groups = predicted(scene, Layout::groups);
  CHECK(groups.channels == moments + moments * meshes * 2);
  CHECK(groups.nodes == 2 * 6000 + moments + moments * meshes * 2);
}

TEST_CASE("some lone parts do not cost a town its instances") {
  const gltf::WriteReport town = predicted(house_with_machines(6000, 40), Layout::automatic);
  CHECK(town.layout == Layout::instances);
  CHECK(town.single_object_groups == 40);
  CHECK(town.instance_groups == 12);
  CHECK(town.instanced_objects == 6000);
  CHECK(town.nodes == 12 + 40 + 40);  // groups, parts, joints
  CHECK(town.notes.empty());

  const gltf::WriteReport robot = predicted(house_with_machines(40, 40), Layout::instances);
  CHECK(robot.layout == Layout::groups);
  REQUIRE(robot.notes.size() == 1);
  CHECK(robot.notes[0].find("wrote layout groups instead") != std::string::npos);
}
