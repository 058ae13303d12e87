// The one vertex function: every pass and every pipeline places a vertex with exactly these operations.
#include "common.glsl"

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec4 in_normal;
layout(location = 2) in vec4 in_tangent;
layout(location = 3) in vec2 in_texcoord0;
layout(location = 4) in vec2 in_texcoord1;
layout(location = 5) in vec4 in_color;
#ifdef SLOT_LIST  // instanced draws: a list says which slot an instance is
layout(location = 6) in uint in_slot;
#else
#define in_slot gl_InstanceIndex
#endif

invariant gl_Position;

vec3 world_position(ObjectRecord record) {
  vec4 p = vec4(in_position, 1.0);
  return vec3(dot(record.world_from_object[0], p), dot(record.world_from_object[1], p),
              dot(record.world_from_object[2], p));
}

vec4 clip_position(vec3 world) { return camera.clip_from_world * vec4(world, 1.0); }

// Where a texture is sampled. Here and not in the fragment shader: llvmpipe reads zeros from storage buffers for
// helper invocations, so derivatives of anything computed from a material would be wrong at triangles' edges.
vec2 texture_place(uint material, uint which) {
  if ((kTextureMask & (1u << which)) == 0) return vec2(0.0);
  vec2 uv = (materials[material].flags.x & (kMaterialSecondTexcoord << which)) != 0 ? in_texcoord1 : in_texcoord0;
  MaterialTexture t = materials[material].textures[which];
  return vec2(dot(t.row0.xy, uv) + t.row0.z, dot(t.row1.xy, uv) + t.row1.z);
}
