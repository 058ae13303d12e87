#include "render/camera_block.h"

#include "render/config.h"
#include "render/shaders/light.h"

namespace scenegen::render {

CameraBlock camera_block(const View& view, const Box& scene_m) {
  CameraBlock c{};
  c.clip_from_world = view.clip_from_world;
  if (view.lens.orthographic) {
    c.world_from_clip[2] = glm::vec4(view.forward(), 0.0F);
    c.eye_m = glm::vec4(-view.forward(), 0.0F);
  } else {
    const float ty = 1.0F / -view.clip_from_camera[1][1];  // clip y runs down
    const float tx = 1.0F / view.clip_from_camera[0][0];
    c.world_from_clip[0] = view.world_from_camera[0] * tx;
    c.world_from_clip[1] = -view.world_from_camera[1] * ty;
    c.world_from_clip[2] = glm::vec4(view.forward(), 0.0F);
    c.eye_m = glm::vec4(view.eye_m(), 1.0F);
  }
  c.shadow_from_world = shadow_clip_from_world(view, scene_m, kToSun, kShadowMapSide);
  const float scale =
      glm::length(glm::vec3(c.shadow_from_world[0][0], c.shadow_from_world[1][0], c.shadow_from_world[2][0]));
  const auto side = static_cast<float>(kShadowMapSide);
  c.shadow_texel = glm::vec4(2.0F / (scale * side), 1.0F / side, 0.0F, 0.0F);
  return c;
}

}  // namespace scenegen::render
