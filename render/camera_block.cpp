#include "render/camera_block.h"

#include "render/config.h"

namespace scenegen::render {
namespace {

// The light of every picture: a sun over the viewer's left shoulder (seen from the default view), so that one
// face of a building is bright, the other lies in the blue light of the sky.
const glm::vec3 kToSun = glm::normalize(glm::vec3(-0.42F, 0.62F, 0.66F));
constexpr glm::vec3 kSunRadiance{4.9F, 4.35F, 3.6F};
constexpr glm::vec3 kSkyZenith{0.24F, 0.44F, 0.82F};
constexpr glm::vec3 kSkyHorizon{0.74F, 0.84F, 0.95F};
constexpr glm::vec3 kGround{0.36F, 0.34F, 0.31F};
constexpr glm::vec3 kHaze{0.50F, 0.60F, 0.72F};
// A real sky gives a fifth of the sun's light; more of it looks milky.
constexpr float kSkyShare = 0.62F;
constexpr float kExposure = 0.78F;

}  // namespace

CameraBlock camera_block(const View& view, const Box& scene_m, bool shadows) {
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
  c.to_sun = glm::vec4(kToSun, shadows ? 1.0F : 0.0F);
  c.sun_radiance = glm::vec4(kSunRadiance, kExposure);
  c.sky_zenith = glm::vec4(kSkyZenith, 2.0F / (scale * static_cast<float>(kShadowMapSide)));
  c.sky_horizon = glm::vec4(kSkyHorizon, 1.0F / static_cast<float>(kShadowMapSide));
  c.ground = glm::vec4(kGround, 0.0F);
  c.haze = glm::vec4(kHaze, kSkyShare);
  return c;
}

}  // namespace scenegen::render
