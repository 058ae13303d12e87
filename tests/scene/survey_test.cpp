// survey(): counts of a document, and what a rewrite of its scene would lose.
#include "scene/gltf/survey.h"

#include <catch2/catch.hpp>

#include "tests/support/gltf_text.h"

namespace {

using namespace scenegen;

gltf::Survey survey_of(const std::string& text) {
  const auto read = gltf::read_memory({text.begin(), text.end()}, "f", "", {.keep_source = true});
  if (!read) FAIL(read.error().str());
  auto out = gltf::survey(*read);
  if (!out) FAIL(out.error().str());
  return *out;
}

std::string lost(const gltf::Survey& survey) {
  std::string out;
  for (const gltf::Ignored& loss : survey.losses)
    out += loss.what + " " + loss.where + " " + std::to_string(loss.count) + "\n";
  return out;
}

}  // namespace

TEST_CASE("a plain file loses nothing; everything is counted") {
  testing::GltfText g;
  const std::string mesh = g.triangle_mesh();
  const gltf::Survey s = survey_of(g.str(
      R"("nodes":[{"mesh":0,"extras":{"scenegen":{"object":0}}},{"mesh":0},{"children":[0]}],"materials":[{},{}],)"
      R"("scene":0,"scenes":[{"nodes":[1,2],"extras":{"scenegen":{}}}],)" +
      mesh));
  CHECK(s.nodes == 3);
  CHECK(s.draws == 2);
  CHECK(s.meshes == 1);
  CHECK(s.materials == 2);
  CHECK(s.accessors == 1);
  CHECK(lost(s).empty());
}

TEST_CASE("what a scene does not hold is named, with its place") {
  testing::GltfText g;
  const std::string mesh = g.triangle_mesh();
  const auto losses = [&](const std::string& members) {
    return lost(survey_of(g.str(members + "," + mesh)));
  };
  CHECK(
      losses(
          R"("nodes":[{"mesh":0,"extras":{"guid":"2O2Fr$"}},{"mesh":0,"extras":{"guid":"x","scenegen":{}}}])") ==
      "extras of nodes /nodes/0/extras 2\n");
  CHECK(losses(R"("nodes":[{"mesh":0}],"materials":[{"extras":7}],"extras":{"a":1})") ==
        "extras of materials /materials/0/extras 1\nextras of the document /extras 1\n");
  CHECK(losses(R"("nodes":[{"mesh":0,"skin":0}],"skins":[{"joints":[0],"extras":{"a":1}}])") ==
        "skins /nodes/0/skin 1\nextras of skins /skins/0/extras 1\n");
  CHECK(losses(R"("extensionsUsed":["KHR_lights_punctual"],"nodes":[{"mesh":0}])") ==
        "KHR_lights_punctual /extensionsUsed/0 1\n");
  CHECK(losses(R"("nodes":[{"mesh":0},{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0)")
            .empty());  // only unseen
}

TEST_CASE("the copyright stays with the scene") {
  testing::GltfText g;
  std::string text = g.str("\"nodes\":[]");
  text.replace(text.find("\"2.0\""), 5, R"("2.0","copyright":"(c) Ann")");
  const auto read = gltf::read_memory({text.begin(), text.end()}, "f", "", {.keep_source = true});
  REQUIRE(read);
  CHECK(read->scene.info.copyright == "(c) Ann");
}
