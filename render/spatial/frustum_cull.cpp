#include "render/spatial/frustum_cull.h"

#include <cassert>
#include <cmath>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace scenegen::render {
namespace {

/// A plane with the arrays that hold, per axis, the coordinate of the corner farthest along its normal.
struct PlaneRow {
  const float* x;
  const float* y;
  const float* z;
  float nx, ny, nz, d, least;
};

struct PlaneRows {
  std::array<PlaneRow, 6> rows;
  std::uint32_t count = 0;
};

PlaneRows rows_of(const SlotBoxes& boxes, const CullPlanes& planes) {
  PlaneRows out;
  for (const CullPlane& p : planes.all()) {
    const auto corner = [&](int axis) { return (p.n[axis] < 0.0F ? boxes.lo[axis] : boxes.hi[axis]).data(); };
    out.rows[out.count++] = {corner(0), corner(1), corner(2), p.n.x, p.n.y, p.n.z, p.d, -p.slack};
  }
  return out;
}

std::uint64_t cull_word_scalar(const PlaneRows& planes, std::size_t first, std::uint64_t wanted) {
  std::uint64_t inside = 0;
  for (std::uint32_t i = 0; i < 64; ++i) {
    if ((wanted >> i & 1U) == 0) continue;
    bool in = true;
    for (std::uint32_t k = 0; k < planes.count && in; ++k) {
      const PlaneRow& p = planes.rows[k];
      const std::size_t at = first + i;
      in = !(((p.nx * p.x[at] + p.ny * p.y[at]) + p.nz * p.z[at]) + p.d < p.least);
    }
    inside |= static_cast<std::uint64_t>(in) << i;
  }
  return inside;
}

#if defined(__x86_64__)

std::uint64_t cull_word_sse2(const PlaneRows& planes, std::size_t first, std::uint64_t wanted) {
  std::uint64_t inside = 0;
  for (std::uint32_t i = 0; i < 64; i += 4) {
    if ((wanted >> i & 0xFU) == 0) continue;
    const std::size_t at = first + i;
    int in = 0xF;
    for (std::uint32_t k = 0; k < planes.count && in != 0; ++k) {
      const PlaneRow& p = planes.rows[k];
      __m128 t = _mm_mul_ps(_mm_set1_ps(p.nx), _mm_loadu_ps(p.x + at));
      t = _mm_add_ps(t, _mm_mul_ps(_mm_set1_ps(p.ny), _mm_loadu_ps(p.y + at)));
      t = _mm_add_ps(t, _mm_mul_ps(_mm_set1_ps(p.nz), _mm_loadu_ps(p.z + at)));
      t = _mm_add_ps(t, _mm_set1_ps(p.d));
      in &= _mm_movemask_ps(_mm_cmpnlt_ps(t, _mm_set1_ps(p.least)));
    }
    inside |= static_cast<std::uint64_t>(static_cast<unsigned>(in)) << i;
  }
  return inside & wanted;
}

// Not for the whole file: the compiler may then use AVX2 anywhere in it, also on processors without.
__attribute__((target("avx2"))) std::uint64_t cull_word_avx2(const PlaneRows& planes, std::size_t first,
                                                             std::uint64_t wanted) {
  std::uint64_t inside = 0;
  for (std::uint32_t i = 0; i < 64; i += 8) {
    if ((wanted >> i & 0xFFU) == 0) continue;
    const std::size_t at = first + i;
    int in = 0xFF;
    for (std::uint32_t k = 0; k < planes.count && in != 0; ++k) {
      const PlaneRow& p = planes.rows[k];
      __m256 t = _mm256_mul_ps(_mm256_set1_ps(p.nx), _mm256_loadu_ps(p.x + at));
      t = _mm256_add_ps(t, _mm256_mul_ps(_mm256_set1_ps(p.ny), _mm256_loadu_ps(p.y + at)));
      t = _mm256_add_ps(t, _mm256_mul_ps(_mm256_set1_ps(p.nz), _mm256_loadu_ps(p.z + at)));
      t = _mm256_add_ps(t, _mm256_set1_ps(p.d));
      in &= _mm256_movemask_ps(_mm256_cmp_ps(t, _mm256_set1_ps(p.least), _CMP_NLT_UQ));
    }
    inside |= static_cast<std::uint64_t>(static_cast<unsigned>(in)) << i;
  }
  return inside & wanted;
}

#endif

template <class Word>
void cull_words(const Word& word, const PlaneRows& rows, std::span<const std::uint64_t> wanted,
                std::span<std::uint64_t> out) {
  for (std::size_t w = 0; w < wanted.size(); ++w) out[w] = wanted[w] == 0 ? 0 : word(rows, w * 64, wanted[w]);
}

}  // namespace

CullPlanes cull_planes(const Frustum& frustum, const Box& all_m) {
  const glm::vec3 reach = all_m.empty() ? glm::vec3(0.0F) : glm::max(glm::abs(all_m.lo), glm::abs(all_m.hi));
  CullPlanes out;
  for (const glm::vec4& plane : frustum.planes) {
    const glm::vec3 n(plane);
    if (n == glm::vec3(0.0F) && plane.w >= 0.0F) continue;
    const float slack = 1e-5F * (glm::dot(glm::abs(n), reach) + std::abs(plane.w));
    out.planes[out.count++] = {n, plane.w, slack};
  }
  return out;
}

Side side_of(const CullPlane& plane, const Box& box) {
  const auto at = [&](bool farthest) {
    const auto corner = [&](int axis) {
      return (plane.n[axis] < 0.0F) == farthest ? box.lo[axis] : box.hi[axis];
    };
    return ((plane.n.x * corner(0) + plane.n.y * corner(1)) + plane.n.z * corner(2)) + plane.d;
  };
  if (at(true) < -plane.slack) return Side::outside;
  return at(false) < -plane.slack ? Side::across : Side::inside;
}

std::string_view simd_name(Simd simd) {
  return simd == Simd::avx2 ? "AVX2" : simd == Simd::sse2 ? "SSE2" : "scalar";
}

Simd best_simd() {
#if defined(__x86_64__)
  static const Simd best = __builtin_cpu_supports("avx2") != 0 ? Simd::avx2 : Simd::sse2;
  return best;
#else
  return Simd::scalar;
#endif
}

void cull_boxes(const SlotBoxes& boxes, const CullPlanes& planes, std::span<const std::uint64_t> wanted,
                std::span<std::uint64_t> out, Simd simd) {
  assert(out.size() == wanted.size() && boxes.lo[0].size() >= wanted.size() * 64);
  const PlaneRows rows = rows_of(boxes, planes);
#if defined(__x86_64__)
  if (simd == Simd::avx2 && best_simd() == Simd::avx2) return cull_words(cull_word_avx2, rows, wanted, out);
  if (simd != Simd::scalar) return cull_words(cull_word_sse2, rows, wanted, out);
#endif
  cull_words(cull_word_scalar, rows, wanted, out);
}

}  // namespace scenegen::render
