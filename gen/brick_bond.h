// Running bond: where the joints of one course fall.
#pragma once

#include <vector>

namespace scenegen::gen {

/// [lo, hi) along a wall, mm.
struct Interval {
  int lo_mm = 0, hi_mm = 0;
  friend bool operator==(const Interval&, const Interval&) = default;
};

/// Appends the bricks that fill [span.lo, span.hi) exactly. Joints fall on phase + k * length; a piece
/// shorter than a quarter brick at either end is joined to its neighbour, and where both together are longer
/// than a brick they are cut into equal halves. No piece is longer than a brick.
void lay_course(Interval span, int phase_mm, int brick_length_mm, std::vector<Interval>& out);

}  // namespace scenegen::gen
