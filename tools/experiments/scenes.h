// Scenes of the experiments: the dissertation's public test sets, and stand-ins for its private ones.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gen/generate.h"
#include "scene/result.h"

namespace scenegen::tools {

/// Generated in the place of test sets 1 to 4, whose models are private: as many objects, and vertices within
/// 1 % (of sets that are not shrunk), in what the dissertation says of their kind: 1 a building over a large
/// area, 2 one on a building site with large planes, 3 one most objects of which are always visible, 4 a high
/// one with the most objects. Bricks, and spheres in the place of equipment; equal objects share their
/// geometry, which those of real models do not. `share` of the objects: 1 for all of them.
[[nodiscard]] Result<gen::Generated> stand_in(int set, double share, std::uint64_t seed);

/// Test set 32, or a smaller town of the same kind with `share` of its buildings.
[[nodiscard]] Result<gen::Generated> buildings_with_boxes(bool small, std::uint64_t seed);

/// Objects appear along a Hilbert curve with coherence 0.95, highlighted while they are built; one in twenty
/// is temporary and vanishes again.
[[nodiscard]] Result<void> animate_as_project(gen::Generated& generated, std::uint64_t seed);

/// `count` boxes of random size in random places, all in view; as test sets 5 to 13, whose counts are given.
[[nodiscard]] Scene random_boxes(std::uint32_t count, std::uint64_t seed);
/// Boxes in the nodes of a cubic grid of `side` a side.
[[nodiscard]] Scene box_grid(std::uint32_t side);

/// Vertices drawn, a shared mesh counted once an object.
[[nodiscard]] std::uint64_t drawn_vertices(const Scene& scene);
/// "stand-in for set 1"
[[nodiscard]] std::string stand_in_name(int set);

}  // namespace scenegen::tools
