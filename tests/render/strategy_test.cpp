// Every strategy draws what `brute` draws, on paths made to catch what could go wrong.
#include "render/strategy/strategy.h"

#include "tests/render/strategy_paths.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;

namespace {

RendererOptions path_options(const std::string& strategy) {
  RendererOptions o = test_options();
  o.strategy = strategy;
  o.how.objects_per_node = 10;  // many nodes, though the scenes are small
  return o;
}

}  // namespace

TEST_CASE("every strategy gives brute's depth, ids and colours on six paths") {
  for (const Path& path : strategy_paths(40, 450)) {
    RendererOptions options = path_options("brute");
    const Run brute = run_path(path, options);
    options.how.reversed = true;
    const Run backwards = run_path(path, options);
    for (const StrategyEntry& entry : strategies()) {
      if (entry.name == "brute") continue;
      INFO(path.name << ", " << entry.name);
      const Run run = run_path(path, path_options(std::string(entry.name)));
      const Difference d = difference(run, brute, backwards);
      CHECK(d.depth == 0);
      CHECK(d.ids == 0);
      CHECK(d.color == 0);
      CHECK(d.ties * 1000 <= d.pixels);
      CHECK(run.warnings.empty());
      std::uint64_t drawn = 0, drawn_by_brute = 0;
      for (std::size_t i = 0; i < run.frames.size(); ++i) {
        drawn += run.frames[i].report.drawn;
        drawn_by_brute += brute.frames[i].report.drawn;
      }
      CHECK(drawn < drawn_by_brute);
    }
  }
}

TEST_CASE("octree keeps commands: nothing changed, nothing recorded; what changed is recorded alone") {
  const Path path = std::move(strategy_paths(40, 450)[2]);  // a still camera before vanishing walls
  const Run run = run_path(path, path_options("octree"));
  std::size_t quiet = 0, busy = 0;
  for (std::size_t i = 1; i < run.frames.size(); ++i) {
    const FrameReport& r = run.frames[i].report;
    INFO("frame " << i << ": " << r.changed << " changed, " << r.recorded << " of " << r.secondaries
                  << " recorded");
    // Two passes (colour, ids); a wall that goes or comes touches its chunk, and at most two more are split
    // or joined.
    CHECK(r.recorded <= 6 * r.changed);
    CHECK(r.recorded_draws <= 10 * r.recorded);
    CHECK(r.secondaries > 40);
    (r.changed == 0 ? quiet : busy) += 1;
  }
  CHECK(run.frames[0].report.recorded == run.frames[0].report.secondaries);
  CHECK(quiet > 0);
  CHECK(busy > 10);
}

TEST_CASE("octree draws the same with full barriers") {
  const Path path = std::move(strategy_paths(12, 450)[4]);
  RendererOptions options = path_options("octree");
  const Run exact = run_path(path, options);
  options.full_barriers = true;
  const Run full = run_path(path, options);
  const Difference d = difference(exact, full, full);
  CHECK(d.depth + d.ids + d.color == 0);
}

TEST_CASE("without memory for an octree, or when it runs out, octree draws as inline and says so") {
  const Path path = std::move(strategy_paths(8, 450)[1]);
  const Run wanted = run_path(path, path_options("inline"));
  RendererOptions options = path_options("octree");
  options.how.octree_bytes = 1000;
  const Run small = run_path(path, options);
  REQUIRE(small.warnings.size() == 1);
  CHECK(small.warnings[0].find("--octree-memory") != std::string::npos);
  options = path_options("octree");
  options.how.fail_after_buffers = 128;  // in the middle of the path
  const Run failed = run_path(path, options);
  REQUIRE(failed.warnings.size() == 1);
  CHECK(failed.warnings[0].find("fault injected") != std::string::npos);
  CHECK(failed.frames.back().report.secondaries == 0);
  for (const Run* run : {&small, &failed}) {
    const Difference d = difference(*run, wanted, wanted);
    CHECK(d.depth + d.ids == 0);
  }
}
