// Giving a million static nodes times: reading, authoring and patching with ours, beside a program that loads
// the same file with tinygltf, appends one animation for all and saves. Each runs in a process of its own:
// CPU seconds and peak memory are the child's. Usage: bench_patch [objects] [folder]
#include <sys/resource.h>
#include <sys/wait.h>
#include <tiny_gltf.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

#include "scene/gltf/patch.h"
#include "scene/gltf/read.h"
#include "scene/gltf/write.h"
#include "tests/support/synthetic_scene.h"

namespace {

using namespace scenegen;

constexpr std::uint32_t kMoments = 4096;

struct Cost {
  double cpu_s = 0, peak_mb = 0, file_mb = 0;
  bool ok = false;
};

Cost in_child(const std::string& made, const std::function<bool()>& body) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) _exit(body() ? 0 : 1);
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child) return {};
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  std::error_code ignored;
  const auto bytes = std::filesystem::file_size(made, ignored);
  return {seconds(usage.ru_utime) + seconds(usage.ru_stime), static_cast<double>(usage.ru_maxrss) / 1024.0,
          ignored ? 0.0 : static_cast<double>(bytes) * 1e-6, WIFEXITED(status) && WEXITSTATUS(status) == 0};
}

Scene static_town(std::uint32_t objects) {
  Scene scene = testing::town_scene(objects, kMoments);
  for (TrackId& track : scene.objects.visibility) track = {};
  scene.tracks.clear();
  scene.track_times_s.clear();
  scene.track_values.clear();
  scene.duration_s = 0;
  return scene;
}

bool patch_ours(const std::string& in, const std::string& out, gltf::VisibilityEncoding visibility,
                bool drop) {
  auto read = gltf::read(in, {true, 1});
  if (!read) return false;
  Scene& scene = read->scene;
  for (std::uint32_t m = 0; m < kMoments; ++m) {
    const float time = 0.01F * static_cast<float>(m + 1), times[] = {0.0F, time}, values[] = {0, 1};
    (void)scene.add_track(Property::visibility, Interpolation::step, times, values);
    if (!drop) continue;
    const float fall_times[] = {time, time + 1.0F}, fall[] = {0, 5, 0, 0, 0, 0};
    scene.frame_tracks.push_back(
        {FrameId(m), scene.add_track(Property::translation, Interpolation::linear, fall_times, fall)});
    scene.frames.push_back({"fall", {}, {}, false, glm::mat4(1.0F)});
  }
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const auto moment = static_cast<std::uint32_t>(i * kMoments / scene.objects.size());
    scene.objects.visibility[i] = TrackId(drop ? 2 * moment : moment);
    if (drop) scene.objects.frame[i] = FrameId(moment);
  }
  scene.duration_s = 0.01F * kMoments + 2.0F;
  const auto report = gltf::patch(*read->source, scene, out, {visibility, {}});
  if (!report) std::fprintf(stderr, "%s\n", report.error().str().c_str());
  return report.has_value();
}

bool patch_tinygltf(const std::string& in, const std::string& out) {
  tinygltf::TinyGLTF gltf;
  tinygltf::Model model;
  std::string error, warning;
  if (!gltf.LoadBinaryFromFile(&model, &error, &warning, in)) return false;
  tinygltf::Animation& animation = model.animations.emplace_back();
  const auto floats = [&](const std::vector<float>& values, int type, std::size_t count) {
    tinygltf::BufferView view;
    std::vector<unsigned char>& data = model.buffers[0].data;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = values.size() * 4;
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    data.insert(data.end(), bytes, bytes + view.byteLength);
    model.bufferViews.push_back(view);
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model.bufferViews.size()) - 1;
    accessor.byteOffset = 0;
    accessor.normalized = false;
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = type;
    accessor.count = count;
    accessor.sparse.isSparse = false;
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size()) - 1;
  };
  for (std::uint32_t m = 0; m < kMoments; ++m) {
    tinygltf::AnimationSampler sampler;
    sampler.input = floats({0, 0.01F * static_cast<float>(m + 1), 43}, TINYGLTF_TYPE_SCALAR, 3);
    sampler.output = floats({0, 0, 0, 1, 1, 1, 1, 1, 1}, TINYGLTF_TYPE_VEC3, 3);
    sampler.interpolation = "STEP";
    animation.samplers.push_back(sampler);
  }
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    tinygltf::AnimationChannel channel;
    channel.sampler = static_cast<int>(i * kMoments / model.nodes.size());
    channel.target_node = static_cast<int>(i);
    channel.target_path = "scale";
    animation.channels.push_back(channel);
  }
  return gltf.WriteGltfSceneToFile(&model, out, true, true, false, true);
}

void print(const char* what, const Cost& cost) {
  std::printf("%-44s %8.2f %9.0f %9.1f%s\n", what, cost.cpu_s, cost.peak_mb, cost.file_mb,
              cost.ok ? "" : "  FAILED");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const auto objects = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 1'000'000);
  const std::string folder = argc > 2 ? argv[2] : std::filesystem::temp_directory_path().string();
  const std::string stem = folder + "/scenegen_patch_bench_" + std::to_string(getpid());
  const std::string in = stem + "_in.glb";
  const std::string out = stem + "_out.glb";
  std::printf("%u nodes, %u moments (aims: 6 s, 2500 MB)%-3s %8s %9s %9s\n", objects, kMoments, "", "CPU s",
              "peak MB", "file MB");
  const Cost source = in_child(in, [&] {
    return gltf::write(static_town(objects), in, {gltf::Layout::nodes, {}, 1}).has_value();
  });
  print("the static file, written", source);
  print("read alone", in_child(in, [&] { return gltf::read(in, {true, 1}).has_value(); }));
  bool ok = source.ok;
  const auto ours = [&](const char* what, gltf::VisibilityEncoding visibility, bool drop) {
    const Cost cost = in_child(out, [&] { return patch_ours(in, out, visibility, drop); });
    print(what, cost);
    ok = ok && cost.ok;
    return cost;
  };
  const Cost mine = ours("read + patch, scale", gltf::VisibilityEncoding::scale, false);
  ours("read + patch, pointer", gltf::VisibilityEncoding::pointer, false);
  ours("read + patch, both, falling", gltf::VisibilityEncoding::both, true);
  const Cost peer = in_child(out, [&] { return patch_tinygltf(in, out); });
  print("tinygltf: load, append, save (scale)", peer);
  std::printf("tinygltf / ours (scale): %.1f x CPU, %.1f x peak memory\n", peer.cpu_s / mine.cpu_s,
              peer.peak_mb / mine.peak_mb);
  std::error_code ignored;
  std::filesystem::remove(in, ignored);
  std::filesystem::remove(out, ignored);
  return ok && peer.ok ? 0 : 1;
}
