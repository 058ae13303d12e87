// Textures of a material.
layout(set = 1, binding = 0) uniform sampler2D textures[5];

vec2 texture_place(MaterialRecord material, uint which, vec4 texcoords) {
  vec2 uv = (material.flags.x & (kMaterialSecondTexcoord << which)) != 0 ? texcoords.zw : texcoords.xy;
  MaterialTexture t = material.textures[which];
  return vec2(dot(t.row0.xy, uv) + t.row0.z, dot(t.row1.xy, uv) + t.row1.z);
}

bool has_texture(MaterialRecord material, uint which) {
  return kTextured && material.textures[which].row0.w != 0.0;
}

vec4 base_color(MaterialRecord material, vec4 texcoords, vec4 vertex_color) {
  vec4 color = material.base_color * vertex_color;
  if (kTextured) {
    vec4 texel = texture(textures[0], texture_place(material, kTextureBaseColor, texcoords));
    if (has_texture(material, kTextureBaseColor)) color *= texel;
  }
  return color;
}
