// Frames in steady state take no memory: operator new of the drawing thread is counted. (Drivers take memory
// by other means, and on threads of their own.)
#include <array>
#include <cstdint>

#include "render/strategy_names.h"
#include "tests/render/strategy_paths.h"
#include "tests/support/counting_allocator.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;

namespace {

struct Way {
  std::string strategy;
  NodeForm form = NodeForm::automatic;
};

/// All strategies there are, and both forms of chunks where there are chunks.
std::vector<Way> ways() {
  std::vector<Way> out;
  for (const auto& [name, same] : strategy_choices()) {
    const bool keeps = name == "octree" || name == "queries-all" || name == "queries" || name == "adaptive";
    if (!keeps) {
      out.push_back({name});
      continue;
    }
    for (const NodeForm form : {NodeForm::secondaries, NodeForm::indirect}) out.push_back({name, form});
  }
  return out;
}

RendererOptions options_of(const Way& way) {
  RendererOptions options = test_options();
  options.device.validation = false;  // the layer's books are kept by operator new too
  options.size = {96, 54};
  options.shadows = false;
  options.predictions = true;
  options.strategy = way.strategy;
  options.how.node_form = way.form;
  options.how.objects_per_node = 20;
  options.how.change_every =
      8;  // of `adaptive`, whose own choice depends on the clock: its three ways, once a walk
  return options;
}

/// Allocations of each frame of a walk along the path, after `before` others.
std::vector<std::uint64_t> allocations(const Path& path, const RendererOptions& options, int before) {
  timeline::Player player(timeline::compile(path.scene));
  auto renderer = Renderer::create(path.scene, player, options);
  REQUIRE(renderer);
  FrameResult result;
  std::vector<std::uint64_t> out;
  out.reserve(path.frames.size());
  std::size_t drawn = 0;
  for (int round = 0; round <= before; ++round) {
    for (const PathFrame& frame : path.frames) {
      const View view = look(frame.eye_m, frame.target_m, options.size);
      const std::uint64_t start = scenegen::test::thread_allocation_count();
      bool fine = true;
      if (renderer->in_flight() == renderer->most_in_flight()) fine = renderer->finish(result).has_value();
      fine = fine && renderer->submit(player.seek(frame.time_s), player, view);
      const std::uint64_t count = scenegen::test::thread_allocation_count() - start;
      REQUIRE(fine);
      if (round == before) out.push_back(count);
      drawn = std::max<std::size_t>(drawn, result.report.drawn);
    }
  }
  while (renderer->in_flight() > 0) REQUIRE(renderer->finish(result));
  CHECK(drawn > 50);
  return out;
}

}  // namespace

TEST_CASE("a frame allocates nothing where the camera goes, and things come and go, as they did before") {
  auto device = share_device({});
  REQUIRE(device);
  const std::vector<Path> paths = strategy_paths(24, 300);
  for (const std::size_t which : {0, 3, 4}) {  // nothing changes; much appears and vanishes; objects move
    const Path& path = paths[which];
    for (const Way& way : ways()) {
      INFO(path.name << ", " << way.strategy << ", " << static_cast<int>(way.form));
      RendererOptions options = options_of(way);
      options.shared_device = *device;
      // Brought up to date many changes at a time, a tree's chunks take a walk or two more to find their
      // sizes.
      const int before = way.strategy == "adaptive" ? 5 : 3;
      CHECK(allocations(path, options, before) == std::vector<std::uint64_t>(path.frames.size(), 0));
    }
  }
  Path shadows = paths[0];
  shadows.frames.resize(6);  // a map of 3072 x 3072 takes a software device long
  RendererOptions options = options_of({"inline"});
  options.shared_device = *device;
  options.shadows = true;
  CHECK(allocations(shadows, options, 1) == std::vector<std::uint64_t>(shadows.frames.size(), 0));
}
