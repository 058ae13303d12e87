#include <array>

#include "tools/experiments/all.h"

namespace scenegen::tools {
namespace {

constexpr std::array kExperiments{
    Experiment{
        "octree-or-bvh", "D 5.2",
        "octree against BVH-SAH and Morton LBVH: objects shown, building, updates; references by height",
        false, false, octree_or_bvh},
    Experiment{"invisible-objects", "D 5.3",
               "how many objects a number of occlusion queries finds hidden, and what it takes", true, false,
               invisible_objects},
    Experiment{"recording", "D 5.4",
               "commands recorded for every object or kept, one or 1000 a buffer: time and memory; indirect "
               "draws culled "
               "by the device",
               true, false, recording},
    Experiment{"model-accuracy", "D 5.5",
               "predicted against measured frame times of the public test sets in four ways of drawing", true,
               true, model_accuracy},
    Experiment{"adaptive-animation", "D 5.6",
               "three ways of drawing while an animation plays, stages at its end, frame time by coherence",
               true, true, adaptive_animation},
    Experiment{"merged-batch", "D 5.7",
               "a still scene and an animation against a renderer that merges meshes, and merges again on "
               "each change",
               true, true, merged_batch},
};

}  // namespace

std::span<const Experiment> experiments() {
  return kExperiments;
}

}  // namespace scenegen::tools
