#include <array>

#include "tools/experiments/all.h"

namespace scenegen::tools {
namespace {

constexpr std::array kExperiments{
    Experiment{
        "octree-or-bvh", "D 5.2",
        "octree against BVH-SAH and Morton LBVH: objects shown, building, updates; references by height",
        false, false, octree_or_bvh},
    Experiment{"adaptive-animation", "D 5.6",
               "three ways of drawing while an animation plays, stages at its end, frame time by coherence",
               true, true, adaptive_animation},
};

}  // namespace

std::span<const Experiment> experiments() {
  return kExperiments;
}

}  // namespace scenegen::tools
