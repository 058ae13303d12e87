// Frustum culling of boxes: many at a time with SIMD, or one at a time with the planes that still matter.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "render/spatial/slot_boxes.h"
#include "render/view.h"

namespace scenegen::render {

/// A box is outside when n.p + d < -slack for its corner p farthest along n.
struct CullPlane {
  glm::vec3 n;
  float d;
  float slack;
};

/// The planes of a frustum that can reject anything (the far plane of an infinite lens cannot).
struct CullPlanes {
  std::array<CullPlane, 6> planes;
  std::uint32_t count = 0;
  [[nodiscard]] std::span<const CullPlane> all() const { return std::span(planes).first(count); }
};

/// `all_m` holds every box that will be tested: the slack for rounding follows from its size, one number a
/// plane instead of one a box (1e-5 of the largest term, some hundred times what six roundings can be off).
[[nodiscard]] CullPlanes cull_planes(const Frustum& frustum, const Box& all_m);

/// What a plane says about a box.
enum class Side : std::uint8_t { outside, across, inside };
[[nodiscard]] Side side_of(const CullPlane& plane, const Box& box);

/// Vector instructions to use. All variants do the same operations in the same order (and no fused ones), so
/// their results agree bit for bit.
enum class Simd : std::uint8_t { scalar, sse2, avx2 };
[[nodiscard]] std::string_view simd_name(Simd simd);
/// The widest that this processor has.
[[nodiscard]] Simd best_simd();

/// out[w] = the boxes 64 w + i with bit i of wanted[w] set that no plane rejects. `out` is as long as
/// `wanted`; both cover whole words of `boxes`. Words without a bit cost nothing.
void cull_boxes(const SlotBoxes& boxes, const CullPlanes& planes, std::span<const std::uint64_t> wanted,
                std::span<std::uint64_t> out, Simd simd = best_simd());

}  // namespace scenegen::render
