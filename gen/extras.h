// Extra objects that stand in the rooms of a building, to load a renderer with hidden things (D 3.4).
#pragma once

#include <cstdint>
#include <vector>

#include "gen/layout.h"
#include "scene/random.h"

namespace scenegen::gen {

/// Where one extra object stands: middle of its foot, author's frame, in the building.
struct ExtraPlace {
  glm::dvec3 foot_m{0};
};

/// Slots for objects of one size on the floors of a building: as many layers as are needed, the lower one
/// full before the next begins, so that everything rests on something and nothing overlaps.
class ExtraPlacer {
 public:
  /// `count` objects on every storey of `layout`, each `size_m` (along x, y, z) scaled by scale().
  ExtraPlacer(const Layout& layout, std::uint32_t storeys, std::uint32_t count, const glm::dvec3& size_m,
              std::uint64_t seed);

  /// Common factor on the size that makes them fit; 1 when they do.
  [[nodiscard]] double scale() const { return scale_; }
  /// Places of one storey of one building, in `out` (cleared). The same for the same seed, building, storey.
  void place(std::uint64_t building, std::uint32_t storey, std::vector<ExtraPlace>& out);

 private:
  struct Slot {
    glm::dvec3 lo_m;     ///< of the cell's floor
    glm::dvec2 slack_m;  ///< how far an object may be moved in its cell
  };
  /// Slots of the lowest layer; false when `count` objects need more layers than some room is high.
  bool fit(const Layout& layout, std::uint32_t storey, double scale, std::vector<Slot>& slots) const;

  std::uint32_t storeys_, count_;
  glm::dvec3 size_m_;
  Random random_;
  double scale_ = 1;
  std::vector<std::vector<Slot>> slots_;  ///< per storey
  std::vector<std::uint32_t> order_;
};

}  // namespace scenegen::gen
