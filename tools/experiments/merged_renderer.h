// A renderer that optimizes for scenes that stand still (D 5.7): all that is visible is merged into one mesh
// a material, drawn by one kept command buffer, and merged again when anything changes. Experiment code.
#pragma once

#include <memory>
#include <vector>

#include "render/draw_geometry.h"
#include "tools/experiments/draw_stage.h"

namespace scenegen::tools {

struct MergedFrame {
  double merge_ms = 0;  ///< 0: nothing had changed
  StageFrame drawing;
  [[nodiscard]] double whole_ms() const { return merge_ms + drawing.whole_ms(); }
};

/// One frame in flight: what is drawn from is written again.
class MergedRenderer {
 public:
  /// `scene` must outlive it.
  [[nodiscard]] static Result<std::unique_ptr<MergedRenderer>> make(const ExperimentContext& context,
                                                                    const Scene& scene,
                                                                    const render::View& view);

  /// The state of `player`; what was merged is drawn again when `changed` is false.
  [[nodiscard]] Result<MergedFrame> frame(const timeline::Player& player, bool changed);

  [[nodiscard]] DrawStage& stage() { return *stage_; }
  [[nodiscard]] std::uint64_t vertices() const { return vertices_; }
  [[nodiscard]] std::size_t draws() const { return draws_.size(); }
  /// Device memory for geometry, B.
  [[nodiscard]] std::uint64_t geometry_bytes() const {
    return positions_.bytes + attributes_.bytes + indices_.bytes;
  }

 private:
  MergedRenderer(const Scene& scene) : scene_(scene) {}
  struct Piece {             // a primitive of a visible object
    std::uint32_t slot = 0;  // of the stage: what it is drawn with
    std::uint32_t geometry = 0;
    std::uint32_t first_vertex = 0, first_index = 0;
    glm::mat4 world_from_object{1.0F};
  };
  struct Draw {
    std::uint32_t slot = 0, first_index = 0, index_count = 0;
  };
  void merge(const timeline::Player& player);
  void gather(const timeline::Player& player);
  void lay_out();
  void reserve();
  void write_vertices();
  void write_indices();
  template <class T, class Write>
  void upload(const render::vkr::Buffer& to, std::uint32_t Piece::*first, std::uint64_t count,
              const Write& write);
  void record();

  const Scene& scene_;
  std::unique_ptr<DrawStage> stage_;  // a scene of one object a material, whose records stand for all
  std::vector<render::DrawGeometry> geometries_;
  std::vector<std::uint32_t> slot_of_material_;
  std::vector<Piece> pieces_;
  std::vector<Draw> draws_;
  std::uint64_t vertices_ = 0, indices_count_ = 0;
  render::vkr::Buffer positions_, attributes_, indices_, upload_;
  vk::raii::CommandPool pool_{nullptr};
  vk::raii::CommandBuffer commands_{nullptr};
};

}  // namespace scenegen::tools
