// Size formulas of the octree against values computed by hand.
#include "render/model/octree_size.h"

#include <catch2/catch.hpp>

using namespace scenegen::render::model;

TEST_CASE("(3.1) height and (3.2) nodes") {
  CHECK(octree_height(8'000, 1'000) == Approx(1.0));
  CHECK(octree_height(512'000, 1'000) == Approx(3.0));
  CHECK(octree_height(100, 1'000) == 0.0);  // log8 would be negative
  CHECK(octree_nodes(8'000, 1'000) == Approx(1 + 8));
  CHECK(octree_nodes(512'000, 1'000) == Approx(1 + 8 + 64 + 512));
  CHECK(octree_nodes(211'000, 100) == Approx(1 + 8 + 64 + 2110));
  CHECK(octree_nodes(3, 1'000) == 1.0);
  CHECK(octree_nodes(0, 5) == 1.0);
}

TEST_CASE("(3.3) memory: a secondary command buffer costs at least its minimum") {
  const CommandMemory units{100, 6900, 170};
  CHECK(octree_bytes(8'000, 1'000, units) == Approx(9.0 * (100 + 170'000)));
  CHECK(octree_bytes(40, 5, units) == Approx(9.0 * (100 + 6900)));
}

TEST_CASE("the smallest number of objects a node that fits is taken") {
  const CommandMemory units{270, 6900, 170};
  // A million objects at 5 a node: 200 000 + 37 449 nodes of 7170 B.
  CHECK(octree_bytes(1'000'000, 5, units) ==
        Approx((200'000 + 1 + 8 + 64 + 512 + 4096) * 7170.0).epsilon(1e-3));
  CHECK(objects_per_node(1'000'000, 2'000'000'000, units, 5) == 5U);
  CHECK(objects_per_node(1'000'000, 1'000'000'000, units, 5) == 10U);
  CHECK(objects_per_node(1'000'000, 400'000'000, units, 5) == 20U);
  CHECK(objects_per_node(1'000'000, 2'000'000'000, units, 100) == 100U);
  CHECK(objects_per_node(1'000'000, 190'000'000, units, 5) == 50U);
  CHECK(objects_per_node(1'000'000, 100'000'000, units, 5) == std::nullopt);
  CHECK(objects_per_node(10, 0, units, 5) == std::nullopt);
}
