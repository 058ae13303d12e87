// How many chunks of an octree changes touch, while there is no octree, or while it is not kept up to date.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <initializer_list>
#include <span>

#include "render/draw_scene.h"
#include "render/model/experience.h"
#include "timeline/player.h"

namespace scenegen::render {

/// Counts cells of a chunk's size that hold something that changed, in a sample of the changes: chunks are
/// taken to be seven tenths full, and all that is visible by timeline to lie evenly.
class ChunksTouched {
 public:
  ChunksTouched(const DrawScene& scene, std::uint32_t per_node) : scene_(scene), per_node_(per_node) {}
  /// After the scene took the changes. O(1), allocates nothing.
  [[nodiscard]] model::TouchedChunks count(const timeline::ChangeSet& changes);

 private:
  /// Changes looked at.
  static constexpr std::size_t kSampled = 128;
  using Ids = std::span<const ObjectId>;

  void set_cells();
  [[nodiscard]] std::uint64_t cell_of(ObjectId id) const;
  [[nodiscard]] double different(std::initializer_list<Ids> lists) const;

  const DrawScene& scene_;
  double per_node_;
  double per_m_ = 1;
  glm::dvec3 lo_{0};
};

}  // namespace scenegen::render
