#include "gen/brick_bond.h"

namespace scenegen::gen {
namespace {

int floor_div(int a, int b) {
  const int q = a / b;
  return a % b < 0 ? q - 1 : q;
}

/// Moves or drops the joint between a short end piece and its neighbour.
void mend(Interval& end_piece, Interval& neighbour, int length, bool end_is_first, bool& joined) {
  const int lo = end_is_first ? end_piece.lo_mm : neighbour.lo_mm;
  const int hi = end_is_first ? neighbour.hi_mm : end_piece.hi_mm;
  joined = hi - lo <= length;
  const int joint = lo + (hi - lo) / 2;
  Interval& first = end_is_first ? end_piece : neighbour;
  Interval& second = end_is_first ? neighbour : end_piece;
  if (joined) {
    neighbour = {lo, hi};
  } else {
    first = {lo, joint};
    second = {joint, hi};
  }
}

}  // namespace

void lay_course(Interval span, int phase_mm, int brick_length_mm, std::vector<Interval>& out) {
  if (span.lo_mm >= span.hi_mm) return;
  const std::size_t begin = out.size();
  int lo = span.lo_mm;
  int joint = phase_mm + (floor_div(lo - phase_mm, brick_length_mm) + 1) * brick_length_mm;
  for (; joint < span.hi_mm; joint += brick_length_mm) {
    out.push_back({lo, joint});
    lo = joint;
  }
  out.push_back({lo, span.hi_mm});

  const int shortest = brick_length_mm / 4;
  const auto is_short = [&](const Interval& piece) { return piece.hi_mm - piece.lo_mm < shortest; };
  bool joined = false;
  if (out.size() - begin >= 2 && is_short(out[begin])) {
    mend(out[begin], out[begin + 1], brick_length_mm, true, joined);
    if (joined) out.erase(out.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  if (out.size() - begin >= 2 && is_short(out.back())) {
    mend(out.back(), out[out.size() - 2], brick_length_mm, false, joined);
    if (joined) out.pop_back();
  }
}

}  // namespace scenegen::gen
