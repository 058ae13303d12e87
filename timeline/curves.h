// Space-filling curves over a grid of cells (D 3.4; METHODS 2; DESIGN 5).
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/result.h"

namespace scenegen::timeline {

enum class CurveKind : std::uint8_t { hilbert, morton, row_prime };
[[nodiscard]] std::string_view name(CurveKind kind);
/// Which of the curves of that name: "skilling-2004" for hilbert, else the name.
[[nodiscard]] std::string_view variant(CurveKind kind);
/// "hilbert", "morton", "row-prime"; the error names the nearest one.
[[nodiscard]] Result<CurveKind> parse_curve(std::string_view text);

/// Position of cell (x, y, z), each < 2^bits, along the Hilbert curve of order `bits` (1 … 21). Skilling
/// 2004, "Programming the Hilbert curve", AxestoTranspose with X[0..2] = x, y, z.
[[nodiscard]] std::uint64_t hilbert_key(std::uint32_t x, std::uint32_t y, std::uint32_t z, unsigned bits);
[[nodiscard]] glm::uvec3 hilbert_cell(std::uint64_t key, unsigned bits);
/// Keys of `count` cells at once, equal to hilbert_key: table-driven, the fast path for large scenes.
void hilbert_keys(const glm::uvec3* cells, std::size_t count, unsigned bits, std::uint64_t* keys);
/// Morton order of the lowest 21 bits of each coordinate, x in the lowest bit.
[[nodiscard]] std::uint64_t morton_key(std::uint32_t x, std::uint32_t y, std::uint32_t z);
/// The same for `count` cells at once (pdep where the processor has a fast one).
void morton_keys(const glm::uvec3* cells, std::size_t count, std::uint64_t* keys);

/// The order and direction in which the axes are traversed, in the author's frame (Z up): "+x+y-z" goes along
/// x fastest, then y, then z from top to bottom.
struct AxisOrder {
  std::array<std::uint8_t, 3> axis{0, 1, 2};
  std::array<bool, 3> reversed{false, false, false};  ///< by position in `axis`
};
/// A missing sign is a plus; the error says what is allowed.
[[nodiscard]] Result<AxisOrder> parse_axis_order(std::string_view text);
[[nodiscard]] std::string str(const AxisOrder& order);

/// rank[x + cells.x * (y + cells.y * z)] = position along the curve, 0 … cells.x*cells.y*cells.z - 1, dense:
/// grids that are not powers of two crop the enclosing cube's curve and renumber. O(cells) time and no memory
/// but the result. At most 2^32 - 1 cells.
[[nodiscard]] std::vector<std::uint32_t> cell_ranks(CurveKind kind, glm::uvec3 cells, const AxisOrder& order);

struct Locality {
  /// Mean longest side of the box round `window` consecutive cells (all of them, if the grid has fewer), over
  /// all such windows.
  double mean_box_side_cells = 0;
  std::uint64_t jumps = 0;  ///< consecutive cells that do not share a face
};
[[nodiscard]] Locality locality(CurveKind kind, glm::uvec3 cells, const AxisOrder& order,
                                std::uint32_t window = 512);

/// Indices of the points in the order of the Hilbert curve of order 21 over the cube on their bounding box;
/// points of one cell in ascending index. Points must be finite, and at most 2^32.
[[nodiscard]] std::vector<std::uint32_t> hilbert_order(std::span<const glm::vec3> points_m);

}  // namespace scenegen::timeline
