#include "render/strategy/draw_list.h"

#include <algorithm>
#include <bit>

namespace scenegen::render {
namespace {

void emit(const DrawScene& scene, std::size_t word, std::uint64_t bits, DrawList& out) {
  for (; bits != 0; bits &= bits - 1) {
    const auto slot = static_cast<std::uint32_t>(word * 64 + static_cast<unsigned>(std::countr_zero(bits)));
    (slot < scene.solid_end() ? out.solid : out.blended).push_back(slot);
  }
}

}  // namespace

void list_visible(const DrawScene& scene, DrawList& out) {
  out.clear();
  const auto words = scene.visible().words();
  for (std::size_t w = 0; w < words.size(); ++w) emit(scene, w, words[w], out);
}

void list_in_frustum(const DrawScene& scene, const CullPlanes& planes, DrawList& out) {
  out.clear();
  const auto words = scene.visible().words();
  out.inside.resize(words.size());
  cull_boxes(scene.boxes(), planes, words, out.inside);
  for (std::size_t w = 0; w < words.size(); ++w) {
    out.tested += static_cast<std::uint64_t>(std::popcount(words[w]));
    emit(scene, w, out.inside[w], out);
  }
}

void list_blended_in_frustum(const DrawScene& scene, const CullPlanes& planes, DrawList& out) {
  out.clear();
  const auto words = scene.visible().words();
  out.inside.assign(words.begin(), words.end());
  const std::size_t first = scene.solid_end() / 64;
  for (std::size_t w = 0; w < std::min(first, out.inside.size()); ++w) out.inside[w] = 0;
  if (first < out.inside.size()) out.inside[first] &= ~std::uint64_t{0} << (scene.solid_end() % 64);
  for (std::size_t w = first; w < words.size(); ++w)
    out.tested += static_cast<std::uint64_t>(std::popcount(out.inside[w]));
  cull_boxes(scene.boxes(), planes, out.inside, out.inside);
  for (std::size_t w = first; w < words.size(); ++w) emit(scene, w, out.inside[w], out);
}

void list_solid(const DrawScene& scene, std::span<const std::uint64_t> slots, DrawList& out) {
  for (std::size_t w = 0; w < slots.size(); ++w) emit(scene, w, slots[w], out);
}

void sort_back_to_front(const DrawScene& scene, const View& view, std::vector<std::uint32_t>& slots) {
  const glm::vec3 forward = view.forward();
  const SlotBoxes& b = scene.boxes();
  const auto depth = [&](std::uint32_t s) {
    const Box box = b.get(s);
    return glm::dot(forward, box.lo + box.hi);
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
