#include <array>

#include "tools/experiments/all.h"

namespace scenegen::tools {
namespace {

constexpr std::array kExperiments{
    Experiment{
        "octree-or-bvh", "D 5.2",
        "octree against BVH-SAH and Morton LBVH: objects shown, building, updates; references by height",
        false, false, octree_or_bvh},
};

}  // namespace

std::span<const Experiment> experiments() {
  return kExperiments;
}

}  // namespace scenegen::tools
