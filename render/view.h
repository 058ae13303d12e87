// Where a picture is taken from: camera matrices, the culling frustum, and framing a scene by itself.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "scene/scene.h"

namespace scenegen::render {

/// Perspective lens, or an orthographic one when `orthographic`.
struct Lens {
  bool orthographic = false;
  float yfov_rad = 0.6F;
  float xmag_m = 1.0F, ymag_m = 1.0F;  ///< orthographic: half width and half height
  float near_m = 0.1F;
  float far_m = 0.0F;  ///< 0: infinite (perspective only)
};

/// One point of view. Clip space is Vulkan's (y down) with reversed depth: 1 at the near plane, 0 at the far
/// plane or at infinity.
struct View {
  glm::mat4 world_from_camera{1.0F};
  glm::mat4 camera_from_world{1.0F};
  glm::mat4 clip_from_camera{1.0F};
  glm::mat4 clip_from_world{1.0F};
  Lens lens;
  float aspect = 1.0F;

  [[nodiscard]] glm::vec3 eye_m() const { return glm::vec3(world_from_camera[3]); }
  [[nodiscard]] glm::vec3 forward() const { return -glm::vec3(world_from_camera[2]); }
  /// Distance along the view direction in metres of a value of the depth buffer; infinity for 0 under an
  /// infinite perspective lens.
  [[nodiscard]] float distance_m(float depth) const;
};

/// `world_from_camera` must be rigid (looks along -Z, Y up).
[[nodiscard]] View make_view(const glm::mat4& world_from_camera, const Lens& lens, float aspect);

/// Rigid matrix of a camera at `eye_m` that looks at `target_m`; Y is up unless the view is vertical.
[[nodiscard]] glm::mat4 look_at(const glm::vec3& eye_m, const glm::vec3& target_m);

/// A camera of the scene; scale and shear in `world_from_camera` are dropped, as glTF demands.
[[nodiscard]] View view_of_camera(const Camera& camera, const glm::mat4& world_from_camera, float aspect);

/// The box that framing looks at: all objects' boxes, without flat ground under everything else.
[[nodiscard]] Box framed_bounds(std::span<const Box> object_bounds_m);

/// Three-quarter view from above, as close as the boxes allow: the smallest distance at which every box is
/// inside the picture with a margin, found in closed form per pair of opposite frustum planes.
[[nodiscard]] View frame_boxes(std::span<const Box> object_bounds_m, float aspect);

/// Planes n.p + d >= 0 inside, from a clip matrix; the far plane of an infinite lens lets everything pass.
struct Frustum {
  std::array<glm::vec4, 6> planes;
};
[[nodiscard]] Frustum frustum_of(const glm::mat4& clip_from_world);
/// Could anything in the box be inside? Conservative: never false for a box that touches the frustum.
[[nodiscard]] bool intersects(const Frustum& frustum, const Box& box);

/// Orthographic matrix (reversed depth, y down) of a sun's shadow map which covers what the view can see of
/// `scene_m`, with every caster of `scene_m` in front. `side` texels square.
[[nodiscard]] glm::mat4 shadow_clip_from_world(const View& view, const Box& scene_m, const glm::vec3& to_sun,
                                               std::uint32_t side);

}  // namespace scenegen::render
