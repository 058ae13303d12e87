// Writing a large town: our writer against tinygltf's, each in a process of its own. CPU seconds are those of
// writing alone (the scene is made before); peak memory is that of the process, scene included.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>

// Declarations only: the functions are in Debian's libtinygltf.so.
#include <tiny_gltf.h>

#include "scene/gltf/write.h"
#include "tests/support/synthetic_scene.h"

namespace {

using scenegen::Scene;
using scenegen::gltf::Layout;
using scenegen::gltf::VisibilityEncoding;

struct Cost {
  double scene_cpu_s = 0, write_cpu_s = 0, peak_mb = 0, file_mb = 0;
  bool ok = false;
};

double cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Runs `write(scene)` in a child process.
Cost measure(const std::function<Scene()>& make, const std::function<bool(const Scene&)>& write) {
  int channel[2] = {-1, -1};
  if (pipe(channel) != 0) return {};
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    Cost cost;
    const double start = cpu_s();
    const Scene scene = make();
    const double made = cpu_s();
    cost.scene_cpu_s = made - start;
    cost.ok = write(scene);
    cost.write_cpu_s = cpu_s() - made;
    const bool sent = ::write(channel[1], &cost, sizeof cost) == sizeof cost;
    _exit(sent ? 0 : 1);
  }
  ::close(channel[1]);
  Cost cost;
  const bool got = read(channel[0], &cost, sizeof cost) == sizeof cost;
  ::close(channel[0]);
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  cost.ok = cost.ok && got && status == 0;
  cost.peak_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return cost;
}

/// The accessor that holds `values`, in a view of the one buffer.
int add_accessor(tinygltf::Model& model, const std::vector<unsigned char>& bytes, int component, int type,
                 std::size_t count) {
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = model.buffers[0].data.size();
  view.byteLength = bytes.size();
  model.bufferViews.push_back(view);
  model.buffers[0].data.insert(model.buffers[0].data.end(), bytes.begin(), bytes.end());
  model.buffers[0].data.resize((model.buffers[0].data.size() + 3) / 4 * 4);
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size()) - 1;
  accessor.byteOffset = 0;
  accessor.normalized = false;
  accessor.componentType = component;
  accessor.type = type;
  accessor.count = count;
  accessor.sparse.isSparse = false;
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

template <class T>
std::vector<unsigned char> bytes_of(const std::vector<T>& values) {
  const auto* at = reinterpret_cast<const unsigned char*>(values.data());
  return {at, at + values.size() * sizeof(T)};
}

/// What a program that uses tinygltf does: nodes and animation of layout `nodes`, visibility `pointer`, in
/// its model.
bool write_with_tinygltf(const Scene& scene, const std::string& path) {
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.buffers.resize(1);
  const auto& geometry = scene.geometries[0];
  const int position = add_accessor(model, bytes_of(geometry.positions_m), TINYGLTF_COMPONENT_TYPE_FLOAT,
                                    TINYGLTF_TYPE_VEC3, geometry.positions_m.size());
  for (const scenegen::Mesh& mesh : scene.meshes) {
    tinygltf::Mesh& m = model.meshes.emplace_back();
    m.name = mesh.name;
    tinygltf::Primitive& p = m.primitives.emplace_back();
    p.attributes["POSITION"] = position;
    p.mode = TINYGLTF_MODE_TRIANGLES;
  }
  tinygltf::Animation& animation = model.animations.emplace_back();
  for (std::size_t t = 0; t < scene.tracks.size(); ++t) {
    const auto times = scene.times_s(scenegen::TrackId(t));
    std::vector<float> keys(times.begin(), times.end());
    keys.push_back(scene.duration_s);
    tinygltf::AnimationSampler sampler;
    sampler.input =
        add_accessor(model, bytes_of(keys), TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_SCALAR, 3);
    sampler.output =
        add_accessor(model, {0, 1, 1}, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_TYPE_SCALAR, 3);
    sampler.interpolation = "STEP";
    animation.samplers.push_back(sampler);
  }
  model.nodes.reserve(scene.objects.size());
  animation.channels.reserve(scene.objects.size());
  tinygltf::Scene& root = model.scenes.emplace_back();
  model.defaultScene = 0;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const scenegen::Transform& t = scene.objects.frame_from_object[i];
    tinygltf::Node node;
    node.name = scene.objects.names[i];
    node.mesh = static_cast<int>(scene.objects.mesh[i].value);
    node.translation = {t.translation_m.x, t.translation_m.y, t.translation_m.z};
    node.rotation = {t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w};
    node.scale = {t.scale.x, t.scale.y, t.scale.z};
    node.extensions["KHR_node_visibility"] = tinygltf::Value(tinygltf::Value::Object{});
    model.nodes.push_back(std::move(node));
    root.nodes.push_back(static_cast<int>(i));
    tinygltf::AnimationChannel channel;
    channel.sampler = static_cast<int>(scene.objects.visibility[i].value);
    channel.target_path = "pointer";
    channel.target_extensions["KHR_animation_pointer"] =
        tinygltf::Value({{"pointer", tinygltf::Value("/nodes/" + std::to_string(i) +
                                                     "/extensions/KHR_node_visibility/visible")}});
    animation.channels.push_back(std::move(channel));
  }
  tinygltf::TinyGLTF writer;
  return writer.WriteGltfSceneToFile(&model, path, true, true, false, true);
}

void print(const char* what, const Cost& cost) {
  std::printf("%-34s %9.2f %9.2f %9.0f %9.1f%s\n", what, cost.scene_cpu_s, cost.write_cpu_s, cost.peak_mb,
              cost.file_mb, cost.ok ? "" : "  FAILED");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::uint32_t objects = 1'000'000, moments = 4096;
  bool with_peer = true;
  std::string folder = std::filesystem::temp_directory_path().string();
  CLI::App app("Writes a town: our writer against tinygltf's");
  app.add_option("--objects", objects, "Objects")->capture_default_str()->check(CLI::Range(1, 20'000'000));
  app.add_option("--moments", moments, "Distinct appearance times")
      ->capture_default_str()
      ->check(CLI::Range(1, 1'000'000));
  app.add_flag("--peer,!--no-peer", with_peer, "Measure tinygltf too (4 GB and 10 s for a million objects)");
  app.add_option("--folder", folder, "Where to write; the files are removed")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  const std::string path = folder + "/write_bench_" + std::to_string(getpid()) + ".glb";
  const auto make = [&] { return scenegen::testing::town_scene(objects, moments); };
  const auto run = [&](const char* what, const std::function<bool(const Scene&)>& write) {
    Cost cost = measure(make, write);
    std::error_code ignored;
    cost.file_mb = static_cast<double>(std::filesystem::file_size(path, ignored)) * 1e-6;
    if (ignored) cost.file_mb = 0;
    std::filesystem::remove(path, ignored);
    print(what, cost);
    return cost;
  };
  const auto ours = [&](Layout layout, VisibilityEncoding encoding) {
    return [&path, layout, encoding](const Scene& scene) {
      return scenegen::gltf::write(scene, path, {layout, encoding, 1}).has_value();
    };
  };
  std::printf("%u objects, %u moments\n%-34s %9s %9s %9s %9s\n", objects, moments, "", "scene s", "write s",
              "peak MB", "file MB");
  run("scene only", [](const Scene&) { return true; });
  const Cost instances = run("instances, scale", ours(Layout::instances, VisibilityEncoding::scale));
  run("groups, scale", ours(Layout::groups, VisibilityEncoding::scale));
  run("nodes, scale", ours(Layout::nodes, VisibilityEncoding::scale));
  const Cost nodes = run("nodes, pointer", ours(Layout::nodes, VisibilityEncoding::pointer));
  bool ok = instances.ok && nodes.ok;
  if (with_peer) {
    const Cost peer =
        run("tinygltf: nodes, pointer", [&](const Scene& s) { return write_with_tinygltf(s, path); });
    std::printf("tinygltf / ours (nodes, pointer): %.1f x CPU, %.1f x peak memory\n",
                peer.write_cpu_s / nodes.write_cpu_s, peer.peak_mb / nodes.peak_mb);
    ok = ok && peer.ok;
  }
  return ok ? 0 : 1;
}
