// The Hilbert curve of curves.h as a state machine, derived at compile time from Skilling's definition.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

namespace scenegen::timeline {

/// One level of the curve: in a state, an octant (bit i = coordinate X[i]) has a digit 0 … 7 along the curve
/// and a state in which its own octants are numbered.
class HilbertStates {
 public:
  static constexpr unsigned kCount = 24;
  using Row = std::array<std::uint8_t, 8>;
  std::array<Row, kCount> digit{};    ///< [state][octant]
  std::array<Row, kCount> next{};     ///< [state][octant]
  std::array<Row, kCount> octant{};   ///< [state][digit], inverse of `digit`
  std::array<std::uint8_t, 3> start;  ///< [n]: the state that n levels of octant 0 turn into state 0

  constexpr HilbertStates();

 private:
  static constexpr unsigned kReachable = 48;  // before states that number alike are merged
  struct Reachable {
    std::array<Row, kReachable> digit{};
    std::array<Row, kReachable> next{};
  };
  static constexpr Reachable reach();
};

namespace hilbert_detail {

/// What the levels above have done to the bits below in AxestoTranspose: word i holds input word source[i],
/// complemented when complement[i]; `parity` is whether Skilling's final `t` flips the digits below.
struct Transform {
  std::array<std::uint8_t, 3> source{0, 1, 2};
  std::array<bool, 3> complement{false, false, false};
  bool parity = false;
  friend constexpr bool operator==(const Transform&, const Transform&) = default;
};

/// One turn of Skilling's loop over Q, with the Gray encoding of the bits at Q.
constexpr std::uint8_t step(Transform& t, unsigned octant) {
  std::array<bool, 3> bit{};
  for (unsigned i = 0; i < 3; ++i) bit[i] = (((octant >> t.source[i]) & 1U) != 0) != t.complement[i];
  for (unsigned i = 0; i < 3; ++i) {
    if (bit[i]) {
      t.complement[0] = !t.complement[0];  // X[0] ^= P
    } else {
      std::swap(t.source[0], t.source[i]);  // exchange the bits below Q of X[0] and X[i]
      std::swap(t.complement[0], t.complement[i]);
    }
  }
  const bool g0 = bit[0];
  const bool g1 = bit[1] != g0;
  const bool g2 = bit[2] != g1;
  const unsigned gray = (g0 ? 4U : 0U) | (g1 ? 2U : 0U) | (g2 ? 1U : 0U);
  const auto digit = static_cast<std::uint8_t>(t.parity ? gray ^ 7U : gray);
  t.parity = t.parity != g2;
  return digit;
}

}  // namespace hilbert_detail

constexpr HilbertStates::Reachable HilbertStates::reach() {
  Reachable out;
  std::array<hilbert_detail::Transform, kReachable> transform{};
  unsigned known = 1;
  for (unsigned s = 0; s < known; ++s) {
    for (unsigned octant = 0; octant < 8; ++octant) {
      hilbert_detail::Transform after = transform[s];
      out.digit[s][octant] = hilbert_detail::step(after, octant);
      unsigned to = 0;
      while (to < known && !(transform[to] == after)) ++to;
      if (to == known) transform[known++] = after;  // constant evaluation fails beyond kReachable
      out.next[s][octant] = static_cast<std::uint8_t>(to);
    }
  }
  return out;
}

// Moore's partition refinement: states are one when they give equal digits and lead to states that are one.
constexpr HilbertStates::HilbertStates() : start{} {
  const Reachable all = reach();
  std::array<std::uint8_t, kReachable> group{};
  unsigned groups = 1;
  while (true) {
    std::array<std::uint8_t, kReachable> refined{};
    std::array<unsigned, kReachable> first{};
    unsigned count = 0;
    for (unsigned s = 0; s < kReachable; ++s) {
      unsigned g = 0;
      for (; g < count; ++g) {
        bool same = group[s] == group[first[g]] && all.digit[s] == all.digit[first[g]];
        for (unsigned o = 0; same && o < 8; ++o) same = group[all.next[s][o]] == group[all.next[first[g]][o]];
        if (same) break;
      }
      if (g == count) first[count++] = s;
      refined[s] = static_cast<std::uint8_t>(g);
    }
    group = refined;
    if (count == groups) break;
    groups = count;
  }
  for (unsigned s = 0; s < kReachable; ++s) {
    for (unsigned o = 0; o < 8; ++o) {
      digit[group[s]][o] = all.digit[s][o];
      next[group[s]][o] = group[all.next[s][o]];
      octant[group[s]][all.digit[s][o]] = static_cast<std::uint8_t>(o);
    }
  }
  // Octant 0 has digit 0 in these states and turns the axes by a third: three levels of it change nothing.
  start[0] = 0;
  start[2] = next[0][0];
  start[1] = next[start[2]][0];
}

inline constexpr HilbertStates kHilbertStates;
static_assert(kHilbertStates.next[kHilbertStates.start[1]][0] == 0,
              "three levels of octant 0 are the identity");
static_assert(kHilbertStates.digit[0][0] == 0 && kHilbertStates.digit[kHilbertStates.start[1]][0] == 0 &&
              kHilbertStates.digit[kHilbertStates.start[2]][0] == 0);

}  // namespace scenegen::timeline
