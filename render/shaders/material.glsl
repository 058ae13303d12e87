// Textures of a material.
layout(set = 1, binding = 0) uniform sampler2D textures[5];

bool has_texture(uint which) { return (kTextureMask & (1u << which)) != 0; }

vec4 base_color(MaterialRecord material, vec2 uv, vec4 vertex_color) {
  vec4 color = material.base_color * vertex_color;
  if (has_texture(kTextureBaseColor)) color *= texture(textures[kTextureBaseColor], uv);
  return color;
}
