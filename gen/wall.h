// A wall of bricks or blocks with openings.
#pragma once

#include <vector>

#include "gen/brick_bond.h"
#include "gen/layout.h"

namespace scenegen::gen {

/// Where a wall stands: u runs along it (along x or y), d from its outer face inwards.
struct WallPlace {
  bool along_y = false;
  int face_mm = 0;         ///< y (or x, when along_y) of the outer face
  bool inwards_up = true;  ///< d grows with that coordinate
  [[nodiscard]] GridBox box(Interval u, Interval d, Interval z) const;
};

enum class OpeningKind : std::uint8_t { window, door, passage };

/// Clear opening in courses [first_course, end_course); the lintel lies in course end_course and bears on the
/// wall by `bearing_mm` on either side.
struct Opening {
  OpeningKind kind = OpeningKind::window;
  Interval u;
  int first_course = 0, end_course = 0;
};

/// One course: what it spans, and where its joints start.
struct Course {
  Interval u;
  int phase_mm = 0;
};

struct Wall {
  WallPlace place;
  PartKind kind = PartKind::brick;
  int thickness_mm = 0, brick_length_mm = 0, course_height_mm = 0;
  int bottom_mm = 0;
  int top_mm = 0;  ///< the last course is cut to end here
  int bearing_mm = 0;
  std::vector<Course> courses;
  std::vector<Opening> openings;  ///< sorted by u, lintels included they do not overlap

  [[nodiscard]] Interval course_z(int course) const;
};

/// Bricks and lintels of the wall; what fits into its openings comes from joinery.h.
void build_wall(const Wall& wall, LayoutSink& sink);

/// What fills [span] in one course beside bricks: openings, and lintels clipped to the course.
struct Filled {
  Interval u;
  bool lintel = false;
};
[[nodiscard]] std::vector<Filled> filled_in_course(const Wall& wall, int course);

}  // namespace scenegen::gen
