// What patch() adds to a document the reader gives back, and what the document held is still there.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "scene/gltf/patch.h"
#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "scene/validate.h"
#include "tests/support/gltf_file.h"
#include "tests/support/gltf_text.h"
#include "tests/support/synthetic_scene.h"
#include "timeline/compare.h"

namespace {

using namespace scenegen;
using scenegen::testing::GltfFile;
using scenegen::testing::TemporaryFolder;

constexpr gltf::VisibilityEncoding kEncodings[] = {
    gltf::VisibilityEncoding::scale, gltf::VisibilityEncoding::pointer, gltf::VisibilityEncoding::both};

gltf::ReadResult read_source(const std::string& path) {
  auto read = gltf::read(path, {true, 1});
  if (!read) FAIL(read.error().str());
  return std::move(*read);
}

void check_same(const Scene& wanted, const Scene& got) {
  if (const auto invalid = validate(got); !invalid.empty())
    FAIL(invalid.front().where + ": " + invalid.front().what);
  const auto comparison = timeline::compare(wanted, got);
  for (const auto& d : comparison.differences) UNSCOPED_INFO(d.where << ": " << d.what);
  CHECK(comparison.equal());
}

TrackId shown_from(Scene& scene, float time_s) {
  const float times[] = {0.0F, time_s}, values[] = {0, 1};
  scene.duration_s = std::max(scene.duration_s, time_s + 1.0F);
  return scene.add_track(Property::visibility, Interpolation::step, times, values);
}

/// Patches, reads again, and wants the scene back.
gltf::ReadResult patch_and_compare(const gltf::ReadResult& source, const Scene& authored,
                                   const std::string& path, gltf::VisibilityEncoding visibility,
                                   std::span<const MaterialId> material_copy_of = {}) {
  const auto report = gltf::patch(*source.source, authored, path, {visibility, material_copy_of});
  if (!report) FAIL(report.error().str());
  CHECK(report->bytes > 0);
  auto again = read_source(path);
  check_same(authored, again.scene);
  return again;
}

}  // namespace

TEST_CASE("patch: plain nodes appear, in every encoding") {
  const TemporaryFolder folder;
  Scene plain = testing::town_scene(60, 5);
  for (TrackId& track : plain.objects.visibility) track = {};
  plain.tracks.clear(), plain.track_times_s.clear(), plain.track_values.clear();
  plain.duration_s = 0;
  REQUIRE(gltf::write(plain, folder.path("in.glb"), {gltf::Layout::nodes, {}, 1}));
  for (const auto visibility : kEncodings) {
    const gltf::ReadResult source = read_source(folder.path("in.glb"));
    Scene authored = source.scene;
    for (std::size_t i = 0; i < authored.objects.size(); i += 2)
      authored.objects.visibility[i] = shown_from(authored, 1.0F + static_cast<float>(i % 7));
    const auto again = patch_and_compare(source, authored, folder.path("out.glb"), visibility);
    CHECK(again.scene.objects.names == authored.objects.names);
    const GltfFile before = GltfFile::from_glb(testing::file_bytes(folder.path("in.glb")));
    const GltfFile after = GltfFile::from_glb(testing::file_bytes(folder.path("out.glb")));
    CHECK(after.json["nodes"].size() == before.json["nodes"].size());
    CHECK(after.json["animations"][0]["name"] == "timeline");
    CHECK(after.binary.substr(0, before.binary.size()) == before.binary);
  }
}
