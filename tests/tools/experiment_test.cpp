// Parts of the experiments: indexes, the processor's depth pictures, late queries, the papers' figures.
#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "scene/random.h"
#include "tools/experiments/all.h"
#include "tools/experiments/bvh.h"
#include "tools/experiments/cell_octree.h"
#include "tools/experiments/late_queries.h"
#include "tools/experiments/octree_or_bvh.h"
#include "tools/experiments/paper.h"
#include "tools/experiments/run.h"
#include "tools/experiments/scenes.h"

using namespace scenegen;
using namespace scenegen::tools;

namespace {

std::vector<std::uint32_t> numbers(std::size_t count) {
  std::vector<std::uint32_t> out(count);
  std::iota(out.begin(), out.end(), 0U);
  return out;
}

render::View view_of(const glm::vec3& eye, const glm::vec3& target) {
  render::Lens lens;
  lens.yfov_rad = 0.7F;
  return render::make_view(render::look_at(eye, target), lens, 16.0F / 9.0F);
}

FlatTree octree_of(const BoxedObjects& objects, OctreeUnits units) {
  render::Octree tree(
      objects.slots,
      [](std::uint32_t) {
        return render::Octree::Work{36, 12};
      },
      objects.options);
  for (std::uint32_t i = 0; i < objects.boxes.size(); ++i) tree.insert(i);
  tree.refresh();
  return flatten(tree, units);
}

/// Boxes hold what is below, ends nest, and the root is round everything.
void check_form(const FlatTree& tree, std::span<const Box> boxes) {
  REQUIRE_FALSE(tree.nodes.empty());
  CHECK(tree.nodes[0].end == tree.nodes.size());
  const std::vector<std::uint32_t> parents = tree.parents();
  std::size_t wrong = 0;
  for (std::uint32_t i = 0; i < tree.nodes.size(); ++i) {
    const FlatTree::Node& node = tree.nodes[i];
    wrong += node.end > i && node.end <= tree.nodes[parents[i]].end ? 0 : 1;
    Box box;
    for (std::uint32_t k = node.first; k < node.own_end; ++k) box.add(boxes[tree.objects[k]]);
    for (std::uint32_t c = i + 1; c < node.end; c = tree.nodes[c].end) box.add(tree.nodes[c].box_m);
    Box both = node.box_m;
    both.add(box);
    wrong += both == node.box_m ? 0 : 1;
  }
  CHECK(wrong == 0);
}

/// Objects that a walk in the frustum comes by and whose own box is in it.
std::vector<std::uint32_t> culled(const FlatTree& tree, std::span<const Box> boxes,
                                  const render::CullPlanes& planes) {
  std::vector<std::uint32_t> out;
  walk(
      tree, [&](std::uint32_t i) { return in_frustum(planes, tree.nodes[i].box_m); },
      [&](std::uint32_t i) {
        for (std::uint32_t k = tree.nodes[i].first; k < tree.nodes[i].own_end; ++k) {
          if (in_frustum(planes, boxes[tree.objects[k]])) out.push_back(tree.objects[k]);
        }
      });
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

TEST_CASE("every index finds the same objects in the frustum") {
  const Scene scene = random_boxes(3000, 7);
  const BoxedObjects objects = boxed(scene, 10);
  const std::vector<std::uint32_t> all = numbers(objects.boxes.size());
  RefitBvh refit(objects.boxes, 10);
  for (const std::uint32_t o : all) refit.show(o);
  refit.refit();
  const auto single = build_cell_octree(objects.boxes, 4, References::single);
  const auto multiple = build_cell_octree(objects.boxes, 4, References::multiple);
  REQUIRE((single && multiple));
  const std::vector<FlatTree> trees{octree_of(objects, OctreeUnits::nodes),
                                    octree_of(objects, OctreeUnits::chunks),
                                    build_bvh_sah(objects.boxes, all, 10),
                                    build_lbvh(objects.boxes, all, 10),
                                    refit.tree(),
                                    *single};
  for (const FlatTree& tree : trees) {
    std::vector<std::uint32_t> held(tree.objects);
    std::sort(held.begin(), held.end());
    CHECK(held == all);  // each once
    CHECK(tree.nodes.size() > 100);
  }
  // The octree's boxes are a little larger than the objects', see SlotBoxes.
  for (std::size_t i = 2; i < trees.size(); ++i) check_form(trees[i], objects.boxes);
  for (const Height height : {Height::street, Height::roofs}) {
    for (const render::View& view : camera_round(objects.options.root_m, height, 3)) {
      const render::CullPlanes planes =
          render::cull_planes(render::frustum_of(view.clip_from_world), objects.options.root_m);
      std::vector<std::uint32_t> wanted;
      for (const std::uint32_t o : all) {
        if (in_frustum(planes, objects.boxes[o])) wanted.push_back(o);
      }
      REQUIRE(wanted.size() > 100);
      for (const FlatTree& tree : trees) CHECK(culled(tree, objects.boxes, planes) == wanted);
      std::vector<std::uint32_t> of_many = culled(*multiple, objects.boxes, planes);
      CHECK(of_many.size() > wanted.size());
      of_many.erase(std::unique(of_many.begin(), of_many.end()), of_many.end());
      CHECK(of_many == wanted);
    }
  }
}

TEST_CASE("references grow with the height of the octree, until there are too many") {
  const std::vector<Box> boxes = object_bounds(random_boxes(500, 1));
  std::size_t before = boxes.size();
  for (std::uint32_t height = 0; height <= 5; ++height) {
    const auto single = build_cell_octree(boxes, height, References::single);
    const auto multiple = build_cell_octree(boxes, height, References::multiple);
    REQUIRE((single && multiple));
    CHECK(single->objects.size() == boxes.size());
    CHECK(multiple->objects.size() >= before);
    before = multiple->objects.size();
  }
  CHECK(before > 3 * boxes.size());
  CHECK_FALSE(build_cell_octree(boxes, 5, References::multiple, 1000));
}

TEST_CASE("hierarchies of objects in one place, and of few") {
  const std::vector<Box> same(100, Box{glm::vec3(1), glm::vec3(2)});
  for (const auto build : {build_bvh_sah, build_lbvh}) {
    const FlatTree tree = build(same, numbers(same.size()), 7);
    check_form(tree, same);
    CHECK(tree.objects.size() == 100);
    for (const FlatTree::Node& node : tree.nodes) CHECK(node.own_end - node.first <= 7);
    CHECK(build(same, numbers(1), 7).nodes.size() == 1);
  }
}

TEST_CASE("refitted boxes are those of what is there") {
  const std::vector<Box> boxes = object_bounds(random_boxes(400, 3));
  RefitBvh refit(boxes, 5);
  const Random random(5, "changes");
  for (std::uint64_t round = 0; round < 30; ++round) {
    for (std::uint64_t i = 0; i < 40; ++i) {
      const auto object = static_cast<std::uint32_t>(random.below(1000 * round + i, boxes.size()));
      refit.there(object) ? refit.hide(object) : refit.show(object);
    }
    refit.refit();
    std::size_t wrong = 0;
    for (const FlatTree::Node& node : refit.tree().nodes) {
      const auto at = static_cast<std::uint32_t>(&node - refit.tree().nodes.data());
      Box box;
      for (std::uint32_t i = at; i < node.end; ++i) {
        const FlatTree::Node& below = refit.tree().nodes[i];
        for (std::uint32_t k = below.first; k < below.own_end; ++k) {
          if (refit.there(refit.tree().objects[k])) box.add(boxes[refit.tree().objects[k]]);
        }
      }
      wrong += box == node.box_m ? 0 : 1;
    }
    REQUIRE(wrong == 0);
  }
}

TEST_CASE("what the processor's picture hides") {
  Scene scene = box_grid(1);  // a box of 0.4 m at the origin
  Transform wall;
  wall.translation_m = {0, 0, -5};
  wall.scale = {8, 8, 0.1F};
  scene.objects.add("wall", MeshId(0), wall);
  Transform behind;
  behind.translation_m = {0, 0, -6};
  scene.objects.add("behind", MeshId(0), behind);
  const SoftwareDepth picture =
      draw_depths(scene, numbers(3), view_of({0, 0, 5}, {0, 0, 0}), glm::uvec2(160, 90));
  CHECK(picture.visible_objects() == std::vector<std::uint32_t>{0, 1});
  CHECK(picture.ids()[45 * 160 + 80] == 0);
  CHECK(picture.ids()[10 * 160 + 80] == 1);
  // At 5 m distance: near / distance with an infinite far plane.
  CHECK(picture.depth()[45 * 160 + 80] == Approx(0.1 / 4.8).epsilon(1e-3));
  const std::vector<Box> boxes = object_bounds(scene);
  CHECK(picture.visible(boxes[0]));
  CHECK(picture.visible(boxes[1]));
  CHECK_FALSE(picture.visible(boxes[2]));
  CHECK(picture.visible(Box{glm::vec3(-0.2F, -0.2F, -8), glm::vec3(9, 0.2F, -7)}));  // reaches out
  CHECK(picture.visible(Box{glm::vec3(-1, -1, 4), glm::vec3(1, 1, 6)}));             // round the eye
}

TEST_CASE("late queries miss nothing while the camera stands, and something when it jumps") {
  const Scene scene = random_boxes(4000, 2);
  const BoxedObjects objects = boxed(scene, 10);
  const std::vector<std::uint32_t> all = numbers(objects.boxes.size());
  const Box& bounds = objects.options.root_m;
  const render::View still = camera_round(bounds, Height::roofs, 1).front();
  const glm::uvec2 size(160, 90);
  const SoftwareDepth here = draw_depths(scene, all, still, size);
  const double visible = static_cast<double>(here.visible_objects().size());
  const std::vector<render::View> standing(8, still);
  const std::vector<SoftwareDepth> depths(8, here);
  const render::View other = view_of(2.0F * bounds.centre() - still.eye_m(), bounds.centre());
  std::vector<render::View> jumping(standing);
  std::vector<SoftwareDepth> jumping_depths(depths);
  jumping[7] = other;
  jumping_depths[7] = draw_depths(scene, all, other, size);
  for (const FlatTree& tree : {octree_of(objects, OctreeUnits::chunks), build_bvh_sah(objects.boxes, all, 10),
                               build_lbvh(objects.boxes, all, 10)}) {
    const LateWalk walked = walk_with_late_queries(tree, standing, depths, all.size(), {2, 4});
    CHECK(walked.missed == 0);
    CHECK(walked.shown >= visible);
    CHECK(walked.shown < 0.8 * static_cast<double>(all.size()));
    CHECK(walked.queries > 50);
    // Before any answer came, all in the frustum is shown.
    const Walked in_view =
        count_in_frustum(tree, render::cull_planes(render::frustum_of(still.clip_from_world), bounds));
    CHECK(in_view.objects > 3500);
    CHECK(walk_with_late_queries(tree, std::span(standing).first(1), depths, all.size(), {2, 0}).shown ==
          static_cast<double>(in_view.objects));
    CHECK(walk_with_late_queries(tree, jumping, jumping_depths, all.size(), {2, 7}).missed > 0);
  }
}

TEST_CASE("stand-ins have the sizes of the private sets") {
  const PaperTable sets("test_sets");
  for (int set = 1; set <= 4; ++set) {
    const double share = set == 4 ? 0.1 : 0.5;
    const auto made = stand_in(set, share, 1);
    REQUIRE(made);
    const PaperTable::Where row{{"set", std::to_string(set)}};
    CHECK(static_cast<double>(made->scene.objects.size()) ==
          std::round(share * *sets.number(row, "objects")));
    CHECK(static_cast<double>(drawn_vertices(made->scene)) ==
          Approx(share * *sets.number(row, "vertices")).epsilon(0.01));
  }
}

TEST_CASE("the papers' figures are inside") {
  const PaperTable recording("command_recording");
  CHECK(recording.rows() == 12);
  CHECK(recording.number({{"table", "4"}, {"objects", "50000"}}, "submit_ms") == 7.0);
  CHECK_FALSE(recording.number({{"table", "4"}, {"objects", "7"}}, "submit_ms"));
  CHECK(PaperTable("test_sets").number({{"set", "4"}}, "vertices") == 94388454.0);
  CHECK(PaperTable("test_sets").word(13, "reconstruction") == "uv sphere: 9 slices, 4 stacks");  // quoted
  CHECK(std::get<double>(PaperTable("library_static").cell({{"scene", "1"}}, "own_ms")) == 8.5);
}

TEST_CASE("experiments are found by name") {
  const auto all = find_experiments({"all"});
  REQUIRE(all);
  CHECK(all->size() == experiments().size());
  CHECK(find_experiments({"octree-or-bvh", "all", "octree-or-bvh"})->size() == all->size());
  const auto wrong = find_experiments({"octree-or-bhv"});
  REQUIRE_FALSE(wrong);
  CHECK(wrong.error().kind == ErrorKind::usage);
  CHECK(wrong.error().str().find("did you mean 'octree-or-bvh'") != std::string::npos);
}
