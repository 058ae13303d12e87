#include "gen/wall.h"

#include <algorithm>

namespace scenegen::gen {

GridBox WallPlace::box(Interval u, Interval d, Interval z) const {
  const int across_lo = inwards_up ? face_mm + d.lo_mm : face_mm - d.hi_mm;
  const int across_hi = inwards_up ? face_mm + d.hi_mm : face_mm - d.lo_mm;
  if (along_y) return {{across_lo, u.lo_mm, z.lo_mm}, {across_hi, u.hi_mm, z.hi_mm}};
  return {{u.lo_mm, across_lo, z.lo_mm}, {u.hi_mm, across_hi, z.hi_mm}};
}

Interval Wall::course_z(int course) const {
  const int lo = bottom_mm + course * course_height_mm;
  return {lo, std::min(lo + course_height_mm, top_mm)};
}

std::vector<Filled> filled_in_course(const Wall& wall, int course) {
  const Interval span = wall.courses[static_cast<std::size_t>(course)].u;
  std::vector<Filled> out;
  for (const Opening& opening : wall.openings) {
    if (course >= opening.first_course && course < opening.end_course) out.push_back({opening.u, false});
    if (course == opening.end_course) {
      out.push_back({{std::max(span.lo_mm, opening.u.lo_mm - wall.bearing_mm),
                      std::min(span.hi_mm, opening.u.hi_mm + wall.bearing_mm)},
                     true});
    }
  }
  return out;
}

void build_wall(const Wall& wall, LayoutSink& sink) {
  const Interval through{0, wall.thickness_mm};
  std::vector<Interval> pieces;
  for (std::size_t c = 0; c < wall.courses.size() && !sink.overflowed(); ++c) {
    const Course& course = wall.courses[c];
    const Interval z = wall.course_z(static_cast<int>(c));
    pieces.clear();
    int from = course.u.lo_mm;
    for (const Filled& filled : filled_in_course(wall, static_cast<int>(c))) {
      lay_course({from, filled.u.lo_mm}, course.phase_mm, wall.brick_length_mm, pieces);
      if (filled.lintel) sink.add(PartKind::lintel, wall.place.box(filled.u, through, z));
      from = filled.u.hi_mm;
    }
    lay_course({from, course.u.hi_mm}, course.phase_mm, wall.brick_length_mm, pieces);
    for (const Interval& piece : pieces) sink.add(wall.kind, wall.place.box(piece, through, z));
  }
}

}  // namespace scenegen::gen
