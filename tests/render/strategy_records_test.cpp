// What each way of drawing records, keeps and counts; that it draws what `brute` does is strategy_test.cpp's.
#include <array>
#include <utility>

#include "tests/render/strategy_ways.h"

using namespace scenegen;
using namespace scenegen::render;
using namespace scenegen::render::test;

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
    const std::uint32_t row = i / 15;
    const glm::vec3 at{1.5F * static_cast<float>(i % 15) - 10.0F, 1.5F * static_cast<float>(row) - 4.0F,
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
  for (std::uint32_t i = 0; i < 200; ++i) {
    const std::uint32_t row = i / 20;
    add_object(path.scene, "box " + std::to_string(i), mesh,
               {0.4F * static_cast<float>(i % 20) - 4.0F, 0.4F * static_cast<float>(row) - 2.0F, 0},
               {0.1F, 0.1F, 0.1F});
  }
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
    // Which of 203 slots are visible and which mirrored, for the first frames of two in flight and where that
    // changed, and which five blocks are looked at; for both passes.
    const bool written = i < 2 || i == 13 || i == 14;
    CHECK(r.list_bytes == 2 * ((written ? 2 * 4 * sizeof(std::uint64_t) : 0) + 5 * sizeof(std::uint32_t)));
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
