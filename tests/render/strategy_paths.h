// Scenes with a camera path each, on which every strategy must draw what `brute` draws.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/render/render_support.h"

namespace scenegen::render::test {

constexpr glm::uvec2 kPathSize{320, 180};

struct PathFrame {
  double time_s = 0;
  glm::vec3 eye_m{0.0F};
  glm::vec3 target_m{0.0F};
  glm::uvec2 size = kPathSize;
};

struct Path {
  std::string name;
  Scene scene;
  std::vector<PathFrame> frames;
};

/// Six paths of `frames` frames over scenes of up to `objects` objects: a walk with fast turns, camera cuts,
/// walls that vanish, objects that appear in any order and then along a curve, moving objects, and pictures
/// that change their size.
[[nodiscard]] std::vector<Path> strategy_paths(std::size_t frames, std::size_t objects);

/// Draws a path with two frames in flight; fails on any error or validation message.
struct Run {
  std::vector<FrameResult> frames;
  std::vector<std::string> warnings;
};
[[nodiscard]] Run run_path(const Path& path, RendererOptions options);

/// How a run differs from `brute`.
struct Difference {
  std::size_t pixels = 0;
  std::size_t ties = 0;   ///< pixels where `brute` drawn forwards and backwards disagrees
  std::size_t depth = 0;  ///< pixels whose depth has other bits
  std::size_t ids = 0;    ///< pixels that are no ties with another id
  std::size_t color = 0;  ///< the same of colour, where both colours of `brute` agree
};
[[nodiscard]] Difference difference(const Run& run, const Run& brute, const Run& backwards);

}  // namespace scenegen::render::test
