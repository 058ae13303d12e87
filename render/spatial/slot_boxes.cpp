#include "render/spatial/slot_boxes.h"

#include <algorithm>
#include <limits>

namespace scenegen::render {
namespace {

// Not infinity: infinity times the zero of an axis-aligned plane is no number, which no plane rejects.
constexpr float kNowhere = 1e30F;

}  // namespace

void SlotBoxes::resize(std::size_t slots) {
  const std::size_t padded = (slots + 63) / 64 * 64;
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis].resize(padded, kNowhere);
    hi[axis].resize(padded, -kNowhere);
  }
}

void SlotBoxes::set(std::size_t slot, const Box& box) {
  const bool empty = box.empty();
  const glm::vec3 reach = glm::max(glm::abs(box.lo), glm::abs(box.hi));
  const float slack = 8.0F * std::numeric_limits<float>::epsilon() * std::max({reach.x, reach.y, reach.z});
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis][slot] = empty ? kNowhere : box.lo[axis] - slack;
    hi[axis][slot] = empty ? -kNowhere : box.hi[axis] + slack;
  }
}

}  // namespace scenegen::render
