// Structs that the program and its shaders share; compiled as C++ and as GLSL. Only 16-byte members or groups
// of them, so that std140, std430 and C++ agree (the static_asserts check it).
#ifndef SCENEGEN_RENDER_SHADERS_SHARED_TYPES_H
#define SCENEGEN_RENDER_SHADERS_SHARED_TYPES_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace scenegen::render {
using glm::mat4;
using glm::uvec4;
using glm::vec4;
using uint = std::uint32_t;
#endif

/// One draw's object; firstInstance of the draw is its index in the object array. 64 bytes.
struct ObjectRecord {
  vec4 world_from_object[3];  // rows
  uint material;              // index into the material array
  uint object;                // ObjectId: what the id picture holds
  uint unused0;
  uint unused1;
};

/// One use of a texture. uv' = (dot(row0.xy, uv) + row0.z, dot(row1.xy, uv) + row1.z).
struct MaterialTexture {
  vec4 row0;
  vec4 row1;
};

const uint kTextureBaseColor = 0;
const uint kTextureMetallicRoughness = 1;
const uint kTextureNormal = 2;
const uint kTextureOcclusion = 3;
const uint kTextureEmissive = 4;
const uint kTextureCount = 5;
/// Beside the textures' bits in a pipeline's mask: the geometry has tangents for the normal map.
const uint kTangents = 1u << 5;

const uint kMaterialUnlit = 1;
const uint kMaterialSecondTexcoord = 2;  // shifted left by the texture's index: it reads TEXCOORD_1

/// glTF metallic-roughness material.
struct MaterialRecord {
  vec4 base_color;
  vec4 emissive;  // w: alpha cutoff
  vec4 factors;   // metallic, roughness, strength of the normal map, of the occlusion map
  uvec4 flags;    // x: kMaterial…
  MaterialTexture textures[5];
};

/// What all draws of a frame share.
struct CameraBlock {
  mat4 clip_from_world;
  mat4 shadow_from_world;
  mat4 world_from_clip;  // of directions: for the sky
  vec4 eye_m;            // w: 1 perspective, 0 orthographic (xyz is then the direction to the eye)
  vec4 shadow_texel;     // x: its side, m; y: 1 / side of the shadow map in texels
};

#ifdef __cplusplus
static_assert(sizeof(ObjectRecord) == 64);
static_assert(sizeof(MaterialTexture) == 32);
static_assert(sizeof(MaterialRecord) == 64 + 160);
static_assert(sizeof(CameraBlock) == 3 * 64 + 2 * 16);
}  // namespace scenegen::render
#endif
#endif
