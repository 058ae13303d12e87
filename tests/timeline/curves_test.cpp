#include "timeline/curves.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <map>
#include <numeric>

#include "scene/random.h"

using namespace scenegen;
using namespace scenegen::timeline;

namespace {

constexpr std::array kCurves{CurveKind::hilbert, CurveKind::morton, CurveKind::row_prime};

std::vector<AxisOrder> all_orders() {
  std::vector<AxisOrder> orders;
  std::array<std::uint8_t, 3> axis{0, 1, 2};
  do {
    for (unsigned signs = 0; signs < 8; ++signs) {
      orders.push_back({axis, {(signs & 1U) != 0, (signs & 2U) != 0, (signs & 4U) != 0}});
    }
  } while (std::next_permutation(axis.begin(), axis.end()));
  return orders;
}

AxisOrder order_of(std::string_view text) {
  const Result<AxisOrder> order = parse_axis_order(text);
  REQUIRE(order.has_value());
  return *order;
}

std::size_t index_of(glm::uvec3 cells, glm::uvec3 c) {
  return c.x + std::size_t{cells.x} * (c.y + std::size_t{cells.y} * c.z);
}

std::size_t count_of(glm::uvec3 cells) {
  return std::size_t{cells.x} * cells.y * cells.z;
}

glm::uvec3 cell_at(glm::uvec3 cells, std::size_t index) {
  return {index % cells.x, index / cells.x % cells.y, index / cells.x / cells.y};
}

/// Cells in curve order; fails unless the ranks are a permutation of 0 … count - 1.
std::vector<glm::uvec3> in_curve_order(CurveKind kind, glm::uvec3 cells, const AxisOrder& order) {
  const std::vector<std::uint32_t> ranks = cell_ranks(kind, cells, order);
  const glm::uvec3 nowhere(~0U);
  std::vector<glm::uvec3> out(count_of(cells), nowhere);
  bool bijective = ranks.size() == out.size();
  for (std::size_t i = 0; bijective && i < ranks.size(); ++i) {
    bijective = ranks[i] < out.size() && out[ranks[i]] == nowhere;
    if (bijective) out[ranks[i]] = cell_at(cells, i);
  }
  if (!bijective) FAIL(name(kind) << " is no bijection on " << cells.x << "x" << cells.y << "x" << cells.z);
  return out;
}

std::uint32_t distance(glm::uvec3 a, glm::uvec3 b) {
  const glm::ivec3 d = glm::abs(glm::ivec3(a) - glm::ivec3(b));
  return static_cast<std::uint32_t>(d.x + d.y + d.z);
}

std::uint64_t naive_morton(glm::uvec3 c) {
  std::uint64_t key = 0;
  for (int bit = 0; bit < 21; ++bit) {
    for (int axis = 0; axis < 3; ++axis) key |= std::uint64_t{(c[axis] >> bit) & 1U} << (3 * bit + axis);
  }
  return key;
}

/// What cell_ranks promises, said otherwise: sort the grid's cells by their keys in the enclosing cube.
std::vector<std::uint32_t> ranks_by_sorting(CurveKind kind, glm::uvec3 cells, const AxisOrder& order) {
  unsigned bits = 1;
  while ((1U << bits) < std::max({cells.x, cells.y, cells.z})) ++bits;
  std::vector<std::pair<std::uint64_t, std::size_t>> keyed;
  for (std::size_t i = 0; i < count_of(cells); ++i) {
    const glm::uvec3 cell = cell_at(cells, i);
    glm::uvec3 c;
    for (int j = 0; j < 3; ++j) {
      const int axis = order.axis[static_cast<std::size_t>(j)];
      c[j] = order.reversed[static_cast<std::size_t>(j)] ? cells[axis] - 1 - cell[axis] : cell[axis];
    }
    keyed.emplace_back(kind == CurveKind::hilbert ? hilbert_key(c.x, c.y, c.z, bits) : naive_morton(c), i);
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::uint32_t> ranks(keyed.size());
  for (std::size_t r = 0; r < keyed.size(); ++r) ranks[keyed[r].second] = static_cast<std::uint32_t>(r);
  return ranks;
}

}  // namespace

TEST_CASE("Hilbert keys are those of Skilling 2004", "[hilbert]") {
  CHECK(hilbert_key(5, 10, 20, 5) == 7865);
  const std::array<glm::uvec3, 8> first{
      {{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}, {1, 0, 0}}};
  for (std::uint64_t k = 0; k < 8; ++k) {
    CHECK(hilbert_cell(k, 1) == first[k]);
    CHECK(hilbert_key(first[k].x, first[k].y, first[k].z, 1) == k);
  }
}

TEST_CASE("The whole Hilbert curve of orders 1 to 6 is the known one", "[hilbert]") {
  constexpr std::array<std::uint64_t, 6> kHashes{0xf75b1f7d265f2a05, 0xd80fe25974238355, 0x806b7ef59698daf5,
                                                 0xad340c6bbbe062f5, 0xc3728dc1deec9ec5, 0xbdaca077f622d0a5};
  for (unsigned bits = 1; bits <= 6; ++bits) {
    std::uint64_t hash = fnv1a64({});
    glm::uvec3 before{};
    bool unit_steps = true;
    bool inverse = true;
    for (std::uint64_t key = 0; key < std::uint64_t{1} << (3 * bits); ++key) {
      const glm::uvec3 c = hilbert_cell(key, bits);
      const std::array bytes{static_cast<char>(c.x), static_cast<char>(c.y), static_cast<char>(c.z)};
      hash = fnv1a64({bytes.data(), bytes.size()}, hash);
      inverse = inverse && hilbert_key(c.x, c.y, c.z, bits) == key;
      unit_steps = unit_steps && (key == 0 || distance(before, c) == 1);
      before = c;
    }
    CHECK(hash == kHashes[bits - 1]);
    CHECK(inverse);
    CHECK(unit_steps);
    CHECK(before == glm::uvec3((1U << bits) - 1, 0, 0));
  }
}

TEST_CASE("Tabled Hilbert keys equal the textbook's", "[hilbert]") {
  SECTION("on every cell of orders 1 to 6") {
    for (unsigned bits = 1; bits <= 6; ++bits) {
      const glm::uvec3 cells(1U << bits);
      std::vector<glm::uvec3> all(count_of(cells));
      for (std::size_t i = 0; i < all.size(); ++i) all[i] = cell_at(cells, i);
      std::vector<std::uint64_t> keys(all.size());
      hilbert_keys(all.data(), all.size(), bits, keys.data());
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < all.size(); ++i) {
        wrong += keys[i] != hilbert_key(all[i].x, all[i].y, all[i].z, bits) ? 1 : 0;
      }
      CHECK(wrong == 0);
    }
  }
  SECTION("on random cells of every order, in batches of any length") {
    const Random random(7, "cells");
    std::uint64_t draw = 0;
    for (unsigned bits = 1; bits <= 21; ++bits) {
      for (const std::size_t count : {0U, 1U, 7U, 8U, 9U, 1023U, 1025U, 5003U}) {
        std::vector<glm::uvec3> some(count);
        for (glm::uvec3& c : some) {
          for (int i = 0; i < 3; ++i) c[i] = static_cast<std::uint32_t>(random.below(draw++, 1U << bits));
        }
        constexpr std::uint64_t kGuard = 0xfeedfacecafebeef;
        std::vector<std::uint64_t> keys(count + 1, kGuard);
        hilbert_keys(some.data(), count, bits, keys.data());
        std::size_t wrong = keys[count] == kGuard ? 0 : 1;
        for (std::size_t i = 0; i < count; ++i) {
          wrong += keys[i] != hilbert_key(some[i].x, some[i].y, some[i].z, bits) ? 1 : 0;
          wrong += hilbert_cell(keys[i], bits) != some[i] ? 1 : 0;
        }
        CHECK(wrong == 0);
      }
    }
  }
  SECTION("at the corners of the largest order") {
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const glm::uvec3 c = cell_at(glm::uvec3(2U), corner) * ((1U << 21) - 1U);
      std::uint64_t key = 0;
      hilbert_keys(&c, 1, 21, &key);
      CHECK(key == hilbert_key(c.x, c.y, c.z, 21));
      CHECK(hilbert_cell(key, 21) == c);
    }
    CHECK(hilbert_key((1U << 21) - 1, 0, 0, 21) == (std::uint64_t{1} << 63) - 1);
  }
}

TEST_CASE("Morton keys interleave bits, x lowest", "[morton]") {
  CHECK(morton_key(1, 0, 0) == 1);
  CHECK(morton_key(0, 1, 0) == 2);
  CHECK(morton_key(0, 0, 1) == 4);
  const Random random(11, "cells");
  std::vector<glm::uvec3> cells(4000);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::uint64_t bits = random.bits(i);
    cells[i] = glm::uvec3(bits, bits >> 21, bits >> 42) & ((1U << (1 + i % 21)) - 1U);
  }
  std::vector<std::uint64_t> keys(cells.size());
  morton_keys(cells.data(), cells.size(), keys.data());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    wrong += keys[i] != naive_morton(cells[i]) ? 1 : 0;
    wrong += morton_key(cells[i].x, cells[i].y, cells[i].z) != naive_morton(cells[i]) ? 1 : 0;
  }
  CHECK(wrong == 0);
}

TEST_CASE("Every curve is a bijection on every grid up to 12^3, row-prime without a jump", "[ranks]") {
  const std::vector<AxisOrder> orders = all_orders();
  std::size_t shape = 0;
  for (std::uint32_t z = 1; z <= 12; ++z) {
    for (std::uint32_t y = 1; y <= 12; ++y) {
      for (std::uint32_t x = 1; x <= 12; ++x) {
        const glm::uvec3 cells(x, y, z);
        ++shape;
        // The plain order, and four more that change from shape to shape: 1728 * 4 draws of 48 orders.
        for (std::size_t i = 0; i < 5; ++i) {
          const AxisOrder& order = orders[i == 0 ? 0 : (shape * 7 + i * 13) % orders.size()];
          for (const CurveKind kind : kCurves) {
            const std::vector<glm::uvec3> path = in_curve_order(kind, cells, order);
            if (kind == CurveKind::row_prime) {
              for (std::size_t k = 1; k < path.size(); ++k) {
                if (distance(path[k - 1], path[k]) != 1) FAIL("jump at " << k << ", order " << str(order));
              }
            } else if (i < 2 && cell_ranks(kind, cells, order) != ranks_by_sorting(kind, cells, order)) {
              FAIL(name(kind) << " is not the cropped cube's on " << x << "x" << y << "x" << z);
            }
          }
        }
      }
    }
  }
  CHECK(shape == 1728);
}

TEST_CASE("Row-prime turns back at the end of every row and layer", "[ranks]") {
  const std::vector<glm::uvec3> path = in_curve_order(CurveKind::row_prime, {3, 3, 2}, order_of("+x+y+z"));
  const std::vector<glm::uvec3> expected{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {0, 1, 0},
                                         {0, 2, 0}, {1, 2, 0}, {2, 2, 0}, {2, 2, 1}, {1, 2, 1}, {0, 2, 1},
                                         {0, 1, 1}, {1, 1, 1}, {2, 1, 1}, {2, 0, 1}, {1, 0, 1}, {0, 0, 1}};
  CHECK(path == expected);
}

TEST_CASE("The order of axes turns and mirrors the curve", "[ranks]") {
  const glm::uvec3 cells(4, 6, 5);
  SECTION("row-prime goes along the first axis named, from the end its sign says") {
    const auto path = in_curve_order(CurveKind::row_prime, cells, order_of("-y+z-x"));
    CHECK(path[0] == glm::uvec3(3, 5, 0));
    CHECK(path[1] == glm::uvec3(3, 4, 0));
    CHECK(path[6] == glm::uvec3(3, 0, 1));
    CHECK(path.back().x == 0);
  }
  SECTION("top to bottom starts in the top layer") {
    const auto path = in_curve_order(CurveKind::row_prime, cells, order_of("+x+y-z"));
    for (std::size_t i = 0; i < 24; ++i) CHECK(path[i].z == 4);
  }
  SECTION("Hilbert's X[0] and Morton's lowest bit are the first axis named") {
    CHECK(cell_ranks(CurveKind::hilbert, {32, 32, 32},
                     order_of("+z+x+y"))[index_of(glm::uvec3(32U), {10, 20, 5})] == 7865);
    CHECK(cell_ranks(CurveKind::morton, {4, 4, 4}, order_of("+y-z+x"))[index_of(glm::uvec3(4U), {2, 1, 3})] ==
          naive_morton({1, 0, 2}));
  }
}

TEST_CASE("Elongated grids cost what they hold", "[ranks]") {
  for (const CurveKind kind : kCurves) {
    for (const glm::uvec3 cells : {glm::uvec3(1024, 1, 1), glm::uvec3(1, 1024, 3), glm::uvec3(2, 1, 1023)}) {
      const auto path = in_curve_order(kind, cells, order_of("+x+y+z"));
      CHECK(path.size() == count_of(cells));
      if (kind != CurveKind::row_prime) {
        CHECK(cell_ranks(kind, cells, order_of("+x+y+z")) ==
              ranks_by_sorting(kind, cells, order_of("+x+y+z")));
      }
    }
  }
  // An enclosing cube of 2^60 cells: only a walk that leaves out what misses the grid ends.
  CHECK(cell_ranks(CurveKind::hilbert, {1, 1U << 20, 1}, order_of("+x+y+z")).size() == 1U << 20);
}

TEST_CASE("Locality of 512 consecutive cells of a 32^3 grid", "[locality]") {
  const auto side = [](CurveKind kind, std::string_view order) {
    return locality(kind, glm::uvec3(32U), order_of(order)).mean_box_side_cells;
  };
  CHECK(side(CurveKind::hilbert, "+x+y+z") == Approx(13.3).margin(0.05));
  CHECK(side(CurveKind::morton, "+x+y+z") == Approx(16.2).margin(0.05));
  CHECK(side(CurveKind::row_prime, "+x+y+z") == 32.0);
  CHECK(side(CurveKind::hilbert, "-z+x-y") == side(CurveKind::hilbert, "+x+y+z"));
  CHECK(locality(CurveKind::hilbert, glm::uvec3(32U), {}).jumps == 0);
  CHECK(locality(CurveKind::row_prime, {7, 5, 9}, {}).jumps == 0);
  CHECK(locality(CurveKind::morton, glm::uvec3(2U), {}).jumps == 3);
}

TEST_CASE("Locality equals the definition on any grid and window", "[locality]") {
  const std::vector<AxisOrder> orders = all_orders();
  std::size_t turn = 0;
  for (const glm::uvec3 cells :
       {glm::uvec3(1, 1, 1), glm::uvec3(5, 3, 4), glm::uvec3(8, 8, 8), glm::uvec3(13, 2, 6)}) {
    for (const std::uint32_t window : {1U, 2U, 3U, 7U, 59U, 60U, 61U, 512U, 0xFFFFFFFFU}) {
      for (const CurveKind kind : kCurves) {
        const AxisOrder& order = orders[turn++ % orders.size()];
        const auto path = in_curve_order(kind, cells, order);
        const std::size_t size = std::min<std::size_t>(window, path.size());
        std::uint64_t sum = 0;
        std::uint64_t jumps = 0;
        for (std::size_t i = 0; i + size <= path.size(); ++i) {
          glm::uvec3 lo = path[i];
          glm::uvec3 hi = path[i];
          for (std::size_t k = i; k < i + size; ++k) {
            lo = glm::min(lo, path[k]);
            hi = glm::max(hi, path[k]);
          }
          const glm::uvec3 sides = hi - lo + 1U;
          sum += std::max({sides.x, sides.y, sides.z});
        }
        for (std::size_t i = 1; i < path.size(); ++i) jumps += distance(path[i - 1], path[i]) != 1 ? 1 : 0;
        const Locality measured = locality(kind, cells, order, window);
        CHECK(measured.mean_box_side_cells ==
              Approx(double(sum) / double(path.size() - size + 1)).epsilon(1e-12));
        CHECK(measured.jumps == jumps);
      }
    }
  }
}

TEST_CASE("Orders of axes are read and written", "[parse]") {
  std::map<std::string, int> seen;
  for (const AxisOrder& order : all_orders()) {
    const std::string text = str(order);
    ++seen[text];
    const AxisOrder again = order_of(text);
    CHECK(again.axis == order.axis);
    CHECK(again.reversed == order.reversed);
  }
  CHECK(seen.size() == 48);
  CHECK(str(order_of("yx-z")) == "+y+x-z");
  for (const std::string_view bad : {"", "+", "+x", "+x+y", "+x+y+y", "+x+y+z+", "+x+y+zx", "++x+y+z",
                                     "+x+y+w", "x y z", "+X+Y+Z", "+x+y-", "\x01\xff"}) {
    const Result<AxisOrder> order = parse_axis_order(bad);
    REQUIRE_FALSE(order.has_value());
    CHECK(order.error().kind == ErrorKind::usage);
    CHECK(order.error().where == "--order");
    CHECK(order.error().what.find("+x+y+z") != std::string::npos);
    CHECK(order.error().what.find('\xff') == std::string::npos);
  }
}

TEST_CASE("Curves are read and written", "[parse]") {
  for (const CurveKind kind : kCurves) CHECK(parse_curve(name(kind)).value() == kind);
  CHECK(variant(CurveKind::hilbert) == "skilling-2004");
  CHECK(variant(CurveKind::morton) == "morton");
  const auto message = [](std::string_view text) { return parse_curve(text).error().str(); };
  CHECK(message("hilber") ==
        "--curve: unknown value 'hilber' (did you mean 'hilbert'? one of: hilbert, morton, row-prime)");
  CHECK(message("mortan").find("did you mean 'morton'?") != std::string::npos);
  CHECK(message("rowprime").find("did you mean 'row-prime'?") != std::string::npos);
  CHECK_FALSE(parse_curve("").has_value());
  CHECK(message(std::string(1000, 'h')).size() < 200);
}

TEST_CASE("Points are ordered along the Hilbert curve", "[order]") {
  CHECK(hilbert_order({}).empty());
  const std::vector<glm::vec3> same(5, glm::vec3(1.0F, 2.0F, 3.0F));
  CHECK(hilbert_order(same) == std::vector<std::uint32_t>{0, 1, 2, 3, 4});

  const Random random(3, "points");
  std::vector<glm::vec3> points(20000);
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Every third point stands twice: equal keys stay in ascending index.
    const std::size_t k = i % 3 == 2 ? i - 1 : i;
    points[i] = {random.unit(3 * k) * 100.0F - 50.0F, random.unit(3 * k + 1) * 40.0F, random.unit(3 * k + 2)};
  }
  glm::vec3 lo = points[0];
  glm::vec3 hi = points[0];
  for (const glm::vec3& p : points) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  const double scale = ((1U << 21) - 1) / (double(hi.x) - double(lo.x));  // x is the longest side
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const glm::uvec3 c((glm::dvec3(points[i]) - glm::dvec3(lo)) * scale);
    keyed.emplace_back(hilbert_key(c.x, c.y, c.z, 21), i);
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::uint32_t> expected;
  for (const auto& [key, index] : keyed) expected.push_back(index);
  CHECK(hilbert_order(points) == expected);
}
