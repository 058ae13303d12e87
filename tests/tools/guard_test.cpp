// What the ways of drawing do on a small fixed suite, counted exactly and compared with
// tests/golden/counters.json: more draws, tests, commands recorded anew, queries, bytes or allocations than
// before are a change that somebody must have wanted. SCENEGEN_UPDATE_GOLDEN=1 (tests/golden/update.sh)
// writes the file anew. Times are printed and never judged.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "gen/generate.h"
#include "tests/support/counting_allocator.h"
#include "timeline/appearance.h"
#include "tools/bench_case.h"
#include "tools/bench_results.h"
#include "tools/frame_fields.h"

using namespace scenegen;
using namespace scenegen::tools;
using nlohmann::ordered_json;

namespace {

constexpr std::uint32_t kFrames = 16;
constexpr std::uint32_t kWarmUp = 30;  // walks all moments there and back, so that buffers have their size

struct GuardScene {
  std::string name;
  Scene scene;
  std::vector<std::string> cameras;
};

Scene timed(Result<gen::Generated> made, double coherence) {
  REQUIRE(made);
  timeline::AppearanceOptions appearance;
  appearance.cells = {8, 8, 8};
  appearance.coherence = coherence;
  REQUIRE(timeline::assign_appearance(made->scene, appearance, made->exempt));
  gen::drive_machines(made->scene, made->machines, 1);
  return std::move(made->scene);
}

/// Things that appear in order; in any order, beside a crane and lorries that move; and a cloud of boxes.
std::vector<GuardScene> scenes() {
  std::vector<GuardScene> out;
  out.push_back({"house, coherent", timed(gen::generate_town({}), 1), {"walk"}});
  gen::TownOptions busy;
  busy.machines = 2;
  out.push_back({"house, random, machines", timed(gen::generate_town(busy), 0), {"orbit", "walk"}});
  out.push_back({"boxes (set 5)", timed(gen::generate_test_set(5, 1), 0.5), {"walk"}});
  return out;
}

/// Ways whose counters depend on nothing but the frames: no clock, no costs of the machine. What `hi-z` draws
/// and reveals its device counts; its blocks and the slots in one have a fixed order, however that schedules
/// them.
constexpr std::string_view kWays =
    "brute,inline,instanced,hi-z,octree-record:n=20,octree:n=20:secondaries,octree:n=20:indirect,queries-all:"
    "n=20:"
    "secondaries,"
    "queries-all:n=20:indirect,queries:n=20:secondaries,queries:n=20:indirect";

ordered_json counted(const Scene& scene, const std::string& path, const BenchWay& way,
                     const std::shared_ptr<render::vkr::Device>& device, double& frame_ms) {
  render::RendererOptions options;
  options.shared_device = device;
  options.size = {160, 90};
  options.samples = 1;
  options.shadows = false;
  options.outputs.readback = false;
  options.strategy = way.strategy;
  options.how.objects_per_node = way.octree_n.value_or(0);
  options.how.node_form = way.form.value_or(render::NodeForm::automatic);
  auto camera = CameraMan::of_path(path, scene, options.size);
  REQUIRE(camera);
  std::vector<double> moments;
  for (std::uint32_t i = 0; i < kFrames; ++i)
    moments.push_back(static_cast<double>(scene.duration_s) * i / (kFrames - 1));
  BenchSeat seat(scene, timeline::compile(scene), *camera, options);
  std::uint64_t before = 0;
  std::uint64_t after = 0;
  const auto run = seat.run(moments, kWarmUp, [&](std::size_t done, std::size_t) {
    if (done == kWarmUp) before = scenegen::test::thread_allocation_count();
    if (done == kWarmUp + kFrames) after = scenegen::test::thread_allocation_count();
  });
  REQUIRE(run);
  CHECK(run->warnings.empty());
  frame_ms = summarize(run->frame_ms).median;
  ordered_json out;
  for (std::size_t i = 0; i < run->counters.size(); ++i)
    out[std::string(counter_fields()[i].name)] = run->counters[i];
  out["allocations"] = after - before;
  return out;
}

std::string differences(const ordered_json& was, const ordered_json& is) {
  std::string out;
  for (const auto& [name, value] : is.items()) {
    const ordered_json then = was.is_object() && was.contains(name) ? was[name] : ordered_json();
    if (then != value) out += " " + name + " " + then.dump() + " -> " + value.dump();
  }
  return out;
}

}  // namespace

TEST_CASE("every way of drawing does exactly what it did") {
  const std::string path = std::string(SCENEGEN_GOLDEN_FOLDER) + "/counters.json";
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const ordered_json golden = ordered_json::parse(text, nullptr, false);
  auto device = render::share_device({});
  REQUIRE(device);
  // What is hidden, and so asked next, depends on how a device rounds depths.
  const bool same_device = render::info_of(**device).type == "CPU";
  const auto ways = parse_ways(kWays);
  REQUIRE(ways);
  ordered_json found;
  std::string changed;
  for (const GuardScene& scene : scenes()) {
    for (const std::string& camera : scene.cameras) {
      for (const BenchWay& way : *ways) {
        if ((way.strategy.starts_with("queries") || way.strategy == "hi-z") && !same_device) continue;
        double frame_ms = 0;
        const std::string name = scene.name + ", " + camera + ", " + way.label;
        const ordered_json now = counted(scene.scene, camera, way, *device, frame_ms);
        (void)std::printf("%-64s %8.3f ms\n", name.c_str(), frame_ms);
        const bool known = golden.is_object() && golden.contains(name);
        const std::string change = known ? differences(golden[name], now) : " not in the file";
        if (!change.empty()) changed += name + ":" + change + "\n";
        found[name] = now;
      }
    }
  }
  // A suite that draws nothing would never change.
  const ordered_json& sample = found["house, random, machines, walk, octree:n=20:secondaries"];
  CHECK(sample["draws"].get<std::uint64_t>() > 500);
  CHECK(sample["recorded"].get<std::uint64_t>() > 10);
  CHECK(sample["uploadedBytes"].get<std::uint64_t>() > kFrames * 304);  // more than the cameras
  if (std::getenv("SCENEGEN_UPDATE_GOLDEN") != nullptr) {
    REQUIRE(same_device);
    std::ofstream out(path, std::ios::binary);
    out << "{";
    for (const auto& [name, counters] : found.items())
      out << (name == found.begin().key() ? "\n" : ",\n") << ordered_json(name).dump() << ": "
          << counters.dump();
    out << "\n}\n";
    return;
  }
  INFO("If this is what you wanted: tests/golden/update.sh\n" << changed);
  CHECK(changed.empty());
}
