#include "timeline/curves.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "timeline/curve_walk.h"
#include "timeline/words.h"

namespace scenegen::timeline {
namespace {

constexpr std::array kCurves{CurveKind::hilbert, CurveKind::morton, CurveKind::row_prime};

struct CellBox {
  glm::uvec3 lo{std::numeric_limits<std::uint32_t>::max()};
  glm::uvec3 hi{0U};

  void add(const CellBox& b) {
    lo = glm::min(lo, b.lo);
    hi = glm::max(hi, b.hi);
  }
  [[nodiscard]] std::uint32_t longest_side() const {
    const glm::uvec3 side = hi - lo + 1U;
    return std::max({side.x, side.y, side.z});
  }
};

/// Sum over all windows of consecutive cells of the longest side of the window's box. O(1) a cell whatever
/// the window: a window is the end of one block of `window` cells and the beginning of the next (van Herk
/// 1992; Gil and Werman 1993).
class WindowBoxes {
 public:
  explicit WindowBoxes(std::size_t window) : suffix_(window), block_(window) {}

  void add(glm::uvec3 cell) {
    const CellBox box{cell, cell};
    block_[in_block_++] = box;
    prefix_.add(box);
    if (in_block_ == block_.size()) {
      count(prefix_);
      finish_block();
    } else if (blocks_ > 0) {
      CellBox both = suffix_[in_block_];
      both.add(prefix_);
      count(both);
    }
  }
  [[nodiscard]] double mean() const {
    return windows_ == 0 ? 0.0 : static_cast<double>(sum_) / static_cast<double>(windows_);
  }

 private:
  void count(const CellBox& box) {
    sum_ += box.longest_side();
    ++windows_;
  }
  void finish_block() {
    for (std::size_t i = block_.size() - 1; i-- > 0;) block_[i].add(block_[i + 1]);
    std::swap(block_, suffix_);
    prefix_ = CellBox{};
    in_block_ = 0;
    ++blocks_;
  }

  std::vector<CellBox> suffix_;  // [i]: box of the last block's cells i and after
  std::vector<CellBox> block_;
  CellBox prefix_;
  std::size_t in_block_ = 0;
  std::uint64_t blocks_ = 0, sum_ = 0, windows_ = 0;
};

}  // namespace

std::string_view name(CurveKind kind) {
  switch (kind) {
    case CurveKind::hilbert:
      return "hilbert";
    case CurveKind::morton:
      return "morton";
    case CurveKind::row_prime:
      return "row-prime";
  }
  return "";
}

std::string_view variant(CurveKind kind) {
  return kind == CurveKind::hilbert ? "skilling-2004" : name(kind);
}

Result<CurveKind> parse_curve(std::string_view text) {
  for (const CurveKind kind : kCurves) {
    if (text == name(kind)) return kind;
  }
  std::vector<std::string_view> names;
  names.reserve(std::size(kCurves));
  for (const CurveKind kind : kCurves) names.push_back(name(kind));
  return fail(ErrorKind::usage, "--curve", unknown_word("value", text, names));
}

Result<AxisOrder> parse_axis_order(std::string_view text) {
  AxisOrder order;
  std::array<bool, 3> seen{};
  std::size_t named = 0;
  std::size_t i = 0;
  while (i < text.size() && named < 3) {
    const bool reversed = text[i] == '-';
    if (reversed || text[i] == '+') ++i;
    if (i == text.size() || text[i] < 'x' || text[i] > 'z') break;
    const auto axis = static_cast<std::uint8_t>(text[i] - 'x');
    if (seen[axis]) break;
    seen[axis] = true;
    order.axis[named] = axis;
    order.reversed[named++] = reversed;
    ++i;
  }
  if (named == 3 && i == text.size()) return order;
  return fail(ErrorKind::usage, "--order",
              "unknown value " + in_quotes(text) +
                  " (x, y and z once each, the fastest first, each with + or -: +x+y+z, or +x+y-z from top "
                  "to bottom)");
}

std::string str(const AxisOrder& order) {
  std::string out;
  for (std::size_t i = 0; i < 3; ++i) {
    out += order.reversed[i] ? '-' : '+';
    out += static_cast<char>('x' + order.axis[i]);
  }
  return out;
}

std::vector<std::uint32_t> cell_ranks(CurveKind kind, glm::uvec3 cells, const AxisOrder& order) {
  const std::uint64_t count = std::uint64_t{cells.x} * cells.y * cells.z;
  assert(count <= std::numeric_limits<std::uint32_t>::max());
  std::vector<std::uint32_t> ranks(count);
  std::uint32_t rank = 0;
  walk_curve(kind, cells, order, [&](glm::uvec3 cell) {
    ranks[cell.x + std::size_t{cells.x} * (cell.y + std::size_t{cells.y} * cell.z)] = rank++;
  });
  return ranks;
}

Locality locality(CurveKind kind, glm::uvec3 cells, const AxisOrder& order, std::uint32_t window) {
  Locality out;
  const std::uint64_t count = std::uint64_t{cells.x} * cells.y * cells.z;
  if (count == 0) return out;
  WindowBoxes boxes(std::clamp<std::uint64_t>(window, 1, count));
  bool first = true;
  glm::ivec3 before{};
  walk_curve(kind, cells, order, [&](glm::uvec3 cell) {
    boxes.add(cell);
    const glm::ivec3 here(cell);
    const glm::ivec3 step = glm::abs(here - before);
    if (!first && step.x + step.y + step.z != 1) ++out.jumps;
    first = false;
    before = here;
  });
  out.mean_box_side_cells = boxes.mean();
  return out;
}

}  // namespace scenegen::timeline
