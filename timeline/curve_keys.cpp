// Keys of single cells: Skilling's definition, and the fast paths that give the same numbers.
#include <algorithm>
#include <cassert>

#include "timeline/curves.h"
#include "timeline/hilbert_states.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace scenegen::timeline {
namespace {

[[maybe_unused]] constexpr unsigned kMaxBits = 21;

/// Bit i of the result is bit i/3 of `v` for i divisible by 3 ("magic bits").
constexpr std::uint64_t spread(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x001f00000000ffffULL;
  v = (v | v << 16) & 0x001f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  v = (v | v << 2) & 0x1249249249249249ULL;
  return v;
}

#if defined(__x86_64__)
__attribute__((target("bmi2"))) void morton_keys_bmi2(const glm::uvec3* cells, std::size_t count,
                                                      std::uint64_t* keys) {
  constexpr std::uint64_t kX = 0x1249249249249249ULL;
  for (std::size_t i = 0; i < count; ++i) {
    keys[i] = _pdep_u64(cells[i].x, kX) | _pdep_u64(cells[i].y, kX << 1) | _pdep_u64(cells[i].z, kX << 2);
  }
}

bool pdep_is_fast() {
  __builtin_cpu_init();
  // Zen 1 and 2 have pdep in microcode, slower than shifting.
  return __builtin_cpu_supports("bmi2") && !__builtin_cpu_is("amdfam17h");
}
#endif

/// Three levels of kHilbertStates a lookup: [state * 512 + nine bits of the Morton key] = next state * 512 +
/// nine bits of the Hilbert key. 24 KiB, so it stays in a first-level cache.
struct HilbertTable {
  std::array<std::uint16_t, std::size_t{HilbertStates::kCount} * 512> entry;

  HilbertTable() : entry{} {
    for (unsigned state = 0; state < HilbertStates::kCount; ++state) {
      for (unsigned chunk = 0; chunk < 512; ++chunk) {
        unsigned s = state;
        unsigned digits = 0;
        for (int shift = 6; shift >= 0; shift -= 3) {
          const unsigned octant = (chunk >> shift) & 7U;
          digits = digits << 3 | kHilbertStates.digit[s][octant];
          s = kHilbertStates.next[s][octant];
        }
        entry[state << 9 | chunk] = static_cast<std::uint16_t>(s << 9 | digits);
      }
    }
  }
};

/// Turns N Morton keys into Hilbert keys side by side: a lookup waits for the one before, so several chains
/// hide its latency.
template <std::size_t N>
void hilbert_from_morton(const HilbertTable& table, unsigned chunks, unsigned start, std::uint64_t* keys) {
  std::array<std::uint32_t, N> state;
  std::array<std::uint64_t, N> key{};
  state.fill(start << 9);
  for (unsigned chunk = chunks; chunk-- > 0;) {
    for (std::size_t i = 0; i < N; ++i) {
      const std::uint32_t e = table.entry[state[i] | ((keys[i] >> (9 * chunk)) & 511U)];
      key[i] = key[i] << 9 | (e & 511U);
      state[i] = e & ~511U;
    }
  }
  std::copy_n(key.begin(), N, keys);
}

}  // namespace

std::uint64_t morton_key(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

void morton_keys(const glm::uvec3* cells, std::size_t count, std::uint64_t* keys) {
#if defined(__x86_64__)
  static const bool fast = pdep_is_fast();
  if (fast) return morton_keys_bmi2(cells, count, keys);
#endif
  for (std::size_t i = 0; i < count; ++i) keys[i] = morton_key(cells[i].x, cells[i].y, cells[i].z);
}

std::uint64_t hilbert_key(std::uint32_t x, std::uint32_t y, std::uint32_t z, unsigned bits) {
  assert(bits >= 1 && bits <= kMaxBits);
  assert(((x | y | z) >> bits) == 0);
  std::array<std::uint32_t, 3> axes{x, y, z};
  const std::uint32_t top = 1U << (bits - 1);
  for (std::uint32_t q = top; q > 1; q >>= 1) {
    const std::uint32_t below = q - 1;
    for (std::uint32_t& axis : axes) {
      if ((axis & q) != 0) {
        axes[0] ^= below;
      } else {
        const std::uint32_t t = (axes[0] ^ axis) & below;
        axes[0] ^= t;
        axis ^= t;
      }
    }
  }
  axes[1] ^= axes[0];
  axes[2] ^= axes[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = top; q > 1; q >>= 1) {
    if ((axes[2] & q) != 0) t ^= q - 1;
  }
  for (std::uint32_t& axis : axes) axis ^= t;
  // The transposed index, read bit by bit from the top with X[0] first.
  return spread(axes[2]) | spread(axes[1]) << 1 | spread(axes[0]) << 2;
}

glm::uvec3 hilbert_cell(std::uint64_t key, unsigned bits) {
  assert(bits >= 1 && bits <= kMaxBits);
  assert((key >> (3 * bits)) == 0);
  glm::uvec3 cell(0U);
  unsigned state = 0;
  for (unsigned level = bits; level-- > 0;) {
    const unsigned octant = kHilbertStates.octant[state][(key >> (3 * level)) & 7U];
    cell.x |= (octant & 1U) << level;
    cell.y |= (octant >> 1 & 1U) << level;
    cell.z |= (octant >> 2) << level;
    state = kHilbertStates.next[state][octant];
  }
  return cell;
}

void hilbert_keys(const glm::uvec3* cells, std::size_t count, unsigned bits, std::uint64_t* keys) {
  assert(bits >= 1 && bits <= kMaxBits);
  static const HilbertTable table;
  // Levels in whole chunks of three: the missing ones on top are octant 0 from a start state that undoes
  // them.
  const unsigned chunks = (bits + 2) / 3;
  const unsigned start = kHilbertStates.start[3 * chunks - bits];
  constexpr std::size_t kSideBySide = 8;
  constexpr std::size_t kBlock = 1024;  // 8 KiB of Morton keys, turned while still in the cache
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t end = std::min(begin + kBlock, count);
    morton_keys(cells + begin, end - begin, keys + begin);
    std::size_t i = begin;
    for (; i + kSideBySide <= end; i += kSideBySide) {
      hilbert_from_morton<kSideBySide>(table, chunks, start, keys + i);
    }
    for (; i < end; ++i) hilbert_from_morton<1>(table, chunks, start, keys + i);
  }
}

}  // namespace scenegen::timeline
