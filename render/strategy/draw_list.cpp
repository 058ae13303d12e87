#include "render/strategy/draw_list.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace scenegen::render {
namespace {

void emit(const DrawScene& scene, std::size_t word, std::uint64_t bits, DrawList& out) {
  for (; bits != 0; bits &= bits - 1) {
    const auto slot = static_cast<std::uint32_t>(word * 64 + static_cast<unsigned>(std::countr_zero(bits)));
    const Batch& batch = scene.batches()[scene.primitive(slot).batch];
    (batch.state.alpha == AlphaMode::blend ? out.blended : out.solid).push_back(slot);
  }
}

struct PlaneTest {
  float n[3], a[3], d;  // plane, |n|, distance
};

/// Bits of the 64 (or fewer) boxes from `first` that no plane rejects. Written over arrays so that the
/// compiler vectorises it; the order of operations per box is fixed.
std::uint64_t boxes_inside(const SlotBoxes& boxes, std::size_t first, std::size_t count,
                           const std::vector<PlaneTest>& planes) {
  bool inside[64];
  for (std::size_t i = 0; i < count; ++i) inside[i] = true;
  const float* cx = boxes.centre[0].data() + first;
  const float* cy = boxes.centre[1].data() + first;
  const float* cz = boxes.centre[2].data() + first;
  const float* hx = boxes.half[0].data() + first;
  const float* hy = boxes.half[1].data() + first;
  const float* hz = boxes.half[2].data() + first;
  for (const PlaneTest& p : planes) {
    for (std::size_t i = 0; i < count; ++i) {
      const float at = p.n[0] * cx[i] + p.n[1] * cy[i] + p.n[2] * cz[i] + p.d;
      const float reach = p.a[0] * hx[i] + p.a[1] * hy[i] + p.a[2] * hz[i];
      const float size = p.a[0] * std::fabs(cx[i]) + p.a[1] * std::fabs(cy[i]) + p.a[2] * std::fabs(cz[i]) +
                         std::fabs(p.d) + reach;
      inside[i] = inside[i] & !(at + reach < -1e-5F * size);
    }
  }
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) bits |= static_cast<std::uint64_t>(inside[i]) << i;
  return bits;
}

}  // namespace

void list_visible(const DrawScene& scene, DrawList& out) {
  out.clear();
  const auto words = scene.visible().words();
  for (std::size_t w = 0; w < words.size(); ++w) emit(scene, w, words[w], out);
}

void list_in_frustum(const DrawScene& scene, const Frustum& frustum, DrawList& out) {
  out.clear();
  std::vector<PlaneTest> planes;
  planes.reserve(6);
  for (const glm::vec4& p : frustum.planes) {
    planes.push_back({{p.x, p.y, p.z}, {std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}, p.w});
  }
  const auto words = scene.visible().words();
  for (std::size_t w = 0; w < words.size(); ++w) {
    if (words[w] == 0) continue;
    const std::size_t count = std::min<std::size_t>(64, scene.slot_count() - w * 64);
    out.tested += static_cast<std::uint64_t>(std::popcount(words[w]));
    emit(scene, w, words[w] & boxes_inside(scene.boxes(), w * 64, count, planes), out);
  }
}

void sort_back_to_front(const DrawScene& scene, const View& view, std::vector<std::uint32_t>& slots) {
  const glm::vec3 forward = view.forward();
  const SlotBoxes& b = scene.boxes();
  const auto depth = [&](std::uint32_t s) {
    return forward.x * b.centre[0][s] + forward.y * b.centre[1][s] + forward.z * b.centre[2][s];
  };
  std::sort(slots.begin(), slots.end(), [&](std::uint32_t x, std::uint32_t y) {
    const float dx = depth(x);
    const float dy = depth(y);
    if (dx != dy) return dx > dy;
    const ObjectId ox = scene.object(x);
    const ObjectId oy = scene.object(y);
    return ox != oy ? ox < oy : x < y;
  });
}

}  // namespace scenegen::render
