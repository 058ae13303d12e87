// Loading a million objects: our reader beside tinygltf's. Each runs in a process of its own: CPU seconds and
// peak memory are the child's. Usage: bench_read [objects] [folder]
#include <sys/resource.h>
#include <sys/wait.h>
#include <tiny_gltf.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "tests/support/synthetic_scene.h"

namespace {

using namespace scenegen;

struct Cost {
  double cpu_s = 0;
  double peak_mb = 0;
  bool ok = false;
};

Cost in_child(const std::function<bool()>& body) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) _exit(body() ? 0 : 1);
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child) return {};
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {seconds(usage.ru_utime) + seconds(usage.ru_stime), static_cast<double>(usage.ru_maxrss) / 1024.0,
          WIFEXITED(status) && WEXITSTATUS(status) == 0};
}

bool read_ours(const std::string& path, std::uint32_t objects) {
  const auto read = gltf::read(path);
  if (!read) std::fprintf(stderr, "%s\n", read.error().str().c_str());
  return read && read->scene.objects.size() == objects && !read->scene.tracks.empty();
}

bool read_tinygltf(const std::string& path) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*,
                           int, void*) { return true; },
                        nullptr);
  tinygltf::Model model;
  std::string error, warning;
  return loader.LoadBinaryFromFile(&model, &error, &warning, path) && !model.nodes.empty();
}

}  // namespace

int main(int argc, char** argv) {
  const auto objects = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 1'000'000);
  const std::string folder = argc > 2 ? argv[2] : std::filesystem::temp_directory_path().string();
  struct Case {
    const char* name;
    gltf::Layout layout;
    gltf::VisibilityEncoding visibility;
  };
  const Case cases[] = {{"instances, scale", gltf::Layout::instances, gltf::VisibilityEncoding::scale},
                        {"nodes, scale", gltf::Layout::nodes, gltf::VisibilityEncoding::scale},
                        {"nodes, pointer", gltf::Layout::nodes, gltf::VisibilityEncoding::pointer}};
  std::printf(
      "%u objects, 4096 moments          MB    scenegen s  peak MB    tinygltf s  peak MB    ratio s  peak\n",
      objects);
  bool ok = true;
  for (const Case& c : cases) {
    const std::string path = folder + "/scenegen_read_bench_" + std::to_string(getpid()) + ".glb";
    const Cost write = in_child([&] {
      return gltf::write(testing::town_scene(objects, 4096), path, {c.layout, c.visibility, 1}).has_value();
    });
    std::error_code code;
    const double mb = static_cast<double>(std::filesystem::file_size(path, code)) / 1e6;
    const Cost ours = in_child([&] { return read_ours(path, objects); });
    const Cost theirs = in_child([&] { return read_tinygltf(path); });
    std::filesystem::remove(path, code);
    ok = ok && write.ok && ours.ok && theirs.ok;
    std::printf("%-28s %8.1f    %10.2f  %7.0f    %10.2f  %7.0f    %7.1f  %4.1f%s\n", c.name, mb, ours.cpu_s,
                ours.peak_mb, theirs.cpu_s, theirs.peak_mb, theirs.cpu_s / ours.cpu_s,
                theirs.peak_mb / ours.peak_mb, write.ok && ours.ok && theirs.ok ? "" : "  FAILED");
  }
  return ok ? 0 : 1;
}
