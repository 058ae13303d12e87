#include "tools/experiments/cell_octree.h"

#include <algorithm>
#include <numeric>

namespace scenegen::tools {
namespace {

class CellBuilder {
 public:
  CellBuilder(std::span<const Box> boxes, References references, std::uint64_t most)
      : boxes_(boxes), references_(references), most_(most) {}

  /// Objects that touch the cell (multiple) or are inside it (single).
  void build(const Box& cell, const std::vector<std::uint32_t>& objects, std::uint32_t levels_below) {
    if (objects.empty() || full()) return;
    const auto at = static_cast<std::uint32_t>(tree_.nodes.size());
    const auto first = static_cast<std::uint32_t>(tree_.objects.size());
    Box box;
    for (const std::uint32_t o : objects) box.add(boxes_[o]);
    if (references_ == References::multiple) {
      // What reaches out of the cell is in the next one too: this one is asked for its own part.
      box.lo = glm::max(box.lo, cell.lo);
      box.hi = glm::min(box.hi, cell.hi);
    }
    tree_.nodes.push_back({box, 0, first, first});
    if (levels_below == 0) {
      tree_.objects.insert(tree_.objects.end(), objects.begin(), objects.end());
      tree_.nodes[at].own_end = static_cast<std::uint32_t>(tree_.objects.size());
    } else {
      divide(cell, objects, at, levels_below - 1);
    }
    tree_.nodes[at].end = static_cast<std::uint32_t>(tree_.nodes.size());
  }
  [[nodiscard]] bool full() const { return tree_.objects.size() > most_; }
  FlatTree take() { return std::move(tree_); }

 private:
  void divide(const Box& cell, const std::vector<std::uint32_t>& objects, std::uint32_t at,
              std::uint32_t levels_below) {
    const glm::vec3 middle = cell.centre();
    std::vector<std::uint32_t> below[8];
    for (const std::uint32_t o : objects) {
      const Box& b = boxes_[o];
      const glm::bvec3 near = glm::lessThan(b.lo, middle);  // reaches into the near half
      const glm::bvec3 far = glm::greaterThanEqual(b.hi, middle);
      const bool crosses = (near.x && far.x) || (near.y && far.y) || (near.z && far.z);
      if (references_ == References::single && crosses) {
        tree_.objects.push_back(o);
        continue;
      }
      for (int k = 0; k < 8; ++k) {
        if (((k & 1) != 0 ? far.x : near.x) && ((k & 2) != 0 ? far.y : near.y) &&
            ((k & 4) != 0 ? far.z : near.z))
          below[k].push_back(o);
      }
    }
    tree_.nodes[at].own_end = static_cast<std::uint32_t>(tree_.objects.size());
    for (int k = 0; k < 8; ++k) {
      const glm::bvec3 far((k & 1) != 0, (k & 2) != 0, (k & 4) != 0);
      const Box child{glm::mix(cell.lo, middle, far), glm::mix(middle, cell.hi, far)};
      build(child, below[k], levels_below);
    }
  }

  std::span<const Box> boxes_;
  References references_;
  std::uint64_t most_;
  FlatTree tree_;
};

}  // namespace

std::optional<FlatTree> build_cell_octree(std::span<const Box> boxes, std::uint32_t height,
                                          References references, std::uint64_t most_references) {
  std::vector<std::uint32_t> objects(boxes.size());
  std::iota(objects.begin(), objects.end(), 0U);
  Box all;
  for (const Box& b : boxes) all.add(b);
  const float half = 0.5F * std::max({all.size().x, all.size().y, all.size().z, 1e-6F});
  const Box cube{all.centre() - half, all.centre() + half};
  CellBuilder builder(boxes, references, most_references);
  builder.build(cube, objects, height);
  if (builder.full()) return std::nullopt;
  return builder.take();
}

}  // namespace scenegen::tools
