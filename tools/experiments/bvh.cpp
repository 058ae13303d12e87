#include "tools/experiments/bvh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace scenegen::tools {
namespace {

constexpr int kBins = 16;

double area_of(const Box& b) {
  if (b.empty()) return 0;
  const glm::dvec3 s(b.size());
  return s.x * s.y + s.y * s.z + s.z * s.x;
}

/// What both builders share: the tree that grows, node by node from the root.
class Builder {
 public:
  Builder(std::span<const Box> boxes, std::span<const std::uint32_t> objects, std::uint32_t per_leaf)
      : boxes_(boxes), per_leaf_(std::max(1U, per_leaf)) {
    tree_.objects.assign(objects.begin(), objects.end());
    tree_.nodes.reserve(2 * objects.size() / per_leaf_ + 1);
  }
  FlatTree take() { return std::move(tree_); }

 protected:
  /// Objects [first, end) below one node; `split` gives the place in between. Gives the node's box.
  template <class Split>
  Box build(std::uint32_t first, std::uint32_t end, const Split& split) {
    const auto at = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.push_back({{}, 0, first, first});
    Box box;
    if (end - first <= per_leaf_) {
      for (std::uint32_t i = first; i < end; ++i) box.add(boxes_[tree_.objects[i]]);
      tree_.nodes[at].own_end = end;
    } else {
      const std::uint32_t middle = split(first, end);
      box = build(first, middle, split);
      box.add(build(middle, end, split));
    }
    tree_.nodes[at].box_m = box;
    tree_.nodes[at].end = static_cast<std::uint32_t>(tree_.nodes.size());
    return box;
  }

  std::span<const Box> boxes_;
  std::uint32_t per_leaf_;
  FlatTree tree_;
};

class SahBuilder : public Builder {
 public:
  using Builder::Builder;
  void run() {
    build(0, static_cast<std::uint32_t>(tree_.objects.size()),
          [&](std::uint32_t first, std::uint32_t end) { return split(first, end); });
  }

 private:
  struct Bin {
    Box box;
    std::uint32_t count = 0;
  };
  struct Cut {
    double cost = -1;
    int axis = 0;
    int bin = 0;  ///< the first on the far side
  };

  [[nodiscard]] static int bin_of(float centre, float lo, float scale) {
    return std::clamp(static_cast<int>((centre - lo) * scale), 0, kBins - 1);
  }

  void best_cut(const std::array<Bin, kBins>& bins, int axis, Cut& best) const {
    std::array<double, kBins> far_cost{};
    Box box;
    std::uint32_t count = 0;
    for (int b = kBins - 1; b > 0; --b) {
      box.add(bins[b].box);
      count += bins[b].count;
      far_cost[b] = area_of(box) * count;
    }
    box = {};
    count = 0;
    for (int b = 1; b < kBins; ++b) {
      box.add(bins[b - 1].box);
      count += bins[b - 1].count;
      const double cost = area_of(box) * count + far_cost[b];
      if (best.cost < 0 || cost < best.cost) best = {cost, axis, b};
    }
  }

  std::uint32_t split(std::uint32_t first, std::uint32_t end) {
    Box centres;
    for (std::uint32_t i = first; i < end; ++i) centres.add(boxes_[tree_.objects[i]].centre());
    const glm::vec3 extent = centres.size();
    Cut best;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(extent[axis] > 0)) continue;
      std::array<Bin, kBins> bins;
      const float scale = kBins / extent[axis];
      for (std::uint32_t i = first; i < end; ++i) {
        const Box& b = boxes_[tree_.objects[i]];
        Bin& bin = bins[bin_of(b.centre()[axis], centres.lo[axis], scale)];
        bin.box.add(b);
        ++bin.count;
      }
      best_cut(bins, axis, best);
    }
    if (best.cost < 0) return first + (end - first) / 2;  // all in one place
    const float lo = centres.lo[best.axis];
    const float scale = kBins / extent[best.axis];
    const auto begin = tree_.objects.begin();
    const auto middle = std::partition(begin + first, begin + end, [&](std::uint32_t o) {
      return bin_of(boxes_[o].centre()[best.axis], lo, scale) < best.bin;
    });
    const auto at = static_cast<std::uint32_t>(middle - begin);
    return at > first && at < end ? at : first + (end - first) / 2;
  }
};

/// Ten bits of `v`, two empty ones behind each.
std::uint32_t spread(std::uint32_t v) {
  v = (v | (v << 16)) & 0x030000FFU;
  v = (v | (v << 8)) & 0x0300F00FU;
  v = (v | (v << 4)) & 0x030C30C3U;
  return (v | (v << 2)) & 0x09249249U;
}

class MortonBuilder : public Builder {
 public:
  using Builder::Builder;
  void run() {
    sort();
    build(0, static_cast<std::uint32_t>(tree_.objects.size()),
          [&](std::uint32_t first, std::uint32_t end) { return split(first, end); });
  }

 private:
  /// By code, least significant digit first (three digits of 10 bits).
  void sort() {
    Box centres;
    for (const std::uint32_t o : tree_.objects) centres.add(boxes_[o].centre());
    const glm::vec3 scale = 1023.999F / glm::max(centres.size(), glm::vec3(1e-20F));
    keys_.resize(tree_.objects.size());
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      const glm::uvec3 cell((boxes_[tree_.objects[i]].centre() - centres.lo) * scale);
      keys_[i] = {spread(cell.x) | spread(cell.y) << 1U | spread(cell.z) << 2U, tree_.objects[i]};
    }
    std::vector<Key> other(keys_.size());
    for (std::uint32_t shift = 0; shift < 30; shift += 10) {
      std::array<std::uint32_t, 1025> starts{};
      for (const Key& k : keys_) ++starts[((k.code >> shift) & 1023U) + 1];
      std::partial_sum(starts.begin(), starts.end(), starts.begin());
      for (const Key& k : keys_) other[starts[(k.code >> shift) & 1023U]++] = k;
      keys_.swap(other);
    }
    for (std::size_t i = 0; i < keys_.size(); ++i) tree_.objects[i] = keys_[i].object;
  }

  std::uint32_t split(std::uint32_t first, std::uint32_t end) const {
    const std::uint32_t different = keys_[first].code ^ keys_[end - 1].code;
    if (different == 0) return first + (end - first) / 2;
    const std::uint32_t bit = std::bit_floor(different);
    const auto at = std::partition_point(keys_.begin() + first, keys_.begin() + end,
                                         [&](const Key& k) { return (k.code & bit) == 0; });
    return static_cast<std::uint32_t>(at - keys_.begin());
  }

  struct Key {
    std::uint32_t code, object;
  };
  std::vector<Key> keys_;
};

}  // namespace

FlatTree build_bvh_sah(std::span<const Box> boxes, std::span<const std::uint32_t> objects,
                       std::uint32_t per_leaf) {
  SahBuilder builder(boxes, objects, per_leaf);
  builder.run();
  return builder.take();
}

FlatTree build_lbvh(std::span<const Box> boxes, std::span<const std::uint32_t> objects,
                    std::uint32_t per_leaf) {
  MortonBuilder builder(boxes, objects, per_leaf);
  builder.run();
  return builder.take();
}

RefitBvh::RefitBvh(std::span<const Box> boxes, std::uint32_t per_leaf) : boxes_(boxes) {
  std::vector<std::uint32_t> all(boxes.size());
  std::iota(all.begin(), all.end(), 0U);
  tree_ = build_bvh_sah(boxes, all, per_leaf);
  parents_ = tree_.parents();
  leaf_of_.resize(boxes.size());
  for (std::uint32_t n = 0; n < tree_.nodes.size(); ++n) {
    tree_.nodes[n].box_m = {};
    for (std::uint32_t i = tree_.nodes[n].first; i < tree_.nodes[n].own_end; ++i)
      leaf_of_[tree_.objects[i]] = n;
  }
  there_.assign(boxes.size(), 0);
  is_touched_.assign(tree_.nodes.size(), 0);
}

void RefitBvh::set(std::uint32_t object, bool there) {
  if ((there_[object] != 0) == there) return;
  there_[object] = there ? 1 : 0;
  const std::uint32_t leaf = leaf_of_[object];
  if (is_touched_[leaf] != 0) return;
  is_touched_[leaf] = 1;
  touched_.push_back(leaf);
}

void RefitBvh::refit() {
  for (const std::uint32_t leaf : touched_) {
    is_touched_[leaf] = 0;
    Box box;
    for (std::uint32_t i = tree_.nodes[leaf].first; i < tree_.nodes[leaf].own_end; ++i) {
      if (there_[tree_.objects[i]] != 0) box.add(boxes_[tree_.objects[i]]);
    }
    std::uint32_t at = leaf;
    while (!(tree_.nodes[at].box_m == box)) {
      tree_.nodes[at].box_m = box;
      if (parents_[at] == at) break;
      at = parents_[at];
      box = tree_.nodes[at + 1].box_m;  // two children, one after the other
      box.add(tree_.nodes[tree_.nodes[at + 1].end].box_m);
    }
  }
  touched_.clear();
}

}  // namespace scenegen::tools
