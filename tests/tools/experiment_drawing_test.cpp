// Experiments that draw: the device's culling, queries by number, the merged renderer.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "render/spatial/frustum_cull.h"
#include "scene/limits.h"
#include "tests/tools/process.h"
#include "timeline/timeline.h"
#include "tools/experiments/accuracy.h"
#include "tools/experiments/all.h"
#include "tools/experiments/device_culling.h"
#include "tools/experiments/flat_tree.h"
#include "tools/experiments/invisible_objects.h"
#include "tools/experiments/merged_renderer.h"
#include "tools/experiments/octree_or_bvh.h"
#include "tools/experiments/scenes.h"
#include "tools/experiments/software_depth.h"

using namespace scenegen;
using namespace scenegen::tools;
using scenegen::test::TemporaryFolder;

namespace {

ExperimentContext context_of(std::uint32_t samples) {
  static const auto device = render::share_device({.wanted = "", .validation = true});
  REQUIRE(device);
  ExperimentContext out;
  out.device = *device;
  out.device_info = render::info_of(**device);
  out.width = 96;
  out.height = 54;
  out.samples = samples;
  return out;
}

render::View first_camera(const Scene& scene) {
  return render::view_of_camera(scene.cameras.front(), scene.cameras.front().frame_from_camera.matrix(),
                                96.0F / 54.0F);
}

}  // namespace

TEST_CASE("the device culls what the processor culls") {
  const Scene scene = box_grid(9);
  Box bounds;
  const std::vector<Box> boxes = object_bounds(scene);
  for (const Box& b : boxes) bounds.add(b);
  for (const Height height : {Height::street, Height::roofs}) {
    const render::View view = camera_round(bounds, height, 1).front();
    auto stage = DrawStage::make(context_of(1), scene, view, render::vkr::PassKind::color);
    REQUIRE(stage);
    REQUIRE((*stage)->device().indirect_nodes);
    const render::CullPlanes planes =
        render::cull_planes(render::frustum_of(view.clip_from_world), (*stage)->scene().bounds_m());
    std::uint32_t wanted = 0;
    for (std::uint32_t s = 0; s < (*stage)->scene().slot_count(); ++s)
      wanted += in_frustum(planes, (*stage)->scene().boxes().get(s)) ? 1 : 0;
    std::uint32_t drawn = 0;
    const auto done = (*stage)->guarded([&] {
      DeviceCulling culling(**stage);
      (*stage)->frame([&](const render::PassContext& c) { culling.record(c); });
      drawn = culling.drawn();
    });
    INFO((done ? "" : done.error().str()));
    REQUIRE(done);
    CHECK(drawn == wanted);
    CHECK(drawn > 50);
    if (height == Height::street) CHECK(drawn < boxes.size());
  }
}

TEST_CASE("queries breadth first hide objects that no pixel shows, and no others") {
  const Scene scene = random_boxes(3000, 4);
  const render::View view = first_camera(scene);
  auto stage = DrawStage::make(context_of(1), scene, view, render::vkr::PassKind::ids);
  REQUIRE(stage);
  BoxedObjects objects = boxed(scene, 5);
  render::Octree tree(
      objects.slots,
      [](std::uint32_t) {
        return render::Octree::Work{36, 12};
      },
      objects.options);
  std::vector<std::uint32_t> all;
  for (std::uint32_t o = 0; o < objects.boxes.size(); ++o) {
    tree.insert(o);
    all.push_back(o);
  }
  tree.refresh();
  std::vector<AskedNode> asked;
  std::vector<AskedNode> again;
  const auto done = (*stage)->guarded([&] {
    NodeQueries queries(**stage, 1024);
    asked = queries.ask_all(tree);
    CHECK(queries.time(asked, 100).read_ms >= 0);
    again = NodeQueries(**stage, 64).ask_all(tree);  // in portions
  });
  INFO((done ? "" : done.error().str()));
  REQUIRE(done);
  REQUIRE(asked.size() > 200);
  REQUIRE(again.size() == asked.size());
  for (std::size_t i = 0; i < asked.size(); ++i) REQUIRE(again[i].hidden == asked[i].hidden);
  std::vector<std::uint8_t> hidden(all.size(), 0);
  std::size_t hidden_objects = 0;
  std::uint32_t level = 0;
  for (const AskedNode& a : asked) {
    CHECK(tree.node(a.node).level >= level);  // breadth first
    level = tree.node(a.node).level;
    if (!a.hidden) continue;
    hidden_objects += a.objects;
    for (const std::uint32_t o : all) {
      const render::Octree::Node* at = &tree.node(tree.chunk(tree.chunk_of(o)).node);
      while (at != &tree.node(a.node) && at->parent != render::Octree::kNone) at = &tree.node(at->parent);
      if (at == &tree.node(a.node)) hidden[o] = 1;
    }
  }
  // Each hidden object is below one hidden node only.
  CHECK(static_cast<std::size_t>(std::count(hidden.begin(), hidden.end(), 1)) == hidden_objects);
  CHECK(hidden_objects > 200);
  const SoftwareDepth picture = draw_depths(scene, all, view, {96, 54});
  std::size_t wrong = 0;
  for (const std::uint32_t o : picture.visible_objects()) wrong += hidden[o];
  CHECK(wrong == 0);
}

TEST_CASE("the merged renderer shows what the renderer shows") {
  auto made = stand_in(1, 0.01, 1);
  REQUIRE(made);
  REQUIRE(animate_as_project(*made, 1));
  const Scene& scene = made->scene;
  ExperimentContext context = context_of(4);
  auto merged = MergedRenderer::make(context, scene, first_camera(scene));
  REQUIRE(merged);
  timeline::Player player(timeline::compile(scene));
  std::uint64_t vertices = 0;
  for (const double share : {0.3, 1.0, 0.6}) {
    const timeline::ChangeSet& changes = player.seek(share * static_cast<double>(scene.duration_s));
    const auto frame = (*merged)->frame(player, true);
    INFO((frame ? "" : frame.error().str()));
    REQUIRE(frame);
    CHECK(frame->merge_ms > 0);
    CHECK((*merged)->frame(player, false)->merge_ms == 0);
    CHECK((*merged)->vertices() != vertices);
    vertices = (*merged)->vertices();
    CHECK((*merged)->draws() < 40);
    const std::vector<std::uint8_t> ours = (*merged)->stage().read_picture();

    render::RendererOptions o;
    o.shared_device = context.device;
    o.size = {context.width, context.height};
    o.shadows = false;
    o.strategy = "brute";
    auto renderer = render::Renderer::create(scene, player, o);
    REQUIRE(renderer);
    render::FrameResult result;
    REQUIRE(renderer->submit(changes, player, first_camera(scene)));
    REQUIRE(renderer->finish(result));
    REQUIRE(ours.size() == result.rgba.size());
    // Places are computed by the processor, so edges differ a little; blended ones are not sorted.
    std::size_t far_off = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) far_off += std::abs(ours[i] - result.rgba[i]) > 24 ? 1 : 0;
    CHECK(far_off < ours.size() / 200);
  }
}

TEST_CASE("accuracy: frames of one and of two in flight, with what was predicted of them") {
  const ExperimentContext context = context_of(1);
  const Scene scene = box_grid(6);
  render::RendererOptions options;
  options.shared_device = context.device;
  options.size = {context.width, context.height};
  options.samples = 1;
  options.shadows = false;
  for (const render::model::Method method : {kAccuracyMethods.front(), kAccuracyMethods.back()}) {
    std::array<std::size_t, 2> told{};
    AccuracyRequest request;
    request.frames = 5;
    request.seconds = 60;
    request.two_in_flight = true;
    request.on_frame = [&](const render::FrameReport& report, bool two) {
      ++told.at(two ? 1 : 0);
      CHECK(report.drawn > 0);
    };
    const auto run = measure_accuracy(scene, method, accuracy_options(options, method), request);
    INFO((run ? "" : run.error().str()));
    REQUIRE(run);
    CHECK(run->one_ms.size() == 5);
    CHECK(run->two_ms.size() == 4);
    CHECK(told == std::array<std::size_t, 2>{5, 4});
    CHECK(run->predicted_one_ms ==
          Approx(1e3 * render::model::predict(method, run->last.facts,
                                              render::model::rough_costs(context.device_info.type == "CPU"),
                                              {.frames_in_flight = 1})
                           .frame_s)
              .epsilon(0.5));
    CHECK(run->last.predicted[static_cast<std::size_t>(method)].frame_s > 0);
  }
}

TEST_CASE("deviations are of what was measured") {
  CHECK(deviation_percent(3, 2) == 50);
  CHECK(deviation_percent(1, 2) == 50);
  const DeviationSummary s = summarize_deviations({4, 1, 2, 3, 40, 5, 6, 7, 8, 9});
  CHECK(s.count == 10);
  CHECK(s.mean == 8.5);
  CHECK(s.median == 5.5);
  CHECK(s.p90 == 40);
  CHECK(s.worst == 40);
  CHECK(summarize_deviations({}).count == 0);
}

TEST_CASE("merged-batch looks from the paths that it is given") {
  ExperimentContext context = context_of(1);
  const TemporaryFolder folder;
  context.folder = folder.path();
  context.quick = true;
  context.repeat = 1;
  context.seed = 1;
  const auto paths_of = [](const DocumentSection& section) {
    std::vector<std::string> out;
    for (const Block& block : section.blocks) {
      const auto* table = std::get_if<DocumentTable>(&block);
      if (table == nullptr) continue;
      for (const auto& row : table->rows) {
        std::string line = table->id;
        out.push_back(line.append(" ").append(std::get<std::string>(row[1])));
        // D's figures beside one path of each table.
        const bool compared = std::any_of(row.begin(), row.end(), [&](const Cell& cell) {
          const auto column = static_cast<std::size_t>(&cell - row.data());
          return table->columns[column].origin == Origin::paper && std::holds_alternative<double>(cell);
        });
        out.back() += compared ? " compared" : "";
      }
    }
    return out;
  };
  const auto usual = merged_batch(context);
  INFO((usual ? "" : usual.error().str()));
  REQUIRE(usual);
  CHECK(paths_of(*usual) ==
        std::vector<std::string>{"library-static fixed compared", "library-static fly",
                                 "library-static fixed compared", "library-static fly",
                                 "library-animation fixed", "library-animation fly compared",
                                 "library-animation fixed", "library-animation fly compared"});
  REQUIRE(usual->verdicts.size() == 4);
  CHECK(usual->verdicts[0].source == "D table 33");
  CHECK(usual->verdicts[3].source == "D table 34");
  CHECK(usual->failures.empty());
  context.camera_paths = {"orbit"};
  const auto orbit = merged_batch(context);
  REQUIRE(orbit);
  CHECK(paths_of(*orbit) ==
        std::vector<std::string>{"library-static orbit compared", "library-static orbit compared",
                                 "library-animation orbit compared", "library-animation orbit compared"});
}
