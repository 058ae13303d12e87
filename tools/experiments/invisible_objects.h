// Occlusion queries about the nodes of an octree, breadth first (D 5.3).
#pragma once

#include <vector>

#include "render/spatial/octree.h"
#include "tools/experiments/draw_stage.h"

namespace scenegen::tools {

/// What one query tells.
struct AskedNode {
  std::uint32_t node = 0;
  Box box_m;                  ///< grown
  std::uint32_t objects = 0;  ///< below the node
  bool hidden = false;
};

class NodeQueries {
 public:
  /// Draws all of the stage's scene; `stage` must be of the ids pass. Throws as Vulkan does.
  explicit NodeQueries(DrawStage& stage, std::size_t most_queries);

  /// All nodes in the frustum from the root downwards, level by level; what is below a hidden one is not
  /// asked about, nor is a node that reaches the eye (which is not hidden).
  [[nodiscard]] std::vector<AskedNode> ask_all(const render::Octree& tree);

  struct Times {
    double device_ms = 0;  ///< of the pass with the queries in it
    double ask_ms = 0;     ///< recording and submitting
    double read_ms = 0;
  };
  /// Asks again about the first `count`, of the depths that are there.
  Times time(const std::vector<AskedNode>& asked, std::size_t count);

 private:
  void draw_scene();
  StageFrame ask(const AskedNode* asked, std::size_t count);
  void read(std::size_t count);

  DrawStage& stage_;
  std::size_t most_;
  vk::raii::QueryPool pool_{nullptr};
  std::vector<std::uint32_t> samples_;
};

}  // namespace scenegen::tools
