// Millions of objects: the limits of the file form, and memory.
#include <sys/resource.h>

#include <catch2/catch.hpp>

#include "scene/gltf/write.h"
#include "scene/limits.h"
#include "tests/support/gltf_file.h"
#include "tests/support/synthetic_scene.h"

using namespace scenegen;
using gltf::Layout;
using gltf::VisibilityEncoding;

namespace {
double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}
}  // namespace

TEST_CASE("ten million objects as instances take little memory beyond the scene") {
  const Scene scene = testing::town_scene(10'000'000, 4096);
  const testing::TemporaryFolder folder;
  const auto report =
      gltf::write(scene, folder.path("a.glb"), {Layout::instances, VisibilityEncoding::scale, 1});
  REQUIRE(report.has_value());
  CHECK(report->bytes == std::filesystem::file_size(folder.path("a.glb")));
  CHECK(report->instanced_objects == 10'000'000);
  CHECK(peak_mb() < 2500.0);
}

TEST_CASE("what is too large for a .glb or for readers is refused before it is written") {
  const Scene scene = testing::town_scene(14'000'000, 64);
  const testing::TemporaryFolder folder;
  const gltf::WriteOptions nodes{Layout::nodes, VisibilityEncoding::pointer, 1};
  for (const char* name : {"a.glb", "a.gltf"}) {
    const auto report = gltf::predict(scene, folder.path(name), nodes);
    REQUIRE(!report.has_value());
    CHECK(report.error().kind == ErrorKind::bad_input);
    CHECK(report.error().str() ==
          folder.path(name) + ": 4.6 GB of JSON; readers take at most 4.3 GB: use layout instances");
  }
  const auto report = gltf::write(scene, folder.path("a.glb"), nodes);
  REQUIRE(!report.has_value());
  CHECK(report.error().str() ==
        folder.path("a.glb") + ": 4.6 GB of JSON; readers take at most 4.3 GB: use layout instances");
  CHECK(folder.files().empty());
}
