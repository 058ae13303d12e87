// The light of every picture; compiled as C++ and as GLSL. Constants, and not part of the camera block: a
// uniform is a load and a bounds check a fragment on llvmpipe (a town of bricks took a tenth longer with
// them).
#ifndef SCENEGEN_RENDER_SHADERS_LIGHT_H
#define SCENEGEN_RENDER_SHADERS_LIGHT_H

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace scenegen::render {
using glm::vec3;
#endif

// A sun over the viewer's left shoulder (seen from the default view), so that one face of a building is
// bright, the other lies in the blue light of the sky.
const vec3 kToSun = normalize(vec3(-0.42, 0.62, 0.66));
const vec3 kSunRadiance = vec3(4.9, 4.35, 3.6);
const vec3 kSkyZenith = vec3(0.24, 0.44, 0.82);
const vec3 kSkyHorizon = vec3(0.74, 0.84, 0.95);
const vec3 kHaze = vec3(0.50, 0.60, 0.72);  // what lies far below the horizon
const vec3 kGround = vec3(0.36, 0.34, 0.31);
// A real sky gives a fifth of the sun's light; more of it looks milky.
const float kSkyShare = 0.62F;
const float kExposure = 0.78F;

#ifdef __cplusplus
}  // namespace scenegen::render
#endif
#endif
