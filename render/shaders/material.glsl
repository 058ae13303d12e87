// Textures of a material.
layout(set = 1, binding = 0) uniform sampler2D textures[5];

vec2 texture_place(MaterialRecord material, uint which, vec4 texcoords) {
  vec2 uv = (material.flags.x & (kMaterialSecondTexcoord << which)) != 0 ? texcoords.zw : texcoords.xy;
  MaterialTexture t = material.textures[which];
  return vec2(dot(t.row0.xy, uv) + t.row0.z, dot(t.row1.xy, uv) + t.row1.z);
}

bool has_texture(uint which) { return (kTextureMask & (1u << which)) != 0; }

vec4 base_color(MaterialRecord material, vec4 texcoords, vec4 vertex_color) {
  vec4 color = material.base_color * vertex_color;
  if (has_texture(kTextureBaseColor))
    color *= texture(textures[kTextureBaseColor], texture_place(material, kTextureBaseColor, texcoords));
  return color;
}
