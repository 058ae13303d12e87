#include "render/passes/hi_z_layout.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "render/spatial/frustum_cull.h"
#include "scene/held_bytes.h"
#include "timeline/curves.h"

namespace scenegen::render {
namespace {

/// Where a slot is for the curve: boxes of nothing, or out of any float's reach, are at the origin.
glm::vec3 middle(const Box& box) {
  const glm::vec3 at = box.centre();
  const bool finite = std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z);
  return box.empty() || !finite ? glm::vec3(0.0F) : at;
}

}  // namespace

HiZCut::HiZCut(const DrawScene& scene) {
  const DrawPrimitive* last = nullptr;
  for (std::uint32_t slot = 0; slot < scene.solid_end(); ++slot) {
    const DrawPrimitive& primitive = scene.primitive(slot);
    const bool same =
        last != nullptr &&
        (last == &primitive || (last->batch == primitive.batch && last->geometry == primitive.geometry));
    if (!same) firsts.push_back(slot);
    last = &primitive;
  }
  if (!firsts.empty() && scene.solid_end() / firsts.size() < 128) block_slots = 64;
  firsts.push_back(scene.solid_end());
}

std::uint64_t HiZCut::blocks() const {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i + 1 < firsts.size(); ++i)
    sum += (firsts[i + 1] - firsts[i] + block_slots - 1) / block_slots;
  return sum;
}

HiZLayout::HiZLayout(const DrawScene& scene, std::span<const GeometryRange> ranges, bool all_mirrored)
    : mirrored(all_mirrored) {
  const HiZCut cut(scene);
  block_slots = cut.block_slots;
  slots.resize(scene.solid_end());
  std::iota(slots.begin(), slots.end(), 0U);
  block_of_slot.assign(scene.solid_end(), kHiZNone);
  for (std::size_t i = 0; i + 1 < cut.firsts.size(); ++i)
    add_group(scene, ranges, cut.firsts[i], cut.firsts[i + 1]);

  for (Run& run : runs) {
    run.mirrored = all_mirrored;
    for (std::uint32_t b = run.first; b < run.end && !run.mirrored; ++b) {
      const auto of_block = std::span(slots).subspan(blocks[b].first, blocks[b].count);
      run.mirrored = std::any_of(of_block.begin(), of_block.end(),
                                 [&](std::uint32_t slot) { return scene.mirrored(slot); });
    }
    mirrored = mirrored || run.mirrored;
    for (std::uint32_t b = run.first; b < run.end; ++b) blocks[b].mirrored = run.mirrored ? 1 : 0;
  }
}

void HiZLayout::add_group(const DrawScene& scene, std::span<const GeometryRange> ranges, std::uint32_t first,
                          std::uint32_t end) {
  const DrawPrimitive& primitive = scene.primitive(first);
  const GeometryRange& geometry = ranges[primitive.geometry.value];
  if (geometry.index_count == 0) return;
  if (end - first > block_slots) {
    std::vector<glm::vec3> middles_m;
    middles_m.reserve(end - first);
    for (std::uint32_t slot = first; slot < end; ++slot) middles_m.push_back(middle(scene.boxes().get(slot)));
    const std::vector<std::uint32_t> along = timeline::hilbert_order(middles_m);
    for (std::uint32_t i = 0; i < along.size(); ++i) slots[first + i] = first + along[i];
  }
  const auto group = static_cast<std::uint32_t>(groups.size());
  groups.push_back({glm::vec4(primitive.bounds_m.lo, 0.0F), glm::vec4(primitive.bounds_m.hi, 0.0F)});
  const std::uint32_t triangles = geometry.kind == PrimitiveKind::triangles ? geometry.index_count / 3 : 0;
  for (std::uint32_t begin = first; begin < end; begin += block_slots) {
    const auto block = static_cast<std::uint32_t>(blocks.size());
    if (runs.empty() || runs.back().batch != primitive.batch)
      runs.push_back({primitive.batch, false, block, block});
    ++runs.back().end;
    run_of_block.push_back(static_cast<std::uint32_t>(runs.size() - 1));
    blocks.push_back({begin, std::min(block_slots, end - begin), group, 0, geometry.index_count,
                      geometry.first_index, static_cast<std::uint32_t>(geometry.vertex_offset), triangles});
    for (std::uint32_t i = 0; i < blocks.back().count; ++i) block_of_slot[slots[begin + i]] = block;
  }
}

bool HiZLayout::draws_mirrored(std::uint32_t slot) const {
  if (slot >= block_of_slot.size() || block_of_slot[slot] == kHiZNone) return true;  // nothing is drawn of it
  return blocks[block_of_slot[slot]].mirrored != 0;
}

std::uint64_t HiZLayout::memory_bytes() const {
  return held_bytes(slots, blocks, groups, runs, block_of_slot, run_of_block);
}

HiZOrder::HiZOrder(const HiZLayout& layout, const DrawScene& scene)
    : layout_(layout), all_(layout.blocks.size()) {
  const std::size_t blocks = layout.blocks.size();
  boxes_.resize(blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    Box box;
    for (const std::uint32_t slot :
         std::span(layout.slots).subspan(layout.blocks[b].first, layout.blocks[b].count)) {
      const Box of_slot = scene.boxes().get(slot);
      if (!of_slot.empty()) box.add(of_slot);
    }
    boxes_.set(b, box);
    if (!box.empty()) bounds_m_.add(box);
    all_.set(b);
  }
  inside_.resize(all_.words().size());
  bucket_.resize(blocks);
  found_.resize(blocks);
  sorted_.resize(blocks);
  ranked_.resize(blocks);
  parts_.resize(layout.runs.size());
}

void HiZOrder::moved(std::uint32_t slot, const Box& box) {
  if (box.empty() || slot >= layout_.block_of_slot.size()) return;
  const std::uint32_t block = layout_.block_of_slot[slot];
  if (block == kHiZNone) return;
  Box reach = boxes_.get(block);
  const auto inside = [](const glm::vec3& a, const glm::vec3& b) {
    return a.x <= b.x && a.y <= b.y && a.z <= b.z;
  };
  if (!reach.empty() && inside(reach.lo, box.lo) && inside(box.hi, reach.hi)) return;
  if (reach.empty()) reach = Box{};  // SlotBoxes has another empty box
  reach.add(box);
  boxes_.set(block, reach);
  bounds_m_.add(reach);
}

void HiZOrder::rank(const View& view) {
  cull_boxes(boxes_, cull_planes(frustum_of(view.clip_from_world), bounds_m_), all_.words(), inside_);
  // Buckets reach from the eye to what lies farthest along the view; twice the distances, as boxes are not
  // halved.
  const glm::vec3 forward = view.forward();
  const float nearest = 2.0F * glm::dot(forward, view.eye_m());
  const glm::vec3 far_corner =
      glm::mix(bounds_m_.lo, bounds_m_.hi, glm::greaterThan(forward, glm::vec3(0.0F)));
  const float reach = 2.0F * glm::dot(forward, far_corner) - nearest;
  const float scale = reach > 0.0F ? static_cast<float>(kBuckets) / reach : 0.0F;
  next_.fill(0);
  std::fill(parts_.begin(), parts_.end(), Part{});
  count_ = 0;
  for (std::size_t w = 0; w < inside_.size(); ++w) {
    for (std::uint64_t bits = inside_[w]; bits != 0; bits &= bits - 1) {
      const auto block = static_cast<std::uint32_t>(w * 64 + static_cast<unsigned>(std::countr_zero(bits)));
      const Box box = boxes_.get(block);
      const float at = (glm::dot(forward, box.lo + box.hi) - nearest) * scale;
      // Behind the eye, and no number where boxes reach as far as floats: first.
      const auto bucket = at > 0.0F
                              ? static_cast<std::uint16_t>(std::min(at, static_cast<float>(kBuckets - 1)))
                              : std::uint16_t{0};
      found_[count_] = block;
      bucket_[count_++] = bucket;
      ++next_[bucket];
      ++parts_[layout_.run_of_block[block]].count;
    }
  }
  // Two counting sorts: by distance, then, keeping that order, by run.
  std::exclusive_scan(next_.begin(), next_.end(), next_.begin(), 0U);
  std::vector<std::uint32_t>& by_distance = parts_.size() > 1 ? sorted_ : ranked_;
  for (std::uint32_t i = 0; i < count_; ++i) by_distance[next_[bucket_[i]]++] = found_[i];
  std::uint32_t first = 0;
  for (Part& part : parts_) {
    part.first = first;
    first += part.count;
    if (parts_.size() > 1) part.count = 0;
  }
  if (parts_.size() < 2) return;
  for (std::uint32_t i = 0; i < count_; ++i) {
    Part& part = parts_[layout_.run_of_block[sorted_[i]]];
    ranked_[part.first + part.count++] = sorted_[i];
  }
}

std::uint64_t HiZOrder::memory_bytes() const {
  return boxes_.memory_bytes() + all_.memory_bytes() +
         held_bytes(inside_, bucket_, found_, sorted_, ranked_, parts_);
}

}  // namespace scenegen::render
