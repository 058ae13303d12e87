// Where the bytes go: complete files or none, and errors that say why.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <fstream>
#include <limits>

#include "scene/gltf/write.h"
#include "tests/support/gltf_file.h"
#include "tests/support/synthetic_scene.h"

using namespace scenegen;
using gltf::Layout;
using gltf::VisibilityEncoding;
using testing::file_bytes;
using testing::TemporaryFolder;

namespace {

const gltf::WriteOptions kNodes{Layout::nodes, VisibilityEncoding::both, 1};

/// Standard output goes to `descriptor` while it lives.
class RedirectedStdout {
 public:
  explicit RedirectedStdout(int descriptor) : before_(::dup(STDOUT_FILENO)) {
    std::fflush(stdout);
    ::dup2(descriptor, STDOUT_FILENO);
    ::close(descriptor);
  }
  ~RedirectedStdout() {
    ::dup2(before_, STDOUT_FILENO);
    ::close(before_);
  }
  RedirectedStdout(const RedirectedStdout&) = delete;
  RedirectedStdout& operator=(const RedirectedStdout&) = delete;

 private:
  int before_;
};

/// Files of this process cannot grow beyond `bytes`: write(2) fails in the middle, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

void put_file(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

}  // namespace

TEST_CASE("prediction is exact, threads change nothing, every form holds the same document") {
  const Scene scenes[] = {testing::everything_scene(), testing::town_scene(5000, 100), Scene{}};
  for (const Scene& scene : scenes) {
    for (const Layout layout : {Layout::nodes, Layout::groups, Layout::instances, Layout::merged}) {
      for (const VisibilityEncoding encoding :
           {VisibilityEncoding::scale, VisibilityEncoding::pointer, VisibilityEncoding::both}) {
        const TemporaryFolder folder;
        const std::string glb = folder.path("a.glb"), text = folder.path("a.gltf");
        std::string bytes;
        for (const unsigned threads : {1U, 2U, 8U}) {
          const gltf::WriteOptions options{layout, encoding, threads};
          const auto written = gltf::write(scene, glb, options);
          const auto predicted = gltf::predict(scene, glb, options);
          REQUIRE(written.has_value());
          REQUIRE(predicted.has_value());
          CHECK(written->bytes == std::filesystem::file_size(glb));
          CHECK(predicted->bytes == written->bytes);
          CHECK(predicted->json_bytes == written->json_bytes);
          const std::string now = file_bytes(glb);
          CHECK((bytes.empty() || bytes == now));
          bytes = now;
        }
        const gltf::WriteOptions options{layout, encoding, 1};
        const auto pair = gltf::write(scene, text, options);
        REQUIRE(pair.has_value());
        CHECK(pair->bytes == file_bytes(text).size() + file_bytes(folder.path("a.bin")).size());
        CHECK(gltf::predict(scene, text, options)->bytes == pair->bytes);
        const testing::GltfFile one = testing::GltfFile::from_glb(bytes);
        testing::GltfFile two = testing::GltfFile::from_gltf(text);
        CHECK(one.binary == two.binary);
        if (two.json.contains("buffers")) {
          CHECK(two.json["buffers"][0]["uri"] == "a.bin");
          two.json["buffers"][0].erase("uri");
        }
        CHECK(one.json == two.json);
      }
    }
  }
}

TEST_CASE("standard output and pipes get the same bytes as a file") {
  const Scene scene = testing::everything_scene();
  const TemporaryFolder folder;
  REQUIRE(gltf::write(scene, folder.path("file.glb"), kNodes).has_value());
  {
    const RedirectedStdout redirected(::open(folder.path("stdout.glb").c_str(), O_CREAT | O_WRONLY, 0600));
    const auto report = gltf::write(scene, "-", kNodes);
    REQUIRE(report.has_value());
  }
  CHECK(file_bytes(folder.path("stdout.glb")) == file_bytes(folder.path("file.glb")));
}

TEST_CASE("a closed pipe is an error, not a signal") {
  int ends[2] = {-1, -1};
  REQUIRE(::pipe(ends) == 0);
  ::close(ends[0]);
  Result<gltf::WriteReport> report;
  {
    const RedirectedStdout redirected(ends[1]);
    report = gltf::write(testing::town_scene(5000, 100), "-", kNodes);
  }
  REQUIRE(!report.has_value());
  CHECK(report.error().kind == ErrorKind::io);
  CHECK(report.error().str() == "standard output: Broken pipe");
}

TEST_CASE("a full device is an error") {
  const auto report = gltf::write(testing::everything_scene(), "/dev/full", kNodes);
  REQUIRE(!report.has_value());
  CHECK(report.error().kind == ErrorKind::io);
  CHECK(report.error().str() == "/dev/full: No space left on device");
}

TEST_CASE("writing that fails in the middle leaves what was there and nothing else") {
  const Scene scene = testing::town_scene(20000, 100);
  const std::uint64_t size = gltf::predict(scene, "a.glb", kNodes)->bytes;
  for (const std::uint64_t limit : {std::uint64_t{0}, std::uint64_t{4096}, size / 2, size - 1}) {
    const TemporaryFolder folder;
    put_file(folder.path("a.glb"), "old");
    Result<gltf::WriteReport> report;
    {
      const FileSizeLimit full(limit);
      report = gltf::write(scene, folder.path("a.glb"), kNodes);
    }
    REQUIRE(!report.has_value());
    CHECK(report.error().kind == ErrorKind::io);
    CHECK(report.error().str() == folder.path("a.glb") + ": File too large");
    CHECK(folder.files() == std::vector<std::string>{"a.glb"});
    CHECK(file_bytes(folder.path("a.glb")) == "old");
  }
}

TEST_CASE("a .gltf and its .bin are replaced together or not at all") {
  const Scene scene = testing::town_scene(20000, 100);
  const TemporaryFolder folder;
  put_file(folder.path("a.gltf"), "old json");
  put_file(folder.path("a.bin"), "old bytes");
  const auto binary_bytes =
      gltf::predict(scene, "a.gltf", kNodes)->bytes - gltf::predict(scene, "a.gltf", kNodes)->json_bytes;
  {
    const FileSizeLimit full(binary_bytes + 1000);  // enough for the .bin, not for the JSON
    const auto report = gltf::write(scene, folder.path("a.gltf"), kNodes);
    REQUIRE(!report.has_value());
    CHECK(report.error().where == folder.path("a.gltf"));
  }
  CHECK(folder.files() == std::vector<std::string>{"a.bin", "a.gltf"});
  CHECK(file_bytes(folder.path("a.gltf")) == "old json");
  CHECK(file_bytes(folder.path("a.bin")) == "old bytes");
}

TEST_CASE("places that cannot be written are named, with the reason") {
  const Scene scene = testing::town_scene(1, 1);
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& path) {
    const auto report = gltf::write(scene, path, kNodes);
    REQUIRE(!report.has_value());
    return report.error();
  };
  CHECK(error_of(folder.path("none/a.glb")).str() ==
        folder.path("none/a.glb") + ": No such file or directory");
  CHECK(error_of(folder.path("none/a.gltf")).kind == ErrorKind::io);
  std::filesystem::create_directory(folder.path("dir.glb"));
  CHECK(error_of(folder.path("dir.glb")).str() == folder.path("dir.glb") + ": Is a directory");
  put_file(folder.path("plain"), "");
  CHECK(error_of(folder.path("plain/a.glb")).str() == folder.path("plain/a.glb") + ": Not a directory");
  CHECK(error_of(folder.path("a.obj")).kind == ErrorKind::usage);
  CHECK(error_of("").kind == ErrorKind::usage);
  CHECK(folder.files() == std::vector<std::string>{"dir.glb", "plain"});
  CHECK(!gltf::predict(scene, "a.obj", kNodes).has_value());
}

TEST_CASE("links stay links, modes stay modes, odd names become URIs") {
  const Scene scene = testing::town_scene(1, 1);
  const TemporaryFolder folder;
  put_file(folder.path("real.glb"), "old");
  ::chmod(folder.path("real.glb").c_str(), 0640);
  std::filesystem::create_symlink("real.glb", folder.path("link.glb"));
  REQUIRE(gltf::write(scene, folder.path("link.glb"), kNodes).has_value());
  CHECK(std::filesystem::is_symlink(folder.path("link.glb")));
  CHECK(file_bytes(folder.path("real.glb")).starts_with("glTF"));
  struct stat status {};
  REQUIRE(::stat(folder.path("real.glb").c_str(), &status) == 0);
  CHECK((status.st_mode & 07777) == 0640);

  REQUIRE(gltf::write(scene, folder.path("50 % of Süd#1.gltf"), kNodes).has_value());
  const auto file = testing::GltfFile::from_gltf(folder.path("50 % of Süd#1.gltf"));
  CHECK(file.json["buffers"][0]["uri"] == "50%20%25%20of%20S%C3%BCd%231.bin");
  CHECK(file.binary.size() == file.json["buffers"][0]["byteLength"].get<std::size_t>());
}

TEST_CASE("what glTF cannot hold is refused, with its place, before anything is written") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const std::pair<const char*, std::function<void(Scene&)>> damages[] = {
      {"objects[3] brick_3", [&](Scene& s) { s.objects.frame_from_object[3].translation_m.y = nan; }},
      {"objects[3] brick_3", [&](Scene& s) { s.objects.frame_from_object[3].rotation.w = infinity; }},
      {"geometries[1]", [&](Scene& s) { s.geometries[1].texcoords[1][2].y = -infinity; }},
      {"geometries[2]", [&](Scene& s) { s.geometries[2].positions_m.clear(); }},
      {"meshes[1]", [&](Scene& s) { s.meshes[1].primitives.clear(); }},
      {"materials[2]", [&](Scene& s) { s.materials[2].emissive.z = nan; }},
      {"materials[1]", [&](Scene& s) { s.materials[1].normal_texture.uv_rotation_rad = nan; }},
      {"images[0]", [&](Scene& s) { s.images[0].bytes.clear(); }},
      {"images[0]", [&](Scene& s) { s.images[0].mime_type = "image/bmp"; }},
      {"tracks[0]", [&](Scene& s) { s.track_times_s[1] = nan; }},
      {"tracks[0]", [&](Scene& s) { s.track_times_s[0] = -1.0F; }},
      {"tracks[1]", [&](Scene& s) { s.tracks[1].key_count = 0; }},
      {"duration_s", [&](Scene& s) { s.duration_s = infinity; }},
      {"frames[1] hook", [&](Scene& s) { s.frames[1].local.scale.x = nan; }},
      {"frames[3] ", [&](Scene& s) { s.frames[3].matrix[2][2] = nan; }},
      {"cameras[0] watcher", [&](Scene& s) { s.cameras[0].yfov_rad = nan; }},
      {"info.appearance", [&](Scene& s) { s.info.appearance->locality_cells = std::nan(""); }},
      {"meshes[0]", [&](Scene& s) { s.meshes[0].name = "\xFF"; }},
      {"objects[76]", [&](Scene& s) { s.objects.add("\xC0\x80", MeshId(0), {}); }},
  };
  for (const auto& [where, damage] : damages) {
    Scene scene = testing::everything_scene();
    damage(scene);
    const TemporaryFolder folder;
    const auto report = gltf::write(scene, folder.path("a.glb"), kNodes);
    CAPTURE(where);
    REQUIRE(!report.has_value());
    CHECK(report.error().kind == ErrorKind::bad_input);
    CHECK(report.error().where == where);
    CHECK(!report.error().what.empty());
    CHECK(folder.files().empty());
    CHECK(!gltf::predict(scene, "a.glb", kNodes).has_value());
  }
}
