// The octree against a plain model of it, through random insertions, removals and moves.
#include "render/spatial/octree.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <vector>

#include "gen/generate.h"
#include "scene/random.h"

using namespace scenegen;
using namespace scenegen::render;

namespace {

constexpr std::uint32_t kNone = Octree::kNone;

Octree::Work work_of(std::uint32_t slot) {
  return {3 * (slot % 7 + 1), slot % 5 + 1};
}

bool contains(const Box& outer, const Box& inner) {
  return glm::all(glm::lessThanEqual(outer.lo, inner.lo)) &&
         glm::all(glm::greaterThanEqual(outer.hi, inner.hi));
}

/// What the tree should hold, and a check of every rule that its header states.
struct Model {
  SlotBoxes boxes;
  std::set<std::uint32_t> in;

  Octree::Content check_node(const Octree& tree, std::uint32_t number, std::set<std::uint32_t>& seen) const {
    const Octree::Node& node = tree.node(number);
    Octree::Content sum;
    std::uint32_t fitting = 0;
    std::uint64_t last_code = 0;
    for (const std::uint32_t c : node.chunks) {
      const Octree::Chunk& chunk = tree.chunk(c);
      REQUIRE(chunk.node == number);
      REQUIRE_FALSE(chunk.slots.empty());
      REQUIRE(chunk.slots.size() <= tree.slots_per_node());
      REQUIRE(std::is_sorted(chunk.slots.begin(), chunk.slots.end()));
      REQUIRE(chunk.first_code >= last_code);
      last_code = chunk.first_code;
      Octree::Content own;
      for (const std::uint32_t slot : chunk.slots) {
        REQUIRE(tree.chunk_of(slot) == c);
        REQUIRE(seen.insert(slot).second);
        const Box box = boxes.get(slot);
        own.box_m.add(box);
        own.vertices += work_of(slot).vertices;
        own.triangles += work_of(slot).triangles;
        const glm::dvec3 s(box.size());
        own.area_m2 += 2 * (s.x * s.y + s.y * s.z + s.z * s.x);
        fitting += check_place(node, box, number == 0) ? 1 : 0;
      }
      REQUIRE(chunk.content.box_m == own.box_m);
      REQUIRE(chunk.content.slots == chunk.slots.size());
      REQUIRE(chunk.content.vertices == own.vertices);
      REQUIRE(chunk.content.triangles == own.triangles);
      REQUIRE(chunk.content.area_m2 == Approx(own.area_m2));
      sum.box_m.add(own.box_m);
      sum.vertices += own.vertices;
      sum.triangles += own.triangles;
      sum.area_m2 += own.area_m2;
      sum.slots += static_cast<std::uint32_t>(chunk.slots.size());
    }
    if (node.leaf()) {
      REQUIRE(fitting <= tree.slots_per_node());
    } else {
      REQUIRE(fitting == 0);  // each slot is as deep as it can be
      for (std::uint32_t i = 0; i < 8; ++i) {
        REQUIRE(tree.node(node.first_child + i).parent == number);
        const Octree::Content child = check_node(tree, node.first_child + i, seen);
        sum.box_m.add(child.box_m);
        sum.vertices += child.vertices;
        sum.triangles += child.triangles;
        sum.area_m2 += child.area_m2;
        sum.slots += child.slots;
      }
      REQUIRE(sum.slots > tree.slots_per_node() / 2);  // else it would be one node again
    }
    REQUIRE(node.content.slots == sum.slots);
    REQUIRE(node.content.vertices == sum.vertices);
    REQUIRE(node.content.triangles == sum.triangles);
    REQUIRE(node.content.area_m2 == Approx(sum.area_m2));
    REQUIRE((sum.slots == 0 || node.content.box_m == sum.box_m));
    return sum;
  }

  /// Would it fit a child? And does it belong here at all?
  static bool check_place(const Octree::Node& node, const Box& box, bool root) {
    const Box cell{node.centre_m - node.half_m, node.centre_m + node.half_m};
    const float ulps = 1e-5F * (node.half_m + glm::length(node.centre_m));
    const Box grown{cell.lo - ulps, cell.hi + ulps};
    REQUIRE((root || contains(grown, box)));
    if (root && !contains(cell, box)) return false;
    bool fits = true;
    for (int a = 0; a < 3; ++a)
      fits = fits && (box.lo[a] >= node.centre_m[a] || box.hi[a] <= node.centre_m[a]);
    return fits;
  }

  void check(Octree& tree) const {
    tree.refresh();
    std::set<std::uint32_t> seen;
    check_node(tree, 0, seen);
    REQUIRE(seen == in);
    std::size_t chunks = 0;
    for (std::uint32_t i = 0; i < tree.chunk_numbers(); ++i) chunks += tree.chunk(i).node != kNone ? 1 : 0;
    REQUIRE(chunks == tree.chunk_count());
  }

  void check_culling(const Octree& tree, const View& view, OctreeCounters& counters) const {
    const Box all = tree.root().content.box_m;
    const CullPlanes planes = cull_planes(frustum_of(view.clip_from_world), all);
    std::vector<std::uint32_t> chunks;
    tree.cull(planes, view.eye_m(), chunks, counters);
    std::set<std::uint32_t> got(chunks.begin(), chunks.end());
    REQUIRE(got.size() == chunks.size());
    for (std::uint32_t i = 0; i < tree.chunk_numbers(); ++i) {
      if (tree.chunk(i).node == kNone) continue;
      const auto planes_span = planes.all();
      const bool inside = std::none_of(planes_span.begin(), planes_span.end(), [&](const CullPlane& p) {
        return side_of(p, tree.chunk(i).content.box_m) == Side::outside;
      });
      REQUIRE(inside == (got.count(i) == 1));
    }
  }
};

Box random_box(const Random& random, std::uint64_t index, float world_m, float size_m) {
  const auto unit = [&](std::uint64_t k) { return random.unit(8 * index + k); };
  const glm::vec3 at = world_m * (2.0F * glm::vec3(unit(0), unit(1), unit(2)) - 1.0F);
  return {at, at + glm::vec3(unit(3), unit(4), unit(5)) * size_m};
}

View view_from(const glm::vec3& eye, const glm::vec3& target) {
  Lens lens;
  lens.yfov_rad = 0.7F;
  return make_view(look_at(eye, target), lens, 1.6F);
}

}  // namespace

TEST_CASE("a tree keeps its rules through random changes, for several sizes of node") {
  for (const std::uint32_t per_node : {1U, 5U, 20U}) {
    constexpr std::uint32_t kSlots = 1500;
    Model model;
    model.boxes.resize(kSlots);
    const Random random(per_node, "octree");
    for (std::uint32_t i = 0; i < kSlots; ++i) {
      const float size = i % 50 == 0 ? 30.0F : 1.0F;  // some are large: they stay high in the tree
      model.boxes.set(i, random_box(random, i, 40.0F, size));
    }
    Octree::Options options;
    options.root_m = Box{glm::vec3(-35), glm::vec3(35)};  // some boxes lie outside
    options.slots = kSlots;
    options.slots_per_node = per_node;
    Octree tree(model.boxes, work_of, options);
    model.check(tree);
    std::uint64_t r = 0;
    for (int round = 0; round < 12; ++round) {
      const bool shrinking = round % 4 == 3;
      for (int step = 0; step < 600; ++step) {
        const auto slot = static_cast<std::uint32_t>(random.below(100'000 + r++, kSlots));
        const std::uint64_t what = random.below(100'000 + r++, 10);
        if (model.in.count(slot) == 0) {
          if (shrinking) continue;
          tree.insert(slot);
          model.in.insert(slot);
        } else if (what < (shrinking ? 9U : 3U)) {
          tree.remove(slot);
          model.in.erase(slot);
        } else {
          const Box old = model.boxes.get(slot);
          const glm::vec3 by = 0.02F * glm::vec3(random.unit(r), random.unit(r + 1), random.unit(r + 2));
          r += 3;
          model.boxes.set(
              slot, what < 6 ? Box{old.lo + by, old.hi + by} : random_box(random, 7000 + r, 45.0F, 1.0F));
          tree.move(slot);
        }
      }
      model.check(tree);
      OctreeCounters counters;
      model.check_culling(tree, view_from({60, 20, 50}, {0, 0, 0}), counters);
      model.check_culling(tree, view_from({3, 2, 1}, {30, 0, 0}), counters);
    }
    CHECK(model.in.size() > 100);
    for (const std::uint32_t slot : std::vector<std::uint32_t>(model.in.begin(), model.in.end()))
      tree.remove(slot);
    model.in.clear();
    model.check(tree);
    CHECK(tree.node_count() == 1);
    CHECK(tree.chunk_count() == 0);
  }
}

TEST_CASE("a chunk's revision tells what must be recorded again, and never comes back") {
  SlotBoxes boxes;
  boxes.resize(4);
  for (std::uint32_t i = 0; i < 4; ++i)
    boxes.set(i, Box{glm::vec3(static_cast<float>(i)), glm::vec3(0.5F + static_cast<float>(i))});
  Octree::Options options;
  options.root_m = Box{glm::vec3(-10), glm::vec3(10)};
  options.slots = 4;
  options.slots_per_node = 3;
  Octree tree(boxes, work_of, options);
  tree.insert(0);
  tree.insert(1);
  tree.refresh();
  const std::uint32_t chunk = tree.chunk_of(0);
  REQUIRE(tree.chunk_of(1) == chunk);
  const std::uint64_t first = tree.chunk(chunk).revision;
  boxes.set(1, Box{glm::vec3(1.25F), glm::vec3(1.75F)});
  tree.move(1);  // within its node: nothing to record, but the box follows
  tree.refresh();
  CHECK(tree.chunk(chunk).revision == first);
  CHECK(tree.chunk(chunk).content.box_m.hi.x == Approx(1.75F));
  tree.remove(1);
  const std::uint64_t second = tree.chunk(chunk).revision;
  CHECK(second > first);
  tree.clear();
  tree.insert(2);
  CHECK(tree.chunk(tree.chunk_of(2)).revision > second);
}

TEST_CASE("sums are made anew only of chunks that something moved in") {
  SlotBoxes boxes;
  boxes.resize(100);
  for (std::uint32_t i = 0; i < 100; ++i) {
    const glm::vec3 at(static_cast<float>(i % 10), static_cast<float>(i / 10), 1.0F);
    boxes.set(i, Box{at, at + 0.5F});
  }
  Octree::Options options;
  options.root_m = Box{glm::vec3(-1), glm::vec3(11)};
  options.slots = 100;
  options.slots_per_node = 200;
  Octree tree(boxes, work_of, options);
  for (std::uint32_t i = 0; i < 99; ++i) tree.insert(i);
  tree.refresh();
  CHECK(tree.refreshed().slots == 0);
  CHECK(tree.refreshed().chunks == 1);
  tree.insert(99);
  tree.refresh();
  CHECK(tree.refreshed().slots == 0);
  CHECK(tree.refreshed().chunks == 2);
  CHECK(tree.root().content.box_m.hi.y == Approx(9.5F));
  tree.remove(99);
  tree.refresh();
  CHECK(tree.refreshed().slots == 0);
  CHECK(tree.root().content.slots == 99);
  tree.move(3);
  tree.move(4);
  tree.refresh();
  CHECK(tree.refreshed().slots == 99);
}

TEST_CASE("equal boxes at one place, and boxes without extent, do not split for ever") {
  SlotBoxes boxes;
  boxes.resize(1000);
  for (std::uint32_t i = 0; i < 1000; ++i)
    boxes.set(i, Box{glm::vec3(1.0F), glm::vec3(i % 2 == 0 ? 1.0F : 1.001F)});
  Octree::Options options;
  options.root_m = Box{glm::vec3(0), glm::vec3(2.5F)};
  options.slots = 1000;
  options.slots_per_node = 5;
  Octree tree(boxes, work_of, options);
  for (std::uint32_t i = 0; i < 1000; ++i) tree.insert(i);
  tree.refresh();
  CHECK(tree.root().content.slots == 1000);
  CHECK(tree.node_count() < 8 * 17);
  for (std::uint32_t i = 0; i < 1000; ++i) CHECK(tree.chunk(tree.chunk_of(i)).slots.size() <= 5);
  Octree empty(boxes, work_of, {});
  empty.refresh();
  CHECK(empty.root().content.slots == 0);
}

TEST_CASE("a close view of test set 32 costs a tenth of the flat tests, or less") {
  const auto generated = gen::generate_test_set(32, 1);
  REQUIRE(generated);
  const std::vector<Box> bounds = object_bounds(generated->scene);
  const auto count = static_cast<std::uint32_t>(bounds.size());
  REQUIRE(count == 211'000);
  SlotBoxes boxes;
  boxes.resize(count);
  Octree::Options options;
  options.slots = count;
  for (std::uint32_t i = 0; i < count; ++i) {
    boxes.set(i, bounds[i]);
    options.root_m.add(boxes.get(i));
  }
  const Box all = options.root_m;
  // From a street crossing between the middle buildings, along the street.
  const glm::vec3 eye(all.centre().x, 1.7F, all.centre().z);
  const View view = view_from(eye, eye + glm::vec3(0, 0.5F, -10));
  const CullPlanes planes = cull_planes(frustum_of(view.clip_from_world), all);
  for (const std::uint32_t per_node : {20U, 100U}) {
    options.slots_per_node = per_node;
    Octree tree(boxes, work_of, options);
    for (std::uint32_t i = 0; i < count; ++i) tree.insert(i);
    tree.refresh();
    OctreeCounters counters;
    std::vector<std::uint32_t> chunks;
    tree.cull(planes, view.eye_m(), chunks, counters);
    CHECK(counters.tests * 10 <= count);
    CHECK(counters.tests > 10);
    std::uint64_t kept = 0, touching = 0;
    for (const std::uint32_t c : chunks) kept += tree.chunk(c).content.slots;
    for (const Box& box : bounds) touching += intersects(frustum_of(view.clip_from_world), box) ? 1 : 0;
    CHECK(kept >= touching);
    CHECK(kept < touching + count / 10);
    CHECK(touching > 1000);
    CHECK(tree.bytes() < (per_node == 100 ? 40 : 80) * std::uint64_t{count});
  }
}
