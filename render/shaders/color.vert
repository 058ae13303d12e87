#version 460
#extension GL_GOOGLE_include_directive : require
#include "vertex.glsl"

layout(location = 0) out vec3 out_world;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec4 out_tangent;
layout(location = 3) out vec4 out_color;  // base colour and that of the vertex
// Places of the textures: base colour and metallic-roughness, normal and occlusion, emissive.
layout(location = 4) out vec4 out_uv01;
layout(location = 5) out vec4 out_uv23;
layout(location = 6) out vec2 out_uv4;
layout(location = 7) out vec3 out_to_eye;
// Of the material, read here once a vertex and not once a fragment: llvmpipe reads storage buffers lane by lane.
layout(location = 8) flat out vec4 out_factors;
layout(location = 9) flat out vec4 out_emissive;
layout(location = 10) flat out uint out_flags;

void main() {
  ObjectRecord record = objects[in_slot];
  vec3 world = world_position(record);
  gl_Position = clip_position(world);
  gl_PointSize = 1.0;
  mat3 m = transpose(mat3(record.world_from_object[0].xyz, record.world_from_object[1].xyz,
                          record.world_from_object[2].xyz));
  // Normals go by the cofactor matrix, which also serves singular ones; its sign follows the determinant.
  mat3 cofactor = mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
  float inside_out = dot(m[0], cofactor[0]) < 0.0 ? -1.0 : 1.0;
  vec3 normal = cofactor * in_normal.xyz * inside_out;
  out_world = world;
  out_to_eye = camera.eye_m.w != 0.0 ? camera.eye_m.xyz - world : camera.eye_m.xyz;
  out_normal = dot(normal, normal) > 0.0 ? normalize(normal) : vec3(0.0);
  out_tangent = vec4(0.0);
  if ((kTextureMask & kTangents) != 0) {
    vec3 tangent = m * in_tangent.xyz;
    if (dot(tangent, tangent) > 0.0) out_tangent = vec4(normalize(tangent), in_tangent.w * inside_out);
  }
  MaterialRecord material = materials[record.material];
  out_color = material.base_color * in_color;
  out_factors = material.factors;
  out_emissive = material.emissive;
  out_flags = material.flags.x;
  out_uv01 = vec4(texture_place(record.material, kTextureBaseColor),
                  texture_place(record.material, kTextureMetallicRoughness));
  out_uv23 = vec4(texture_place(record.material, kTextureNormal), texture_place(record.material, kTextureOcclusion));
  out_uv4 = texture_place(record.material, kTextureEmissive);
}
