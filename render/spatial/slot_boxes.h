// World boxes of slots as a structure of arrays, for culling many at a time.
#pragma once

#include <cstddef>
#include <vector>

#include "scene/held_bytes.h"
#include "scene/transform.h"

namespace scenegen::render {

/// Boxes are grown by 8 ulp of their largest coordinate: a vertex rounded on the device may lie that far
/// outside the exact box (METHODS 6b). The arrays are padded with boxes that every plane rejects to a
/// multiple of 64, so that vector code needs no tail. 24 B a slot.
struct SlotBoxes {
  std::vector<float> lo[3];
  std::vector<float> hi[3];

  void resize(std::size_t slots);
  /// An empty box becomes one that every plane rejects.
  void set(std::size_t slot, const Box& box);
  [[nodiscard]] std::uint64_t memory_bytes() const {
    return held_bytes(lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]);
  }
  [[nodiscard]] Box get(std::size_t slot) const {
    return {{lo[0][slot], lo[1][slot], lo[2][slot]}, {hi[0][slot], hi[1][slot], hi[2][slot]}};
  }
};

}  // namespace scenegen::render
