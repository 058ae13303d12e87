#version 460
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"
#include "material.glsl"

layout(location = 0) in vec2 in_uv;
layout(location = 1) in vec4 in_color;
layout(location = 2) flat in uvec2 in_material_object;

layout(location = 0) out uint out_id;

void main() {
  if (kAlphaMode == 1) {
    MaterialRecord material = materials[in_material_object.x];
    if (base_color(material, in_uv, in_color).a < material.emissive.w) discard;
  }
  out_id = in_material_object.y;
}
