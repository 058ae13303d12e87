// What the memory account says against what was really taken: the heap by the allocator's own count, Vulkan's
// memory by what was allocated; and what an object costs.
#include <malloc.h>

#include <algorithm>
#include <numeric>

#include "gen/generate.h"
#include "render/calibration/calibration.h"
#include "render/spatial/scene_octree.h"
#include "render/vk/memory.h"
#include "tests/render/render_support.h"
#include "timeline/appearance.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;

namespace {

/// Bytes of the heap in use.
std::uint64_t heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// A town whose bricks appear along a curve at 4096 moments: some 2500 objects a building.
Scene town(glm::uvec2 grid) {
  gen::TownOptions options;
  options.grid = grid;
  auto made = gen::generate_town(options);
  REQUIRE(made);
  timeline::AppearanceOptions appearance;
  appearance.coherence = 0.95;
  REQUIRE(timeline::assign_appearance(made->scene, appearance, made->exempt));
  return std::move(made->scene);
}

/// Everything is in view from there.
View from_above(const Scene& scene, glm::uvec2 size) {
  Box all;
  for (const Box& box : object_bounds(scene)) all.add(box);
  const glm::vec3 centre = all.centre();
  const float far_m = 1.5F * glm::length(all.size());
  return look(centre + glm::vec3(0.3F, 0.8F, 0.5F) * far_m, centre, size);
}

struct Way {
  std::string strategy;
  NodeForm form;
};
const std::array kWays{Way{"inline", NodeForm::automatic},    Way{"hi-z", NodeForm::automatic},
                       Way{"octree", NodeForm::secondaries},  Way{"octree", NodeForm::indirect},
                       Way{"queries", NodeForm::secondaries}, Way{"queries", NodeForm::indirect},
                       Way{"adaptive", NodeForm::indirect}};

/// The account after the scene was built up and stood still for some frames.
MemoryAccount account_of(const Scene& scene, const Way& way) {
  RendererOptions options = test_options();
  options.device.validation =
      false;  // the layer keeps books of its own, and takes minutes with so many draws
  options.size = {64, 36};
  options.samples = 1;
  options.outputs = {true, false, false, false};
  options.strategy = way.strategy;
  options.how.node_form = way.form;
  options.how.objects_per_node = 200;
  const View view = from_above(scene, options.size);
  timeline::Player player(timeline::compile(scene));
  auto renderer = Renderer::create(scene, player, options);
  REQUIRE(renderer);
  const auto end_s = static_cast<double>(scene.duration_s);
  FrameResult frame;
  for (const double share : {0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0}) {
    if (renderer->in_flight() == renderer->most_in_flight()) REQUIRE(renderer->finish(frame));
    REQUIRE(renderer->submit(player.seek(share * end_s), player, view));
  }
  while (renderer->in_flight() > 0) REQUIRE(renderer->finish(frame));
  CHECK(frame.report.visible == scene.objects.size());
  const MemoryAccount account = renderer->memory(player);
  std::uint64_t vulkan = 0;  // on lavapipe all of it is the device's
  for (const MemoryShare& share : account.kinds) vulkan += share.device;
  if (renderer->device().type == "CPU") CHECK(vulkan == renderer->device_bytes());
  return account;
}

double each(const MemoryAccount& account, MemoryKind kind) {
  return static_cast<double>(account[kind].total()) / static_cast<double>(account.objects);
}

}  // namespace

TEST_CASE("memory of the host is what the allocator gave") {
  const Scene scene = town({4, 4});
  const auto grown = [](std::uint64_t before) { return static_cast<double>(heap_bytes() - before); };
  // Each allocation costs the allocator 8 B and rounding (4 % of the octree); nothing that grows with the
  // objects may be missing.
  const auto close = [](std::uint64_t said, double measured) {
    INFO(said << " B said, " << measured << " B taken");
    CHECK(static_cast<double>(said) <= 1.005 * measured);
    CHECK(static_cast<double>(said) >= 0.95 * measured);
  };
  std::uint64_t before = heap_bytes();
  const auto timeline = timeline::compile(scene);
  close(timeline->memory_bytes(), grown(before));
  before = heap_bytes();
  timeline::Player player(timeline);
  player.seek(static_cast<double>(scene.duration_s));
  close(player.memory_bytes(), grown(before));
  const std::vector<std::uint32_t> sets(scene.materials.size() + 1, 0);
  before = heap_bytes();
  const DrawScene draws(scene, player, sets);
  close(draws.memory_bytes(), grown(before));
  before = heap_bytes();
  const SceneOctree octree(draws, 200);
  close(octree.memory_bytes(), grown(before));
}

TEST_CASE("Vulkan memory is counted by kind, and taken off when it is given back") {
  using Usage = vk::BufferUsageFlagBits;
  auto device = share_device({});
  REQUIRE(device);
  MemoryFaults faults;
  faults.device_bytes = 2'000'000;
  vkr::Memory memory(**device, faults);
  const auto account = [&] {
    MemoryAccount out;
    memory.add_to(out);
    const std::uint64_t all =
        std::accumulate(out.kinds.begin(), out.kinds.end(), std::uint64_t{0},
                        [](std::uint64_t sum, const MemoryShare& share) { return sum + share.total(); });
    CHECK(all == memory.block_bytes());
    return out;
  };
  CHECK(account().own_bytes() == 0);
  const auto make = [&](std::uint64_t bytes, MemoryKind kind) {
    return memory.buffer(bytes, Usage::eStorageBuffer, vkr::MemoryUse::scene, kind);
  };
  vkr::Buffer records = make(100'000, MemoryKind::records);
  const std::uint64_t record_bytes = account()[MemoryKind::records].device;
  CHECK(record_bytes >= 100'000);
  CHECK(record_bytes < 101'000);
  vkr::Buffer first = make(1'000'000, MemoryKind::geometry);
  vkr::Buffer second = make(1'000'000, MemoryKind::geometry);  // does not fit any more
  MemoryAccount now = account();
  CHECK(now[MemoryKind::geometry].device >= 1'000'000);
  CHECK(now[MemoryKind::geometry].device < 1'001'000);
  CHECK(now[MemoryKind::geometry].spilled >= 1'000'000);
  CHECK(now[MemoryKind::geometry].host == now[MemoryKind::geometry].spilled);
  CHECK(now.spilled_bytes() == memory.spilled_bytes(MemoryKind::geometry));
  first = std::move(second);  // frees what the first was
  now = account();
  CHECK(now[MemoryKind::geometry].device == 0);
  CHECK(now[MemoryKind::geometry].spilled >= 1'000'000);
  first = {};
  now = account();
  CHECK(now[MemoryKind::geometry].total() == 0);
  CHECK(now[MemoryKind::records].device == record_bytes);
  records = {};
  CHECK(account()[MemoryKind::unused].total() == memory.block_bytes());
  memory.release_unused();
  CHECK(memory.block_bytes() == 0);
}

TEST_CASE("an object costs at most 250 B") {
  const Scene scene = town({5, 4});
  REQUIRE(scene.objects.size() > 49'000);
  for (const Way& way : kWays) {
    // The long test has the others, which hold nothing that these do not.
    if (way.strategy == "adaptive" || (way.strategy == "queries" && way.form == NodeForm::secondaries))
      continue;
    INFO(way.strategy << (way.form == NodeForm::indirect ? " indirect" : ""));
    const MemoryAccount account = account_of(scene, way);
    // Staging and blocks that are not full do not grow with the objects.
    const double fixed = each(account, MemoryKind::staging) + each(account, MemoryKind::unused);
    CHECK(account.bytes_per_object() - fixed <= 250.0);
    // What every way must hold at least: 64 B a record, 24 B a box, 40 B a transform.
    CHECK(each(account, MemoryKind::records) >= 64.0);
    CHECK(each(account, MemoryKind::slots) >= 32.0);
    CHECK(each(account, MemoryKind::timeline) >= 40.0);
    const bool octree = way.strategy == "octree" || way.strategy == "queries";
    if (octree) CHECK(each(account, MemoryKind::octree) >= 9.0);
    const bool indirect = octree && way.form == NodeForm::indirect;
    if (indirect) CHECK(each(account, MemoryKind::indirect) >= 20.0);
    CHECK((account[MemoryKind::commands].total() > 0) == (octree && !indirect));
    CHECK((account[MemoryKind::queries].total() > 0) == (way.strategy == "queries"));
  }
}

TEST_CASE("what the driver takes for kept commands is what the model says, within 15 %") {
  // Calibrated on boxes with one material, in chunks of 10, 100 and 1000.
  CalibrationOptions how;
  how.size = {64, 36};
  how.samples = 1;
  how.shadows = false;
  how.budget_s = 0.5;
  const auto calibration = calibrate(how);
  REQUIRE(calibration);
  CHECK(calibration->costs.secondary_bytes > 500);
  CHECK(calibration->costs.command_bytes > 20);
  const auto measured = [&](const char* unit) {
    return std::find(calibration->not_measured.begin(), calibration->not_measured.end(), unit) ==
           calibration->not_measured.end();
  };
  CHECK(measured("secondaryBytes"));
  CHECK(measured("commandBytes"));
  // And predicted for a town of 24 000 bricks of many meshes, as it grows.
  const Scene scene = town({5, 2});
  for (const std::uint32_t per_node : {20U, 200U}) {
    RendererOptions options = test_options();
    options.device.validation = false;  // what it keeps is counted neither way
    options.size = how.size;
    options.samples = 1;
    options.outputs = {true, false, false, false};
    options.strategy = "octree";
    options.how.node_form = NodeForm::secondaries;
    options.how.objects_per_node = per_node;
    options.costs = calibration->costs;
    const View view = from_above(scene, options.size);
    timeline::Player player(timeline::compile(scene));
    auto renderer = Renderer::create(scene, player, options);
    REQUIRE(renderer);
    FrameResult frame;
    for (const double share : {0.3, 0.6, 1.0}) {
      REQUIRE(renderer->submit(player.seek(share * static_cast<double>(scene.duration_s)), player, view));
      REQUIRE(renderer->finish(frame));
      const CommandMemoryReport commands = renderer->memory(player).commands;
      INFO(per_node << " a node, " << share << ": " << commands.buffers << " buffers, " << commands.draws
                    << " draws, " << commands.measured << " B, predicted " << commands.predicted);
      CHECK(static_cast<double>(commands.draws) > 0.9 * static_cast<double>(frame.report.draws));
      CHECK(commands.buffers >= frame.report.chunks);
      if (renderer->device().type != "CPU") continue;  // how the process grows is noise for so few
      CHECK(static_cast<double>(commands.measured) > 100.0 * static_cast<double>(commands.draws));
      CHECK(commands.predicted == Approx(static_cast<double>(commands.measured)).epsilon(0.15));
    }
  }
}

TEST_CASE("an object of a million costs at most 250 B, all told", "[.long]") {
  const Scene scene = town({21, 21});
  REQUIRE(scene.objects.size() > 1'000'000);
  for (const Way& way : kWays) {
    INFO(way.strategy << (way.form == NodeForm::indirect ? " indirect" : ""));
    const MemoryAccount account = account_of(scene, way);
    for (std::size_t i = 0; i < kMemoryKinds; ++i)
      UNSCOPED_INFO(kMemoryKindNames[i] << " " << each(account, static_cast<MemoryKind>(i)));
    CHECK(account.bytes_per_object() <= 250.0);
  }
}
