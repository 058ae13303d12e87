#include "timeline/compare_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <utility>
#include <vector>

#include "timeline/compare_report.h"

namespace scenegen::timeline {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

bool is_surface(const Geometry& g) {
  return g.topology == Topology::triangles || g.topology == Topology::triangle_strip ||
         g.topology == Topology::triangle_fan;
}

std::vector<Triangle> triangles_of(const Geometry& g) {
  const auto drawn = static_cast<std::uint32_t>(g.drawn_vertex_count());
  const auto vertex = [&](std::uint32_t k) { return g.indices.empty() ? k : g.indices[k]; };
  std::vector<Triangle> out;
  const std::uint32_t step = g.topology == Topology::triangles ? 3 : 1;
  for (std::uint32_t k = 0; k + 2 < drawn; k += step) {
    const bool fan = g.topology == Topology::triangle_fan;
    const bool odd = g.topology == Topology::triangle_strip && k % 2 == 1;  // strips alternate their winding
    out.push_back({vertex(fan ? 0 : k), vertex(odd ? k + 2 : k + 1), vertex(odd ? k + 1 : k + 2)});
  }
  return out;
}

struct Extent {
  glm::vec3 size_m{0.0F};
  std::array<float, 2> texcoords{};
};

Extent extent_of(const Geometry& g) {
  Extent out;
  out.size_m = g.bounds().size();
  for (std::size_t set = 0; set < 2; ++set) {
    glm::vec2 lo(INFINITY), hi(-INFINITY);
    for (const glm::vec2& uv : g.texcoords[set]) {
      lo = glm::min(lo, uv);
      hi = glm::max(hi, uv);
    }
    if (!g.texcoords[set].empty()) out.texcoords[set] = std::max(hi.x - lo.x, hi.y - lo.y);
  }
  return out;
}

/// Triangles of one geometry, found by where their centre is.
class TriangleGrid {
 public:
  TriangleGrid(const Geometry& g, double cell_m)
      : geometry_(g), triangles_(triangles_of(g)), cell_m_(cell_m) {
    entries_.reserve(triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      entries_.emplace_back(key(cell_of(centre(triangles_[t]))), t);
    std::sort(entries_.begin(), entries_.end());
  }

  [[nodiscard]] const Geometry& geometry() const { return geometry_; }
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  [[nodiscard]] glm::vec3 centre(const Triangle& t) const {
    return (geometry_.positions_m[t[0]] + geometry_.positions_m[t[1]] + geometry_.positions_m[t[2]]) / 3.0F;
  }

  /// Whether accepts(triangle) holds for one whose centre is within half a cell of `at`.
  template <class Accepts>
  [[nodiscard]] bool any_near(const glm::dvec3& at, const Accepts& accepts) const {
    const glm::i64vec3 lo = cell_of(at - 0.5 * cell_m_), hi = cell_of(at + 0.5 * cell_m_);
    for (std::int64_t x = lo.x; x <= hi.x; ++x)
      for (std::int64_t y = lo.y; y <= hi.y; ++y)
        for (std::int64_t z = lo.z; z <= hi.z; ++z)
          if (any_in(key({x, y, z}), accepts)) return true;
    return false;
  }

 private:
  [[nodiscard]] glm::i64vec3 cell_of(const glm::dvec3& p) const {
    constexpr double kMost = 1e18;  // what a 64-bit integer holds
    return {glm::clamp(glm::floor(p / cell_m_), -kMost, kMost)};
  }
  /// Cells may share a key: then there are more triangles to look at, nothing else.
  static std::uint64_t key(const glm::i64vec3& c) {
    const auto part = [](std::int64_t v) { return static_cast<std::uint64_t>(v) & 0x1FFFFFU; };
    return part(c.x) << 42 | part(c.y) << 21 | part(c.z);
  }
  template <class Accepts>
  [[nodiscard]] bool any_in(std::uint64_t cell, const Accepts& accepts) const {
    auto at = std::lower_bound(entries_.begin(), entries_.end(), std::pair(cell, std::uint32_t{0}));
    for (; at != entries_.end() && at->first == cell; ++at)
      if (accepts(triangles_[at->second])) return true;
    return false;
  }

  const Geometry& geometry_;
  std::vector<Triangle> triangles_;
  double cell_m_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries_;  ///< cell, triangle
};

class SurfaceComparer {
 public:
  SurfaceComparer(const Extent& extent, const CompareOptions& options)
      : longest_m_(std::max({extent.size_m.x, extent.size_m.y, extent.size_m.z})),
        position_(options.geometry_tolerance * longest_m_),
        texcoord_{options.geometry_tolerance * extent.texcoords[0],
                  options.geometry_tolerance * extent.texcoords[1]},
        direction_(options.normal_tolerance) {}

  /// Of a grid in which any_near() finds all centres that may match.
  [[nodiscard]] double cell_m() const {
    constexpr double kRounding = 1e-5, kLeast = 1e-30;
    return std::max({2.2 * position_, kRounding * longest_m_, kLeast});
  }

  /// Number of the first triangle of `a` that `b` does not have; all of them: none.
  [[nodiscard]] std::size_t first_missing(const TriangleGrid& a, const TriangleGrid& b) const {
    std::size_t number = 0;
    for (const Triangle& t : a.triangles()) {
      const bool found = flat(a.geometry(), t) || b.any_near(a.centre(t), [&](const Triangle& candidate) {
        for (int turn = 0; turn < 3; ++turn)
          if (match(a.geometry(), t, b.geometry(), candidate, turn)) return true;
        return false;
      });
      if (!found) break;
      ++number;
    }
    return number;
  }

 private:
  template <class Vector>
  static bool near(const Vector& a, const Vector& b, float tolerance) {
    return glm::all(glm::lessThanEqual(glm::abs(a - b), Vector(tolerance)));
  }
  template <class Vector>
  static bool near(const std::vector<Vector>& a, std::uint32_t i, const std::vector<Vector>& b,
                   std::uint32_t k, float tolerance) {
    return a.empty() || near(a[i], b[k], tolerance);
  }
  /// Draws nothing, or what rounding may have made nothing.
  [[nodiscard]] bool flat(const Geometry& g, const Triangle& t) const {
    const auto& p = g.positions_m;
    return near(p[t[0]], p[t[1]], position_) || near(p[t[1]], p[t[2]], position_) ||
           near(p[t[2]], p[t[0]], position_);
  }
  [[nodiscard]] bool match(const Geometry& a, const Triangle& in_a, const Geometry& b, const Triangle& in_b,
                           int turn) const {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t i = in_a[static_cast<std::size_t>(corner)];
      const std::uint32_t k = in_b[static_cast<std::size_t>((corner + turn) % 3)];
      const bool same = near(a.positions_m, i, b.positions_m, k, position_) &&
                        near(a.normals, i, b.normals, k, direction_) &&
                        near(a.tangents, i, b.tangents, k, direction_) &&
                        near(a.colors, i, b.colors, k, direction_) &&
                        near(a.texcoords[0], i, b.texcoords[0], k, texcoord_[0]) &&
                        near(a.texcoords[1], i, b.texcoords[1], k, texcoord_[1]);
      if (!same) return false;
    }
    return true;
  }

  float longest_m_;
  float position_;
  std::array<float, 2> texcoord_;
  float direction_;
};

std::string streams_text(const Geometry& g) {
  std::string out = "positions";
  if (!g.normals.empty()) out += ", normals";
  if (!g.tangents.empty()) out += ", tangents";
  if (!g.texcoords[0].empty()) out += ", texcoords 0";
  if (!g.texcoords[1].empty()) out += ", texcoords 1";
  if (!g.colors.empty()) out += ", colors";
  return out;
}

}  // namespace

std::string surface_difference(const Geometry& a, const Geometry& b, const CompareOptions& options) {
  if (!is_surface(a) || !is_surface(b)) return a == b ? std::string() : "lines or points that differ";
  if (streams_text(a) != streams_text(b)) return a_and_b("", streams_text(a), streams_text(b));
  const SurfaceComparer comparer(extent_of(a), options);
  const TriangleGrid grid_a(a, comparer.cell_m()), grid_b(b, comparer.cell_m());
  const auto missing = [&](const TriangleGrid& from, const TriangleGrid& in, const char* only) {
    const std::size_t first = comparer.first_missing(from, in);
    if (first == from.triangles().size()) return std::string();
    return "triangle " + text(first) + " at " + vector_text(from.centre(from.triangles()[first])) + only;
  };
  std::string difference = missing(grid_a, grid_b, " only in A");
  return difference.empty() ? missing(grid_b, grid_a, " only in B") : difference;
}

}  // namespace scenegen::timeline
