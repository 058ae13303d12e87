// Frustum culling of boxes: every instruction set gives the same bits, nothing that touches is missed.
#include "render/spatial/frustum_cull.h"

#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "scene/random.h"

using namespace scenegen;
using namespace scenegen::render;

namespace {

struct Boxes {
  SlotBoxes soa;
  std::vector<Box> exact;
  Box all_m;
};

Boxes random_boxes(std::size_t count, float world_m) {
  Boxes out;
  out.soa.resize(count);
  const Random random(11, "boxes");
  for (std::size_t i = 0; i < count; ++i) {
    const auto unit = [&](std::uint64_t k) { return random.unit(8 * i + k); };
    const glm::vec3 at = world_m * (2.0F * glm::vec3(unit(0), unit(1), unit(2)) - 1.0F);
    Box box{at, at + glm::vec3(unit(3), unit(4), unit(5)) * 3.0F};
    if (i % 97 == 5) box = Box{};
    out.soa.set(i, box);
    out.exact.push_back(box);
    if (!box.empty()) out.all_m.add(out.soa.get(i));
  }
  return out;
}

std::vector<View> views() {
  Lens wide;
  wide.yfov_rad = 1.2F;
  Lens far_plane;
  far_plane.far_m = 40.0F;
  Lens flat;
  flat.orthographic = true;
  flat.xmag_m = 20.0F;
  flat.ymag_m = 10.0F;
  flat.far_m = 60.0F;
  std::vector<View> out;
  for (const Lens& lens : {wide, far_plane, flat}) {
    for (const glm::vec3 eye : {glm::vec3(0, 0, 30), glm::vec3(5, 3, -2), glm::vec3(-80, 60, 10)})
      out.push_back(make_view(look_at(eye, {0, 0, 0}), lens, 1.5F));
  }
  return out;
}

}  // namespace

TEST_CASE("scalar, SSE2 and AVX2 give the same bits, and only wanted ones") {
  const Boxes boxes = random_boxes(10'000, 50.0F);
  const Random random(12, "wanted");
  std::vector<std::uint64_t> wanted(157);
  for (std::size_t w = 0; w < wanted.size(); ++w)
    wanted[w] = w % 5 == 0 ? 0 : random.bits(w) | random.bits(w + 999);
  wanted.back() = ~std::uint64_t{0};  // beyond the last slot: padding
  std::uint64_t inside = 0;
  for (const View& view : views()) {
    const CullPlanes planes = cull_planes(frustum_of(view.clip_from_world), boxes.all_m);
    std::vector<std::uint64_t> scalar(wanted.size()), sse2(wanted.size()), best(wanted.size());
    cull_boxes(boxes.soa, planes, wanted, scalar, Simd::scalar);
    cull_boxes(boxes.soa, planes, wanted, sse2, Simd::sse2);
    cull_boxes(boxes.soa, planes, wanted, best);
    CHECK(scalar == sse2);
    CHECK(scalar == best);
    for (std::size_t w = 0; w < wanted.size(); ++w) {
      REQUIRE((scalar[w] & ~wanted[w]) == 0);
      inside += static_cast<std::uint64_t>(__builtin_popcountll(scalar[w]));
    }
    CHECK(scalar.back() >> (10'000 % 64) == 0);  // padding is outside of everything
  }
  CHECK(inside > 1000);
  CHECK(inside < 9 * 8000);
}

TEST_CASE("what touches the frustum is never culled, empty boxes always are") {
  for (const float world_m : {2.0F, 50.0F, 3000.0F}) {
    const Boxes boxes = random_boxes(4'000, world_m);
    const std::vector<std::uint64_t> wanted(63, ~std::uint64_t{0});
    for (const View& view : views()) {
      const Frustum frustum = frustum_of(view.clip_from_world);
      const CullPlanes planes = cull_planes(frustum, boxes.all_m);
      std::vector<std::uint64_t> out(wanted.size());
      cull_boxes(boxes.soa, planes, wanted, out);
      std::size_t missed = 0, more = 0, empty = 0;
      for (std::size_t i = 0; i < boxes.exact.size(); ++i) {
        const bool kept = (out[i / 64] >> (i % 64) & 1U) != 0;
        const bool touches = intersects(frustum, boxes.exact[i]);
        empty += boxes.exact[i].empty() && kept ? 1 : 0;
        missed += touches && !kept ? 1 : 0;
        more += kept && !touches ? 1 : 0;
      }
      INFO("world " << world_m);
      CHECK(missed == 0);
      CHECK(empty == 0);
      CHECK(more <= 20);  // the slack is that of the largest box
    }
  }
}

TEST_CASE("the far plane of an infinite lens is no plane; sides are told apart") {
  Lens lens;
  const View endless = make_view(look_at({0, 0, 10}, {0, 0, 0}), lens, 1.0F);
  const Box all{glm::vec3(-20), glm::vec3(20)};
  CHECK(cull_planes(frustum_of(endless.clip_from_world), all).count == 5);
  lens.far_m = 100.0F;
  const View view = make_view(look_at({0, 0, 10}, {0, 0, 0}), lens, 1.0F);
  CHECK(cull_planes(frustum_of(view.clip_from_world), all).count == 6);
  const CullPlane right{{-1, 0, 0}, 5.0F, 1e-4F};  // x <= 5
  CHECK(side_of(right, Box{{0, 0, 0}, {4, 1, 1}}) == Side::inside);
  CHECK(side_of(right, Box{{4, 0, 0}, {6, 1, 1}}) == Side::across);
  CHECK(side_of(right, Box{{6, 0, 0}, {7, 1, 1}}) == Side::outside);
  CHECK(side_of(right, Box{{5.00005F, 0, 0}, {7, 1, 1}}) == Side::across);  // within the slack
}
