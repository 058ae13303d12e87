// Every strategy draws what `brute` draws, on paths made to catch what could go wrong.
#include "render/strategy/strategy.h"

#include <algorithm>
#include <cstdio>
#include <utility>

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

/// A strategy, with one of the forms in which chunks are kept.
struct Way {
  std::string strategy;
  NodeForm form = NodeForm::secondaries;
  [[nodiscard]] bool asks() const { return strategy.starts_with("queries"); }
  [[nodiscard]] std::string name() const {
    return strategy + (form == NodeForm::indirect ? ", indirect" : ", secondaries");
  }
  [[nodiscard]] RendererOptions options() const {
    RendererOptions o = path_options(strategy);
    o.how.node_form = form;
    // On every device `queries` is to find that asking pays, though the scenes are small.
    o.costs = model::rough_costs(true);
    o.costs->query_s = 1e-6;
    o.costs->ask_s = 1e-7;
    o.costs->second_part_cpu_s = o.costs->second_part_device_s = 0;
    return o;
  }
};

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

TEST_CASE("octree keeps commands: nothing changed, nothing recorded; what changed is recorded alone") {
  const Path path = std::move(strategy_paths(40, 450)[2]);  // a still camera before vanishing walls
  const Run run = run_path(path, Way{"octree"}.options());
  const Run indirect = run_path(path, Way{"octree", NodeForm::indirect}.options());
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
    // The draws of a chunk are written once for both passes.
    CHECK(2 * indirect.frames[i].report.recorded == r.recorded);
    CHECK(2 * indirect.frames[i].report.recorded_draws == r.recorded_draws);
    (r.changed == 0 ? quiet : busy) += 1;
  }
  CHECK(run.frames[0].report.recorded == run.frames[0].report.secondaries);
  CHECK(2 * indirect.frames[0].report.recorded == run.frames[0].report.secondaries);
  CHECK(quiet > 0);
  CHECK(busy > 10);
}

TEST_CASE(
    "instanced draws equal objects by one command, whatever is culled, hidden or mirrored between them") {
  Path path{"equal objects", {}, {}};
  const MeshId red = add_mesh(path.scene, box_geometry(), plain({1, 0, 0, 1}));
  path.scene.materials.push_back(plain({0, 0, 1, 1}));
  Mesh other = path.scene.meshes[red.value];  // of the same geometry
  other.primitives[0].material = MaterialId(path.scene.materials.size() - 1);
  path.scene.meshes.push_back(other);
  Material glass = plain({0, 1, 0, 0.5F});
  glass.alpha_mode = AlphaMode::blend;
  const MeshId pane = add_mesh(path.scene, box_geometry(), glass);
  for (std::uint32_t i = 0; i < 90; ++i) {
    const MeshId mesh = i % 9 == 8 ? pane : MeshId(i % 2);
    const glm::vec3 at{1.5F * static_cast<float>(i % 15) - 10.0F, 1.5F * static_cast<float>(i / 15) - 4.0F,
                       -0.1F * static_cast<float>(i % 7)};
    const ObjectId id =
        add_object(path.scene, "box " + std::to_string(i), mesh, at, {i % 3 == 1 ? -1.0F : 1.0F, 1.0F, 1.0F});
    if (i % 4 == 1) appear_at(path.scene, id, 1.0F + static_cast<float>(i % 5));
  }
  path.scene.duration_s = 10;
  for (int i = 0; i < 12; ++i)
    path.frames.push_back(
        {0.8 * i, {2.0F * static_cast<float>(i % 6), 1, 12}, {static_cast<float>(i), 0, 0}});
  const Run brute = run_path(path, path_options("brute"));
  const Run separate = run_path(path, path_options("inline"));
  const Run run = run_path(path, path_options("instanced"));
  const Difference d = difference(run, brute, brute);
  CHECK(d.depth + d.ids + d.color == 0);
  const Run on_device = run_path(path, path_options("hi-z"));
  const Difference of_device = difference(on_device, brute, brute);
  CHECK(of_device.depth + of_device.ids + of_device.color == 0);
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const FrameReport& r = run.frames[i].report;
    const FrameReport& s = separate.frames[i].report;
    CHECK(r.drawn == s.drawn);
    CHECK(r.triangles == s.triangles);
    CHECK(s.ids_draws > 30);
    CHECK(r.ids_draws == 2);                                // those that are mirrored and the others
    CHECK(r.draws - r.ids_draws == s.draws - s.ids_draws);  // panes are drawn one by one
    CHECK(r.list_bytes == 4 * s.ids_draws);
    CHECK(r.uploaded_bytes == s.uploaded_bytes + r.list_bytes);
  }
}

TEST_CASE(
    "hi-z draws what is not hidden, mirrored objects and those that turn over too, by a command a block") {
  Path path{"turning over", {}, {}};
  const MeshId mesh = add_mesh(path.scene, box_geometry(), plain({1, 0, 0, 1}));
  const MeshId other = add_mesh(path.scene, box_geometry(), plain({0, 0, 1, 1}));
  // A wall in front of rows of boxes; one of those and a box beside the wall turn over half-way.
  add_object(path.scene, "wall", other, {0, 0, 3}, {10.0F, 10.0F, 0.2F});
  for (std::uint32_t i = 0; i < 200; ++i)
    add_object(path.scene, "box " + std::to_string(i), mesh,
               {0.4F * static_cast<float>(i % 20) - 4.0F, 0.4F * static_cast<float>(i / 20) - 2.0F, 0},
               {0.1F, 0.1F, 0.1F});
  path.scene.frames.emplace_back();
  const FrameId frame(static_cast<std::uint32_t>(path.scene.frames.size() - 1));
  for (const glm::vec3 at : {glm::vec3(7, 0, 3), glm::vec3(0.1F, 0.1F, 0)}) {
    Transform place;
    place.translation_m = at;
    path.scene.objects.add("turning", mesh, place, frame);
  }
  path.scene.frame_tracks.push_back(
      {frame, path.scene.add_track(Property::scale, Interpolation::step, std::array{0.0F, 5.0F},
                                   std::array{1.0F, 1.0F, 1.0F, -1.0F, 1.0F, 1.0F})});
  path.scene.duration_s = 10;
  for (int i = 0; i < 24; ++i)
    path.frames.push_back({0.4 * i, {6.0F * static_cast<float>(i % 2), 0, 12}, {0, 0, 0}});
  const Run brute = run_path(path, path_options("brute"));
  RendererOptions options = path_options("hi-z");
  const Run run = run_path(path, options);
  options.full_barriers = true;
  const Run full = run_path(path, options);
  const Difference d = difference(run, brute, brute);
  CHECK(d.depth + d.ids + d.color == 0);
  const Difference same = difference(run, full, full);
  CHECK(same.depth + same.ids + same.color == 0);
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    const FrameReport& r = run.frames[i].report;
    CHECK(r.drawn == full.frames[i].report.drawn);
    CHECK(r.triangles == 12 * r.drawn);
    CHECK(r.drawn >= 2);
    // A frame of which nothing is known draws all; the next begins with that.
    const bool known = i > 1 && i != 13 && i != 14;
    CHECK((r.drawn < brute.frames[i].report.drawn / 10) == known);
    // Four blocks of 64 slots and the wall; twice as many once something was turned over: in two parts.
    const bool turned = i >= 13;
    CHECK(r.draws == (turned ? 20 : 10));
  }
}

TEST_CASE("indirect draws change states as seldom as inline does; kept command buffers in each chunk") {
  Path path = std::move(strategy_paths(3, 450)[2]);
  // Two states that every node has draws of.
  const std::size_t meshes = path.scene.meshes.size();
  REQUIRE(meshes > 0);
  Material both_sides;
  both_sides.double_sided = true;
  path.scene.materials.push_back(both_sides);
  const MaterialId material(static_cast<std::uint32_t>(path.scene.materials.size() - 1));
  for (std::size_t m = 0; m < meshes; ++m) {
    path.scene.meshes.push_back(path.scene.meshes[m]);
    for (Primitive& primitive : path.scene.meshes.back().primitives) primitive.material = material;
  }
  for (std::size_t i = 0; i < path.scene.objects.size(); i += 2)
    path.scene.objects.mesh[i].value += static_cast<std::uint32_t>(meshes);
  const Run flat = run_path(path, path_options("inline"));
  const Run indirect = run_path(path, Way{"octree", NodeForm::indirect}.options());
  const Run kept = run_path(path, Way{"octree"}.options());
  const FrameReport& of_flat = flat.frames.back().report;
  const FrameReport& of_indirect = indirect.frames.back().report;
  const FrameReport& of_kept = kept.frames.back().report;
  REQUIRE(of_indirect.chunks > 20);
  CHECK(of_indirect.indirect_commands > 2 * of_indirect.chunks);  // in two passes, mostly of two states
  CHECK(of_flat.state_changes > 1);
  CHECK(of_indirect.state_changes == of_flat.state_changes);
  CHECK(of_kept.state_changes > of_kept.chunks);

  // Slots that follow one another in a chunk are instances of one command, unless that is not wanted.
  RendererOptions options = Way{"octree", NodeForm::indirect}.options();
  options.how.objects_per_node = 500;
  const Run instances = run_path(path, options);
  options.how.single_draws = true;
  const Run single = run_path(path, options);
  const FrameReport& of_single = single.frames.back().report;
  const FrameReport& of_instances = instances.frames.back().report;
  CHECK(of_single.draws == of_single.drawn);
  CHECK(of_instances.drawn == of_single.drawn);
  CHECK(2 * of_instances.draws < of_single.draws);
  CHECK(of_instances.triangles == of_single.triangles);
  const Difference d = difference(instances, single, single);
  CHECK(d.depth + d.ids + d.color == 0);
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

TEST_CASE("stages of processor and device are parts of the whole, and those that are not used are 0") {
  const Path path = std::move(strategy_paths(10, 450)[2]);
  for (const NodeForm form : {NodeForm::secondaries, NodeForm::indirect}) {
    for (const char* strategy : {"inline", "octree", "queries-all", "inline-queries"}) {
      INFO(strategy << " " << static_cast<int>(form));
      RendererOptions options = path_options(strategy);
      options.how.node_form = form;
      options.shadows = true;
      options.gpu_stages_on_cpu = true;
      const Run run = run_path(path, options);
      const bool asks = std::string(strategy).find("queries") != std::string::npos;
      double receive = 0, second = 0;
      for (const FrameResult& frame : run.frames) {
        const FrameReport& r = frame.report;
        CHECK(r.update_octree_ms <= r.update_ms);
        CHECK(r.upload_ms > 0);
        CHECK(r.upload_ms + r.keep_ms + r.secondaries_ms + r.ask_ms + r.receive_ms <= r.record_ms);
        CHECK((r.secondaries_ms > 0) == !std::string(strategy).starts_with("inline"));
        CHECK((r.ask_ms > 0) == asks);
        REQUIRE(r.gpu_ms > 0);
        double sum = 0;
        for (const double ms : r.gpu_stages_ms) {
          CHECK(ms >= 0);
          sum += ms;
        }
        CHECK(sum <= Approx(r.gpu_ms));
        receive += r.receive_ms;
        second += r.gpu_stages_ms[static_cast<std::size_t>(GpuStage::second_part)];
      }
      CHECK((receive > 0) == asks);
      CHECK((second > 0) == (std::string(strategy) == "queries-all"));
    }
  }
  RendererOptions options = path_options("inline");
  auto device = share_device(options.device);
  REQUIRE(device);
  const bool software = info_of(**device).type == "CPU";
  for (const FrameResult& frame : run_path(path, options).frames)
    CHECK((frame.report.gpu_stages_ms.front() < 0) == software);
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
