#version 460
#extension GL_GOOGLE_include_directive : require
// Passes that do not shade: object ids with depth, and the shadow map (kShadow).
#include "vertex.glsl"

layout(constant_id = 2) const bool kShadow = false;

layout(location = 0) out vec2 out_uv;
layout(location = 1) out vec4 out_color;
layout(location = 2) flat out uvec2 out_material_object;

void main() {
  ObjectRecord record = objects[in_slot];
  vec3 world = world_position(record);
  if (kShadow) {
    gl_Position = camera.shadow_from_world * vec4(world, 1.0);
  } else {
    gl_Position = clip_position(world);
  }
  gl_PointSize = 1.0;
  out_uv = texture_place(record.material, kTextureBaseColor);
  out_color = in_color;
  out_material_object = uvec2(record.material, record.object);
}
