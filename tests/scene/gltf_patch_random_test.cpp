// Documents at random, authored at random: what is read from the patched file is what was authored.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "scene/gltf/patch.h"
#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "scene/random.h"
#include "scene/validate.h"
#include "tests/support/gltf_file.h"
#include "tests/support/gltf_text.h"
#include "tests/timeline/random_scene.h"
#include "timeline/compare.h"

namespace {

using namespace scenegen;
using nlohmann::json;
using scenegen::testing::GltfText;
using scenegen::testing::TemporaryFolder;

constexpr gltf::VisibilityEncoding kEncodings[] = {
    gltf::VisibilityEncoding::scale, gltf::VisibilityEncoding::pointer, gltf::VisibilityEncoding::both};

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed, "patch test") {}
  std::uint64_t below(std::uint64_t n) { return random_.below(next_++, n); }
  bool chance(std::uint64_t n) { return below(n) == 0; }
  float in(float lo, float hi) { return lo + (hi - lo) * random_.unit(next_++); }
  glm::vec3 vec(float lo, float hi) { return {in(lo, hi), in(lo, hi), in(lo, hi)}; }
  glm::quat turn() { return glm::normalize(glm::quat(in(0.2F, 1), in(-1, 1), in(-1, 1), in(-1, 1))); }

 private:
  Random random_;
  std::uint64_t next_ = 0;
};

json numbers(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}

/// Trees of nodes with whatever nodes may have; two animations.
class RandomDocument {
 public:
  explicit RandomDocument(std::uint64_t seed) : dice_(seed) {}

  std::string make() {
    const std::size_t position = text_.floats("VEC3", 3, {0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::size_t other = text_.floats("VEC3", 4, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    json primitive = {{"attributes", {{"POSITION", position}}}, {"material", 0}};
    json second = {{"attributes", {{"POSITION", other}}}, {"mode", 5}, {"extras", {{"part", 2}}}};
    members_["materials"] = {{{"name", "red"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}},
                             {{"extras", "text"}, {"doubleSided", true}}};
    members_["meshes"] = {{{"name", "one"}, {"primitives", {primitive}}},
                          {{"primitives", {primitive, second}}, {"extras", {{"kept", true}}}}};
    members_["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}, {"zfar", 100}}}}};
    members_["extensions"] = {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}}}}}}};
    members_["extensionsUsed"] = {"KHR_lights_punctual", "KHR_node_visibility"};
    const std::size_t count = 4 + dice_.below(24);
    for (std::size_t i = 0; i < count; ++i) add_node(i);
    json roots = json::array();
    for (std::size_t i = 0; i < count; ++i) {
      if (!has_parent_[i]) roots.push_back(i);
    }
    if (!dice_.chance(4)) members_["scenes"] = {{{"nodes", roots}}};
    animate();
    members_["nodes"] = nodes_;
    std::string out = members_.dump(dice_.chance(2) ? 2 : -1);
    return text_.str(out.substr(1, out.size() - 2));
  }

 private:
  void add_node(std::size_t i) {
    json node = json::object();
    has_parent_.push_back(i > 0 && !dice_.chance(3));
    if (has_parent_[i]) nodes_[dice_.below(i)]["children"].push_back(i);
    if (!dice_.chance(5)) node["name"] = dice_.chance(4) ? "Cube" : "node " + std::to_string(i);
    if (!dice_.chance(3)) node["mesh"] = dice_.below(2);
    if (dice_.chance(10)) node["extensions"]["KHR_lights_punctual"] = {{"light", 0}};
    if (dice_.chance(10)) node["extensions"]["KHR_node_visibility"] = {{"visible", false}};
    if (dice_.chance(6)) node["extras"] = dice_.chance(2) ? json("words") : json{{"guid", i}};
    place(node);
    // The scale of a camera means nothing, unless other things hang on its node.
    if (dice_.chance(8) && node.value("scale", json()) != json{0, 0, 0}) node["camera"] = 0;
    nodes_.push_back(node);
  }

  void place(json& node) {
    if (dice_.chance(5)) {
      glm::mat4 m = Transform{dice_.vec(-3, 3), dice_.turn(), dice_.vec(0.5F, 2)}.matrix();
      if (dice_.chance(2)) m[1][0] += 0.5F;  // sheared
      json list = json::array();
      for (int k = 0; k < 16; ++k) list.push_back(m[k / 4][k % 4]);
      node["matrix"] = list;
      return;
    }
    if (dice_.chance(2)) node["translation"] = numbers(dice_.vec(-3, 3));
    if (dice_.chance(3)) {
      const glm::quat q = dice_.turn();
      node["rotation"] = {q.x, q.y, q.z, q.w};
    }
    if (dice_.chance(3)) node["scale"] = dice_.chance(8) ? json{0, 0, 0} : numbers(dice_.vec(0.5F, 2));
  }

  void animate() {
    json animations = json::array();
    for (std::size_t a = 0, n = dice_.below(3); a < n; ++a) {
      json samplers = json::array();
      json channels = json::array();
      for (std::size_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i].contains("matrix") || !dice_.chance(3)) continue;
        const std::size_t kind = dice_.below(4);
        std::vector<float> times = {0, 1, 2.5F}, values;
        for (int k = 0; k < 3; ++k) {
          if (kind == 1) {
            const glm::quat q = dice_.turn();
            values.insert(values.end(), {q.x, q.y, q.z, q.w});
          } else {
            glm::vec3 v = dice_.vec(0.5F, 3);
            if (kind == 3) v = dice_.chance(2) ? glm::vec3(0.0F) : glm::vec3(1, 2, 1);
            values.insert(values.end(), {v.x, v.y, v.z});
          }
        }
        const std::size_t input = text_.accessor("SCALAR", 3, times, ",\"min\":[0],\"max\":[2.5]");
        samplers.push_back({{"input", input},
                            {"output", text_.floats(kind == 1 ? "VEC4" : "VEC3", 3, values)},
                            {"interpolation", kind == 3 ? "STEP" : "LINEAR"}});
        const char* paths[] = {"translation", "rotation", "scale", "scale"};
        channels.push_back(
            {{"sampler", samplers.size() - 1}, {"target", {{"node", i}, {"path", paths[kind]}}}});
      }
      if (!channels.empty())
        animations.push_back({{"channels", channels}, {"samplers", samplers}, {"name", "walk"}});
    }
    if (!animations.empty()) members_["animations"] = animations;
  }

  Dice dice_;
  GltfText text_;
  json members_;
  json nodes_ = json::array();
  std::vector<bool> has_parent_;
};

/// Times, frames, looks and materials for some objects.
class Author {
 public:
  Author(Scene& scene, std::uint64_t seed, bool may_never_show)
      : scene_(scene), dice_(seed), may_never_show_(may_never_show) {}

  void run() {
    first_material_ = scene_.materials.size();
    for (int i = 0; i < 2; ++i) {
      Material m;
      m.name = "highlight " + std::to_string(i);
      m.base_color = {dice_.in(0, 1), dice_.in(0, 1), 0.25F, 1};
      scene_.materials.push_back(m);
    }
    for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) {
      if (!may_never_show_ || !dice_.chance(3))
        scene_.objects.visibility[i] = dice_.chance(8) ? TrackId() : visibility();
      const bool has_extent = scene_.objects.frame_from_object[i].scale != glm::vec3(0.0F);
      if (has_extent && dice_.chance(4)) drop(i);
      if (dice_.chance(4)) look(i);
    }
    scene_.duration_s = std::max(scene_.duration_s, 9.0F);
  }

 private:
  TrackId visibility() {
    if (!visible_.empty() && dice_.chance(2)) return visible_[dice_.below(visible_.size())];
    std::vector<float> times, values;
    float t = dice_.chance(2) ? 0.0F : 0.5F;
    for (std::uint64_t k = 0, n = 1 + dice_.below(4); k < n; ++k) {
      times.push_back(t);
      values.push_back(static_cast<float>(dice_.below(2)));
      t += 0.5F * static_cast<float>(1 + dice_.below(3));
    }
    // Scale says nothing of the size of what is never shown, and the file's may be another than the scene's.
    if (!may_never_show_) values[dice_.below(values.size())] = 1.0F;
    visible_.push_back(scene_.add_track(Property::visibility, Interpolation::step, times, values));
    return visible_.back();
  }

  void drop(std::uint32_t object) {
    const FrameId parent = scene_.objects.frame[object];
    const bool may_share = shared_.valid() && scene_.frames[shared_.value].parent == parent;
    if (!(may_share && dice_.chance(2))) {
      Frame frame;
      frame.name = "drop";
      frame.parent = parent;
      if (dice_.chance(2)) frame.local.translation_m = dice_.vec(-1, 1);
      shared_ = FrameId(scene_.frames.size());
      scene_.frames.push_back(frame);
      const float times[] = {1.0F, 2.0F, 4.0F};
      const glm::vec3 a = dice_.vec(-4, 4), b = dice_.vec(-1, 1);
      const float values[] = {a.x, a.y, a.z, b.x, b.y, b.z, 0, 0, 0};
      scene_.frame_tracks.push_back(
          {shared_, scene_.add_track(Property::translation, Interpolation::linear, times, values)});
    }
    scene_.objects.frame[object] = shared_;
  }

  void look(std::uint32_t object) {
    for (const ObjectMeshTrack& t : scene_.object_mesh_tracks) {
      if (t.object.value == object) return;  // has looks of its own
    }
    const MeshId own = scene_.objects.mesh[object];
    Mesh mesh = scene_.meshes[own.value];
    for (Primitive& p : mesh.primitives) p.material = MaterialId(first_material_ + dice_.below(2));
    mesh.name += " highlighted";
    const auto highlighted = static_cast<float>(scene_.meshes.size());
    scene_.meshes.push_back(mesh);
    const float times[] = {0.5F, 1.5F, 3.0F},
                values[] = {highlighted, static_cast<float>(own.value), highlighted};
    const std::size_t keys = 1 + dice_.below(3);
    scene_.object_mesh_tracks.push_back(
        {ObjectId(object), scene_.add_track(Property::mesh, Interpolation::step, std::span(times).first(keys),
                                            std::span(values).first(keys))});
  }

  Scene& scene_;
  Dice dice_;
  bool may_never_show_;
  std::size_t first_material_ = 0;
  std::vector<TrackId> visible_;
  FrameId shared_;
};

gltf::ReadResult read_source(const std::string& path) {
  auto read = gltf::read(path, {true, 1});
  if (!read) FAIL(read.error().str());
  return std::move(*read);
}

void check_again(const Scene& authored, const std::string& path) {
  const auto read = gltf::read(path);
  if (!read) FAIL(read.error().str());
  for (const Finding& f : validate(read->scene))
    FAIL_CHECK("rule " << f.rule << ": " << f.where << ": " << f.what);
  const auto comparison = timeline::compare(authored, read->scene);
  for (const auto& d : comparison.differences) UNSCOPED_INFO(d.where << ": " << d.what);
  CHECK(comparison.equal());
}

}  // namespace

TEST_CASE("patch: random documents of other programs") {
  const TemporaryFolder folder;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    INFO("seed " << seed);
    const std::string in = folder.path("in.gltf");
    std::ofstream(in) << RandomDocument(seed).make();
    const gltf::ReadResult source = read_source(in);
    Scene authored = source.scene;
    Author(authored, seed, source.source->scale_visibility.empty()).run();
    REQUIRE(validate(authored).empty());
    for (const auto visibility : kEncodings) {
      const std::string out = folder.path(seed % 2 == 0 ? "out.glb" : "out.gltf");
      const auto report = gltf::patch(*source.source, authored, out, {visibility, {}});
      if (!report) FAIL(report.error().str());
      check_again(authored, out);
    }
  }
}

TEST_CASE("patch: random files of our own, authored again") {
  int patched = 0;
  const TemporaryFolder folder;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    for (const auto layout : {gltf::Layout::nodes, gltf::Layout::groups}) {
      INFO("seed " << seed << " layout " << static_cast<int>(layout));
      const std::string in = folder.path("in.glb");
      const auto visibility = kEncodings[seed % 3];
      REQUIRE(gltf::write(timeline::test::RandomScene(seed).make(30, 6), in, {layout, visibility, 1}));
      const gltf::ReadResult source = read_source(in);
      Scene authored = source.scene;
      Author(authored, seed, source.source->scale_visibility.empty()).run();
      const std::string out = folder.path("out.glb");
      const auto report = gltf::patch(*source.source, authored, out, {kEncodings[seed / 3 % 3], {}});
      if (!report) {  // objects that share nodes for their looks
        CHECK_THAT(report.error().what, Catch::Contains("drawn by several nodes"));
        REQUIRE(layout == gltf::Layout::groups);
        continue;
      }
      ++patched;
      check_again(authored, out);
    }
  }
  CHECK(patched > 60);
}
