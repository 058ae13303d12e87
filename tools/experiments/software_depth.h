// A picture of depths and objects made by the processor: what is visible, exactly and on every machine alike,
// for experiments that need no device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/view.h"
#include "scene/scene.h"

namespace scenegen::tools {

/// Pixel centres are sampled; reversed depth as in the renderer; 0 where nothing is. Triangles that reach
/// behind the near plane are left out, so what is near the eye hides less than it could.
class SoftwareDepth {
 public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  SoftwareDepth(glm::uvec2 size, const render::View& view);

  void draw(const Geometry& geometry, const glm::mat4& world_from_mesh, std::uint32_t object);
  /// Would a pixel of the box, grown by a pixel as the renderer grows what it asks about, pass the depth
  /// test? True for a box that touches the eye.
  [[nodiscard]] bool visible(const Box& box) const;

  [[nodiscard]] std::span<const float> depth() const { return depth_; }
  /// The nearest object of each pixel, rows from the top.
  [[nodiscard]] std::span<const std::uint32_t> ids() const { return ids_; }
  /// Objects that at least one pixel shows, ascending.
  [[nodiscard]] std::vector<std::uint32_t> visible_objects() const;

 private:
  struct Corner {
    glm::vec3 pixel;  ///< x, y in pixels, z depth
    bool before_near = false;
  };
  [[nodiscard]] Corner project(const glm::vec3& world_m) const;
  template <class Pixel>
  void rasterize(const Corner& a, const Corner& b, const Corner& c, const Pixel& pixel) const;

  glm::uvec2 size_;
  render::View view_;
  std::vector<float> depth_;
  std::vector<std::uint32_t> ids_;
  std::vector<Corner> corners_;  // scratch
};

/// All objects of `objects` as they are in `scene` at rest, seen from `view`.
[[nodiscard]] SoftwareDepth draw_depths(const Scene& scene, std::span<const std::uint32_t> objects,
                                        const render::View& view, glm::uvec2 size);

}  // namespace scenegen::tools
