// Every strategy draws what `brute` draws, on paths made to catch what could go wrong.
#include "render/strategy/strategy.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "tests/render/strategy_ways.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;

namespace {

/// All that must draw what `brute` draws: `inline-queries` draws some objects too late, as the dissertation
/// does.
std::vector<Way> exact_ways() {
  std::vector<Way> out;
  for (const StrategyEntry& entry : strategies()) {
    // What adaptive does depends on times: it has tests of its own.
    if (entry.name == "brute" || entry.name == "inline-queries" || entry.name == "adaptive") continue;
    out.push_back({std::string(entry.name)});
    if (entry.name == "octree" || out.back().asks())
      out.push_back({std::string(entry.name), NodeForm::indirect});
  }
  return out;
}

struct Sums {
  std::uint64_t drawn = 0, queries = 0, answers = 0, believed_hidden = 0, found_hidden = 0, reveals = 0;
  std::uint64_t secondaries = 0, indirect_commands = 0;
  std::size_t sharing = 0;  // frames in which several parts must have shared a query
};
Sums sums_of(const Run& run) {
  Sums sums;
  for (const FrameResult& frame : run.frames) {
    const FrameReport& r = frame.report;
    sums.drawn += r.drawn;
    sums.queries += r.queries;
    sums.answers += r.answers;
    sums.believed_hidden += r.believed_hidden;
    sums.found_hidden += r.found_hidden;
    sums.reveals += r.reveals;
    sums.secondaries += r.secondaries;
    sums.indirect_commands += r.indirect_commands;
    sums.sharing += r.believed_hidden > r.queries ? 1 : 0;
  }
  return sums;
}

/// Pixels where something is missing that `brute` draws, and where something is that it does not draw.
struct Late {
  std::size_t missing = 0, wrong = 0;
};
Late late_pixels(const Run& run, const Run& brute, std::size_t frame) {
  Late late;
  const std::vector<float>& depth = run.frames[frame].depth;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    late.missing += depth[i] < brute.frames[frame].depth[i] ? 1 : 0;
    late.wrong += depth[i] > brute.frames[frame].depth[i] ? 1 : 0;
  }
  return late;
}

/// What all others are compared with.
struct Reference {
  Run brute, backwards;
};
Reference reference(const Path& path) {
  Reference out;
  RendererOptions options = path_options("brute");
  out.brute = run_path(path, options);
  options.how.reversed = true;
  out.backwards = run_path(path, options);
  return out;
}

/// Depth to the bit, ids and colours wherever they are settled; and few places where they are not.
Difference check_same(const Run& run, const Reference& wanted) {
  const Difference d = difference(run, wanted.brute, wanted.backwards);
  CHECK(d.depth == 0);
  CHECK(d.ids == 0);
  CHECK(d.color == 0);
  CHECK(d.ties * 1000 <= d.pixels);
  CHECK(run.warnings.empty());
  return d;
}

/// Lines about what was compared, for who runs the long test.
void say(bool aloud, const Path& path, const std::string& way, const Difference& d, const Run& run) {
  if (!aloud) return;
  const Sums sums = sums_of(run);
  std::printf("%-22s %-25s %3zu frames %10zu pixels %6zu ties %8llu queries %7llu reveals\n",
              path.name.c_str(), way.c_str(), run.frames.size(), d.pixels, d.ties,
              static_cast<unsigned long long>(sums.queries), static_cast<unsigned long long>(sums.reveals));
}

/// On a path; `both_forms` of chunks, or one.
void check_ways(const Path& path, const Reference& wanted, bool both_forms, bool aloud) {
  std::string before;
  for (const Way& way : exact_ways()) {
    if (!both_forms && way.strategy == std::exchange(before, way.strategy)) continue;
    INFO(way.name());
    const Run run = run_path(path, way.options());
    const Difference d = check_same(run, wanted);
    say(aloud, path, way.name(), d, run);
    const Sums sums = sums_of(run);
    CHECK(sums.drawn < sums_of(wanted.brute).drawn);
    // What was believed hidden came into view on every path, and was drawn in the frame in which it did.
    CHECK((sums.reveals > 0) == (way.asks() || way.strategy == "hi-z"));
    CHECK((sums.believed_hidden > 50) == way.asks());
    // Cuts leave too little time for what is hidden to stay so, and so do 40 frames in which all appears.
    const bool stays =
        path.name != "camera cuts" && (path.name != "coherence 0 to 1" || run.frames.size() > 100);
    if (way.strategy != "queries") CHECK(sums.sharing == 0);
    if (way.strategy == "queries" && stays) CHECK(sums.sharing > 0);
    const bool kept = way.asks() || way.strategy == "octree";
    CHECK((sums.secondaries > 0) == (kept && way.form == NodeForm::secondaries));
    CHECK((sums.indirect_commands > 0) == (kept && way.form == NodeForm::indirect));
  }
}

/// `adaptive` that changes its way all the time and asks while it can: what it draws is the same, and things
/// that come into view are among it. By costs that favour asking, whatever the device.
void check_adaptive(const Path& path, const Reference& wanted, bool aloud) {
  const bool even = path.name.size() % 2 == 0;
  RendererOptions options = Way{"adaptive", even ? NodeForm::indirect : NodeForm::secondaries}.options();
  options.how.change_every = even ? 10 : 9;  // long enough to believe, and to be wrong
  options.frames_in_flight = even ? 3 : 2;
  const Run run = run_path(path, options);
  const Difference d = check_same(run, wanted);
  say(aloud, path, "adaptive", d, run);
  enum Taken { flat, tree, device };
  const auto way_of = [&](std::size_t i) {
    const std::string_view used = run.frames[i].report.strategy_used;
    return used == "inline" ? flat : used == "hi-z" ? device : tree;
  };
  std::size_t changes = 0;
  std::array<std::size_t, 3> frames{};
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    ++frames[way_of(i)];
    changes += i > 0 && way_of(i) != way_of(i - 1) ? 1 : 0;
  }
  CHECK((changes + 1) * options.how.change_every >= run.frames.size());
  for (const std::size_t of_way : frames) {
    CHECK(of_way * 5 >= run.frames.size());
    CHECK(of_way * 2 <= run.frames.size());
  }
  const Sums sums = sums_of(run);
  CHECK(sums.queries > 100);
  CHECK(sums.reveals > 0);
}

/// The same under late visibility fails: it is the second part of a frame that makes occlusion exact.
void check_late(const Path& path, const Run& brute, bool aloud) {
  for (const Way& way : {Way{"queries-all"}, Way{"queries", NodeForm::indirect}, Way{"hi-z"}}) {
    INFO(way.name() << ", late");
    RendererOptions options = way.options();
    options.outputs.color = false;
    options.how.late_visibility = true;
    const Run late = run_path(path, options);
    Late sum;
    for (std::size_t f = 0; f < brute.frames.size(); ++f) {
      const Late pixels = late_pixels(late, brute, f);
      sum.missing += pixels.missing;
      sum.wrong += pixels.wrong;
    }
    if (aloud)
      std::printf("%-22s %-25s %zu pixels missing\n", path.name.c_str(), (way.name() + ", late").c_str(),
                  sum.missing);
    CHECK(sum.missing > 0);
    CHECK(sum.wrong == 0);
    CHECK(late.warnings.empty());
  }
}

}  // namespace

TEST_CASE("every strategy gives brute's depth, ids and colours on six paths, but not under late visibility") {
  std::size_t number = 0;
  for (const Path& path : strategy_paths(40, 450)) {
    const bool both_forms = number++ % 3 == 0;  // the long test takes both on all
    DYNAMIC_SECTION(path.name) {
      const Reference wanted = reference(path);
      check_ways(path, wanted, both_forms, false);
      check_adaptive(path, wanted, false);
      check_late(path, wanted.brute, false);
    }
  }
}

TEST_CASE("the same on long paths through more objects", "[.long]") {
  for (const Path& path : strategy_paths(300, 2000)) {
    DYNAMIC_SECTION(path.name) {
      const Reference wanted = reference(path);
      check_ways(path, wanted, true, true);
      check_adaptive(path, wanted, true);
      check_late(path, wanted.brute, true);
    }
  }
}

TEST_CASE("adaptive chooses by itself, says why, and goes on inline when memory runs out") {
  const Path path = std::move(strategy_paths(12, 450)[3]);
  const Run wanted = run_path(path, path_options("inline"));
  RendererOptions options = path_options("adaptive");
  options.predictions = true;
  const Run run = run_path(path, options);
  CHECK(difference(run, wanted, wanted).depth == 0);
  CHECK(run.frames[0].report.strategy_used == "inline");  // nothing else is ready
  for (const FrameResult& frame : run.frames) {
    CHECK(frame.report.verdict.used_s > 0);
    CHECK(!model::in_words(frame.report.verdict).empty());
    for (const model::Prediction& p : frame.report.predicted) CHECK(p.frame_s > 0);
  }

  options.how.octree_bytes = 1000;
  const Run small = run_path(path, options);
  REQUIRE(small.warnings.size() == 1);
  CHECK(small.warnings[0].find("--octree-memory") != std::string::npos);
  for (const FrameResult& frame : small.frames) {
    CHECK(frame.report.verdict.rival != model::Method::octree);
    CHECK(frame.report.chunks == 0);
  }
  options = path_options("adaptive");
  options.how.change_every = 3;
  options.how.node_form = NodeForm::secondaries;
  options.how.fail_after_buffers = 128;  // in the middle of the path
  const Run failed = run_path(path, options);
  REQUIRE(failed.warnings.size() == 1);
  CHECK(failed.warnings[0].find("fault injected") != std::string::npos);
  bool kept = false, left = false;
  for (const FrameResult& frame : failed.frames) {
    kept = kept || frame.report.secondaries > 0;
    left = kept && frame.report.secondaries == 0;
  }
  CHECK(kept);
  CHECK(left);
  CHECK(failed.frames.back().report.strategy_used != "octree");
  for (const Run* other : {&small, &failed}) CHECK(difference(*other, wanted, wanted).depth == 0);
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
  options = Way{"octree"}.options();
  options.how.fail_after_buffers = 128;  // in the middle of the path
  const Run failed = run_path(path, options);
  options = Way{"octree", NodeForm::indirect}.options();
  options.how.fail_after_buffers = 64;
  const Run failed_indirect = run_path(path, options);
  for (const Run* run : {&failed, &failed_indirect}) {
    REQUIRE(run->warnings.size() == 1);
    CHECK(run->warnings[0].find("fault injected") != std::string::npos);
    const Sums sums = sums_of(*run);
    CHECK(sums.secondaries + sums.indirect_commands > 0);
    const FrameReport& last = run->frames.back().report;
    CHECK(last.secondaries + last.indirect_commands == 0);
  }
  for (const Run* run : {&small, &failed, &failed_indirect}) {
    const Difference d = difference(*run, wanted, wanted);
    CHECK(d.depth + d.ids == 0);
  }
}

TEST_CASE("inline-queries leaves out objects that were hidden, and draws them too late when they are not") {
  const Path path = std::move(strategy_paths(30, 300)[2]);
  RendererOptions options = path_options("brute");
  options.outputs.color = false;
  const Run brute = run_path(path, options);
  options.strategy = "inline-queries";
  const Run run = run_path(path, options);
  options.strategy = "inline";
  const Sums all = sums_of(run_path(path, options));
  const Sums sums = sums_of(run);
  Late late;
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    late.missing += late_pixels(run, brute, f).missing;
    late.wrong += late_pixels(run, brute, f).wrong;
  }
  CHECK(late.missing > 0);
  CHECK(late.wrong == 0);
  CHECK(sums.queries > all.drawn / 2);  // most are not at the eye
  CHECK(sums.answers > 0);
  CHECK(sums.found_hidden > sums.answers / 4);
  CHECK(sums.believed_hidden > 0);
  CHECK(sums.reveals > 0);
}

TEST_CASE("inline-queries draws at once what moved, whatever was known of it") {
  Path path{"jump", {}, {}};
  const MeshId mesh = add_mesh(path.scene, box_geometry(), plain({1, 0, 0, 1}));
  add_object(path.scene, "wall", mesh, {0, 0, 0}, {6, 6, 0.2F});
  Frame frame;
  frame.name = "carrier";
  path.scene.frames.push_back(frame);
  path.scene.objects.add("thing", mesh, Transform{}, FrameId(0));
  path.scene.frame_tracks.push_back(
      {FrameId(0), path.scene.add_track(Property::translation, Interpolation::step, std::array{0.0F, 5.0F},
                                        std::array{0.0F, 0.0F, -3.0F, 0.0F, 0.0F, 3.0F})});
  path.scene.duration_s = 10;
  for (int i = 0; i < 10; ++i) path.frames.push_back({static_cast<double>(i), {0, 0, 12}, {0, 0, 0}});
  RendererOptions options = path_options("brute");
  options.outputs.color = false;
  const Run brute = run_path(path, options);
  options.strategy = "inline-queries";
  const Run run = run_path(path, options);
  CHECK(run.frames[4].report.believed_hidden == 1);
  for (std::size_t f = 0; f < run.frames.size(); ++f) CHECK(late_pixels(run, brute, f).missing == 0);
}

TEST_CASE("queries are exact with four samples and one, and with full barriers") {
  const Path path = std::move(strategy_paths(16, 450)[2]);
  for (const std::uint32_t samples : {1U, 4U}) {
    RendererOptions options = path_options("brute");
    options.samples = samples;
    const Run brute = run_path(path, options);
    options.how.reversed = true;
    const Run backwards = run_path(path, options);
    for (const Way& way : exact_ways()) {
      if (!way.asks()) continue;
      INFO(way.name() << ", samples " << samples);
      options = way.options();
      options.samples = samples;
      options.full_barriers = samples == 1;
      const Run run = run_path(path, options);
      const Difference d = difference(run, brute, backwards);
      CHECK(d.depth + d.ids + d.color == 0);
    }
  }
}

TEST_CASE(
    "pictures are the same with one, two and three frames in flight, and answers come as many frames later") {
  const Path path = std::move(strategy_paths(10, 450)[3]);  // objects appear and vanish in every frame
  for (const StrategyEntry& entry : strategies()) {
    if (entry.name == "inline-queries") continue;  // not exact
    INFO(entry.name);
    RendererOptions options = path_options(std::string(entry.name));
    options.costs = model::rough_costs(true);  // what is asked must not depend on the device
    // What `adaptive` takes by itself follows from what frames took, so beside other programs it asked in one
    // run and not in the next. Its tree is drawn in frames 4 to 7: time for answers three frames late.
    if (entry.name == "adaptive") options.how.change_every = 4;
    options.frames_in_flight = 1;
    const Run one = run_path(path, options);
    std::uint64_t changed = 0;
    for (const FrameResult& frame : one.frames) changed += frame.report.changed;
    CHECK(changed > 100);
    for (const std::uint32_t n : {2U, 3U}) {
      INFO(n << " in flight");
      options.frames_in_flight = n;
      const Run run = run_path(path, options);
      // Beliefs about what is hidden are as old as there are frames in flight, and may settle which of two
      // equal depths comes first; depths themselves never differ.
      const bool asks = sums_of(one).queries > 0;
      CHECK(asks == (entry.name.starts_with("queries") || entry.name == "adaptive"));
      const Difference d = difference(run, one, one);
      CHECK(d.depth == 0);
      if (!asks) CHECK(d.ids + d.color == 0);
      CHECK(d.ids * 1000 <= d.pixels);
      CHECK(d.color * 1000 <= d.pixels);
      const auto first_answer = [](const Run& r) {
        const auto found = std::find_if(r.frames.begin(), r.frames.end(),
                                        [](const FrameResult& f) { return f.report.answers > 0; });
        return found - r.frames.begin();
      };
      if (asks) {
        CHECK(first_answer(one) >= 1);
        CHECK(first_answer(run) == first_answer(one) + n - 1);
      }
    }
  }
}

TEST_CASE(
    "without conditional rendering queries stay exact by indirect draws; without those too they come late") {
  const Path path = std::move(strategy_paths(12, 450)[0]);
  const Run brute = run_path(path, path_options("brute"));
  RendererOptions options = path_options("queries-all");
  options.how.no_conditional_rendering = true;
  const Run run = run_path(path, options);
  CHECK(run.warnings.empty());
  CHECK(sums_of(run).reveals > 0);
  CHECK(sums_of(run).indirect_commands > 0);
  CHECK(difference(run, brute, brute).depth == 0);
  options.how.no_indirect_draws = true;
  const Run late = run_path(path, options);
  REQUIRE(late.warnings.size() == 1);
  CHECK(late.warnings[0].find("--late-visibility") != std::string::npos);
  CHECK(late.frames.back().report.queries > 0);
  CHECK(difference(late, brute, brute).depth > 0);
}

TEST_CASE("indirect draws that the device does not have are warned of when they were asked for") {
  const Path path = std::move(strategy_paths(2, 450)[0]);
  RendererOptions options = Way{"octree", NodeForm::indirect}.options();
  options.how.no_indirect_draws = true;
  const Run run = run_path(path, options);
  REQUIRE(run.warnings.size() == 1);
  CHECK(run.warnings[0].find("--node-form") != std::string::npos);
  CHECK(run.frames.back().report.secondaries > 0);
  options.how.node_form = NodeForm::automatic;
  CHECK(run_path(path, options).warnings.empty());
}
