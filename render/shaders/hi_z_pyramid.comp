#version 460
// Farthest depths: level 0 and five more of the pyramid at once from the depth picture, or five from the level before. A
// texel of level 0 is a pixel, above that the least (depth is reversed) of 2 x 2 below it; what lies outside the
// picture is as near as can be.
layout(local_size_x = 16, local_size_y = 16) in;

#ifdef FROM_DEPTH
#ifdef SAMPLES
layout(set = 0, binding = 1) uniform sampler2DMS depth;
#else
layout(set = 0, binding = 1) uniform sampler2D depth;
#endif
#endif
layout(set = 0, binding = 0, std430) buffer Pyramid { float pyramid[]; };

layout(push_constant) uniform Constants {
  uvec2 size;          // of what is read
  uint source_offset;  // in the pyramid, unless the depth picture is read
  uint offset;         // of the first level that is written
  uint levels;         // to write, at most 5, level 0 not counted
};

shared float s_tile[16][16];

float source(uvec2 at) {
  if (any(greaterThanEqual(at, size))) return 1.0;
#ifdef FROM_DEPTH
#ifdef SAMPLES
  float farthest = 1.0;
  for (int s = 0; s < SAMPLES; ++s) farthest = min(farthest, texelFetch(depth, ivec2(at), s).x);
#else
  float farthest = texelFetch(depth, ivec2(at), 0).x;
#endif
  pyramid[at.y * size.x + at.x] = farthest;
  return farthest;
#else
  return pyramid[source_offset + at.y * size.x + at.x];
#endif
}

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  uvec2 local = gl_LocalInvocationID.xy;
  float farthest = min(min(source(2 * at), source(2 * at + uvec2(1, 0))),
                       min(source(2 * at + uvec2(0, 1)), source(2 * at + uvec2(1, 1))));
  uvec2 level_size = (size + 1) / 2;
  uint to = offset;
  if (all(lessThan(at, level_size))) pyramid[to + at.y * level_size.x + at.x] = farthest;
  s_tile[local.y][local.x] = farthest;
  for (uint level = 1; level < levels; ++level) {
    to += level_size.x * level_size.y;
    level_size = (level_size + 1) / 2;
    barrier();
    uint width = 16u >> level;
    bool mine = all(lessThan(local, uvec2(width)));
    if (mine) {
      farthest = min(min(s_tile[2 * local.y][2 * local.x], s_tile[2 * local.y][2 * local.x + 1]),
                     min(s_tile[2 * local.y + 1][2 * local.x], s_tile[2 * local.y + 1][2 * local.x + 1]));
    }
    barrier();
    if (mine) {
      s_tile[local.y][local.x] = farthest;
      uvec2 texel = gl_WorkGroupID.xy * width + local;
      if (all(lessThan(texel, level_size))) pyramid[to + texel.y * level_size.x + texel.x] = farthest;
    }
  }
}
