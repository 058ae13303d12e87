// What every shader of the scene shares. Set 0: the frame; set 1: textures of a material.
#include "light.h"
#include "shared_types.h"

layout(set = 0, binding = 0, std140) uniform CameraBuffer { CameraBlock camera; };
layout(set = 0, binding = 1, std430) readonly buffer ObjectBuffer { ObjectRecord objects[]; };
layout(set = 0, binding = 2, std430) readonly buffer MaterialBuffer { MaterialRecord materials[]; };

layout(constant_id = 0) const int kAlphaMode = 0;  // AlphaMode: opaque, mask, blend
layout(constant_id = 1) const uint kTextureMask = 31;  // bit i: the material has texture i (kTexture…)

// Radiance of the sky in a direction; below the horizon a haze that darkens slowly downwards.
vec3 sky_radiance(vec3 direction) {
  float up = direction.y;
  vec3 sky = mix(kSkyHorizon, kSkyZenith, sqrt(clamp(up, 0.0, 1.0)));
  return mix(sky, kHaze, smoothstep(0.0, 0.55, -up));
}

// The highlights of the Khronos PBR Neutral tone mapper (Khronos 2024): colours below 0.76 stay as they are,
// brighter ones are compressed towards white.
vec3 tone_map(vec3 color) {
  const float kStart = 0.76;
  const float kDesaturation = 0.15;
  float peak = max(color.r, max(color.g, color.b));
  if (peak < kStart) return color;
  float d = 1.0 - kStart;
  float new_peak = 1.0 - d * d / (peak + d - kStart);
  color *= new_peak / peak;
  float g = 1.0 - 1.0 / (kDesaturation * (peak - new_peak) + 1.0);
  return mix(color, vec3(new_peak), g);
}
