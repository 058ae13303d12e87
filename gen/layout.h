// One building as boxes on a grid of whole millimetres: adjacency is exact there, so that "nothing overlaps
// and nothing gapes" can be proved (tests/gen/building_test.cpp). Author's frame: x along the width, y along
// the length, z up, origin at the corner of the outer walls on the ground.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace scenegen::gen {

/// lo < hi in every axis; faces touch where numbers are equal.
struct GridBox {
  glm::ivec3 lo_mm{0}, hi_mm{0};
  friend bool operator==(const GridBox&, const GridBox&) = default;
};

enum class PartKind : std::uint8_t {
  brick,
  block,  ///< of a partition
  lintel,
  sill,
  frame,
  pane,
  door,
  step,
  slab,
  coping,
  tile,
  ridge,
  gravel,
  pavement,
};
constexpr std::size_t kPartKinds = 14;
[[nodiscard]] const char* name_of(PartKind kind);

/// In which coordinates a part's box stands.
enum class PartFrame : std::uint8_t { building, left_slope, right_slope };

struct Part {
  GridBox box;
  std::uint32_t storey = 0;  ///< floor, or one of the two below
  PartKind kind = PartKind::brick;
  PartFrame frame = PartFrame::building;
};
constexpr std::uint32_t kRoofStorey = 0xFFFFFFFE;
constexpr std::uint32_t kSiteStorey = 0xFFFFFFFF;

/// A slope of the roof: building = origin + (cos, 0, ±sin) x + (0, 1, 0) y + (∓sin, 0, cos) z; upper signs on
/// the left slope, which climbs along +x; the right one falls along +x.
struct Slope {
  glm::ivec3 origin_mm{0};
  double cosine = 1, sine = 0;
};

/// Free floor space inside the walls of a storey.
struct Room {
  GridBox box;
  std::uint32_t storey = 0;
};

struct Layout {
  std::vector<Part> parts;
  std::vector<Room> rooms;
  std::array<Slope, 2> slopes;  ///< left, right
  std::uint64_t windows = 0;
  glm::ivec3 size_mm{0};  ///< outer walls along x and y, and the highest point
};

/// Takes the parts of a layout, or only counts them; past `most_parts` it only says so, and memory stays
/// bounded.
class LayoutSink {
 public:
  enum class Mode : std::uint8_t { keep, count };
  LayoutSink(Layout& layout, std::uint64_t most_parts, Mode mode = Mode::keep)
      : layout_(layout), most_parts_(most_parts), mode_(mode) {}

  void set_storey(std::uint32_t storey) { storey_ = storey; }
  void add(PartKind kind, const GridBox& box, PartFrame frame = PartFrame::building) {
    if (++count_ > most_parts_ || mode_ == Mode::count) return;
    layout_.parts.push_back({box, storey_, kind, frame});
  }
  void add_room(const GridBox& box) {
    if (mode_ == Mode::keep) layout_.rooms.push_back({box, storey_});
  }
  void add_window() {
    if (mode_ == Mode::keep) ++layout_.windows;
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] bool overflowed() const { return count_ > most_parts_; }
  [[nodiscard]] Layout& layout() { return layout_; }

 private:
  Layout& layout_;
  std::uint64_t most_parts_;
  Mode mode_;
  std::uint32_t storey_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace scenegen::gen
