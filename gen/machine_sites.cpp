// Where cranes stand and lorries drive.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "gen/machine_shapes.h"
#include "gen/machines.h"
#include "gen/town.h"

namespace scenegen::gen {
namespace {

constexpr double kLeastSpacing = 5.2;    // pavements of 1 m, and a lorry between them
constexpr double kMastClearance = 3.2;   // a jib's foot above the roofs
constexpr double kLevel = 3.4;           // neighbours differ in height, so that jibs pass each other
constexpr double kLeastDistance = 10;    // between cranes
constexpr double kLorryPitch = 16;       // of a loop for each lorry
constexpr std::uint32_t kBlockRows = 4;  // of buildings that a loop goes round
constexpr std::size_t kMostSites = 2048;
constexpr double kMostTurn = 0.42;  // of the street's width: the radius of a corner

/// The town's streets: lines between the rows and columns of buildings, and round them.
class Streets {
 public:
  explicit Streets(const TownRecipe& recipe)
      : grid_(recipe.grid), building_m_(recipe.building_m), spacing_m_(recipe.spacing_m) {
    pitch_m_ = building_m_ + spacing_m_;
    first_m_ = -0.5 * (glm::dvec2(grid_) * pitch_m_ - spacing_m_);
  }
  /// Middle of street `line` between columns (axis 0) or rows (axis 1), 0 … grid.
  [[nodiscard]] double middle(int axis, std::uint32_t line) const {
    return first_m_[axis] - 0.5 * spacing_m_ + pitch_m_[axis] * line;
  }
  [[nodiscard]] glm::dvec2 building(std::uint32_t x, std::uint32_t y) const {
    return first_m_ + glm::dvec2(x, y) * pitch_m_ + 0.5 * building_m_;
  }
  [[nodiscard]] const glm::uvec2& grid() const { return grid_; }
  [[nodiscard]] const glm::dvec2& pitch_m() const { return pitch_m_; }
  [[nodiscard]] const glm::dvec2& building_m() const { return building_m_; }
  [[nodiscard]] double spacing_m() const { return spacing_m_; }

 private:
  glm::uvec2 grid_;
  glm::dvec2 building_m_, pitch_m_, first_m_;
  double spacing_m_;
};

/// Loops share no street: round every other column, in blocks of four rows with a free row between.
std::vector<LorryLoop> loops(const Streets& streets, float scale) {
  std::vector<LorryLoop> out;
  const double radius_m = std::min(kMostTurn * streets.spacing_m(), 5.0 * scale);
  for (std::uint32_t row = 0; row < streets.grid().y; row += kBlockRows + 1) {
    const std::uint32_t end = std::min(row + kBlockRows, streets.grid().y);
    for (std::uint32_t column = 0; column < streets.grid().x; column += 2) {
      LorryLoop loop;
      loop.lo_m = {streets.middle(0, column), streets.middle(1, row)};
      loop.hi_m = {streets.middle(0, column + 1), streets.middle(1, end)};
      loop.radius_m = radius_m;
      loop.clockwise = (column / 2 + row) % 2 != 0;
      out.push_back(loop);
    }
  }
  // Those nearest to the middle of the town first.
  std::stable_sort(out.begin(), out.end(), [](const LorryLoop& a, const LorryLoop& b) {
    const glm::dvec2 p = a.lo_m + a.hi_m, q = b.lo_m + b.hi_m;
    return glm::dot(p, p) < glm::dot(q, q);
  });
  return out;
}

std::uint64_t room_on(const LorryLoop& loop, float scale) {
  return std::max<std::uint64_t>(1,
                                 static_cast<std::uint64_t>(2.0 * loop.straight_m() / (kLorryPitch * scale)));
}

bool street_has_lorries(std::uint32_t column, std::uint32_t line, std::uint32_t rows) {
  if (column % 2 != 0) return false;
  const std::uint32_t in_block = line % (kBlockRows + 1);
  return in_block == 0 || in_block == kBlockRows || line == rows;
}

/// At most kMostSites of `count`, evenly.
std::uint64_t stride_of(std::uint64_t count, std::size_t most) {
  return (count + most - 1) / most;
}

/// Beside buildings in streets along x; outside the town when those are too few.
std::vector<glm::dvec2> crane_sites(const Streets& streets, float scale, std::uint64_t wanted) {
  std::vector<glm::dvec2> out;
  const glm::uvec2 grid = streets.grid();
  const std::uint64_t stride = stride_of(std::uint64_t{grid.x} * grid.y, kMostSites);
  std::uint64_t number = 0;
  for (std::uint32_t line = 1; line < grid.y; ++line) {
    for (std::uint32_t column = 0; column < grid.x; ++column) {
      if (street_has_lorries(column, line, grid.y) || number++ % stride != 0) continue;
      out.emplace_back(streets.building(column, 0).x, streets.middle(1, line));
    }
  }
  if (out.size() >= wanted) return out;
  const double off_m = 0.5 * streets.spacing_m() + 1.7 * scale;  // beyond the middle of the outermost street
  const std::uint64_t along = stride_of(std::uint64_t{grid.x} + grid.y, kMostSites / 2);
  for (std::uint64_t column = 0; column < grid.x; column += along) {
    const double x = streets.building(static_cast<std::uint32_t>(column), 0).x;
    out.emplace_back(x, streets.middle(1, 0) - off_m);
    out.emplace_back(x, streets.middle(1, grid.y) + off_m);
  }
  for (std::uint64_t row = 0; row < grid.y; row += along) {
    const double y = streets.building(0, static_cast<std::uint32_t>(row)).y;
    out.emplace_back(streets.middle(0, grid.x) + off_m, y);
    out.emplace_back(streets.middle(0, 0) - off_m, y);
  }
  return out;
}

/// One stands nearest to the middle; several stand as far from each other as can be (farthest-point
/// sampling), so that their jibs may be long.
std::vector<glm::dvec2> choose_sites(const std::vector<glm::dvec2>& sites, std::uint64_t wanted,
                                     double least_m) {
  std::vector<glm::dvec2> out;
  if (wanted == 0 || sites.empty()) return out;
  const auto nearer = [](const glm::dvec2& a, const glm::dvec2& b) {
    return glm::dot(a, a) < glm::dot(b, b);
  };
  out.push_back(wanted == 1 ? *std::min_element(sites.begin(), sites.end(), nearer)
                            : *std::max_element(sites.begin(), sites.end(), nearer));
  std::vector<double> free_m(sites.size(), std::numeric_limits<double>::infinity());
  while (out.size() < wanted) {
    for (std::size_t i = 0; i < sites.size(); ++i)
      free_m[i] = std::min(free_m[i], glm::distance(sites[i], out.back()));
    const auto farthest = std::max_element(free_m.begin(), free_m.end());
    if (*farthest < least_m) break;
    out.push_back(sites[static_cast<std::size_t>(farthest - free_m.begin())]);
  }
  return out;
}

std::uint64_t cranes_of(std::uint64_t machines) {
  return (machines + 2) / 3;
}

double reach(const Streets& streets, const std::vector<glm::dvec2>& sites, float scale) {
  double reach_m = 1.3 * std::max(streets.pitch_m().x, streets.pitch_m().y);
  reach_m =
      std::max(reach_m, streets.spacing_m() + 0.9 * std::max(streets.building_m().x, streets.building_m().y));
  reach_m = std::clamp(reach_m, 8.0 * scale, 50.0 * scale);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) reach_m = std::min(reach_m, glm::distance(sites[i], sites[k]) / 1.35);
  }
  return reach_m;
}

std::string metres(double value) {
  std::string text = std::to_string(std::ceil(value * 10) / 10);
  return text.substr(0, text.find('.') + 2);
}

}  // namespace

std::uint32_t MachinePlan::mast_sections(const CraneSite& crane) const {
  return static_cast<std::uint32_t>(
      std::max(1L, std::lround((crane.top_m - 0.75 * scale) / static_cast<double>(mast_section_m))));
}

Result<MachinePlan> plan_machines(const TownRecipe& recipe, std::uint32_t count, double height_m) {
  MachinePlan plan;
  if (count == 0) return plan;
  plan.scale = static_cast<float>(recipe.plan.scale);
  if (recipe.spacing_m < kLeastSpacing * plan.scale) {
    return fail(ErrorKind::usage, "--spacing",
                "lorries need streets of " + metres(kLeastSpacing * plan.scale) +
                    " m between buildings for --machines");
  }
  const Streets streets(recipe);
  std::vector<LorryLoop> all = loops(streets, plan.scale);
  std::uint64_t room = 0;
  for (const LorryLoop& loop : all) room += room_on(loop, plan.scale);
  const std::vector<glm::dvec2> sites = choose_sites(crane_sites(streets, plan.scale, cranes_of(count)),
                                                     cranes_of(count), kLeastDistance * plan.scale);
  std::uint64_t fits = count;
  while (cranes_of(fits) > sites.size() || fits - cranes_of(fits) > room) --fits;
  if (fits < count) {
    const bool lacks_sites = cranes_of(count) > sites.size();
    return fail(
        ErrorKind::usage, "--machines",
        std::to_string(count) + ": the town has room for " +
            (lacks_sites ? std::to_string(sites.size()) + " cranes" : std::to_string(room) + " lorries") +
            "; nearest " + std::to_string(fits));
  }
  std::uint64_t lorries = count - cranes_of(count);
  while (lorries > 0) {
    for (LorryLoop& loop : all) {
      if (lorries == 0 || loop.lorries == room_on(loop, plan.scale)) continue;
      ++loop.lorries;
      --lorries;
    }
  }
  std::erase_if(all, [](const LorryLoop& loop) { return loop.lorries == 0; });
  plan.loops = std::move(all);

  plan.reach_m = static_cast<float>(reach(streets, sites, plan.scale));
  const double foot_m = 0.75 * plan.scale;
  const double lowest_m = height_m + kMastClearance * plan.scale;
  const auto sections = std::clamp(std::lround((lowest_m - foot_m) / (2.2 * plan.scale)), 2L, 60L);
  plan.mast_section_m = static_cast<float>((lowest_m - foot_m) / static_cast<double>(sections));
  for (std::size_t i = 0; i < sites.size(); ++i) {
    plan.cranes.push_back({sites[i], lowest_m + kLevel * plan.scale * static_cast<double>(i % 3)});
  }
  return plan;
}

Box bounds(const MachinePlan& plan) {
  Box box;
  const auto around = [&](const glm::dvec2& at_m, double radius_m, double height_m) {
    box.add(glm::vec3(glm::dvec3(at_m.x - radius_m, 0, -at_m.y - radius_m)));
    box.add(glm::vec3(glm::dvec3(at_m.x + radius_m, height_m, -at_m.y + radius_m)));
  };
  for (const CraneSite& crane : plan.cranes)
    around(crane.at_m, 0.5 * static_cast<double>(plan.reach_m),
           crane.top_m + static_cast<double>(kCraneHeadY * plan.scale));
  for (const LorryLoop& loop : plan.loops) {
    const double half_m = static_cast<double>(kLorryWidth * plan.scale) * 0.5;
    around(loop.lo_m, half_m, 0);
    around(loop.hi_m, half_m, 0);
  }
  return box;
}

}  // namespace scenegen::gen
