#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

layout(location = 0) in vec2 in_clip;
layout(location = 0) out vec4 out_color;

void main() {
  vec3 direction = normalize(mat3(camera.world_from_clip) * vec3(in_clip, 1.0));
  out_color = vec4(tone_map(sky_radiance(direction) * kExposure), 1.0);
}
