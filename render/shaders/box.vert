#version 460
#extension GL_GOOGLE_include_directive : require
// A box that an occlusion query asks about: 36 vertices from two corners.
#include "common.glsl"

layout(push_constant) uniform Corners {
  vec4 lo;
  vec4 hi;
};

invariant gl_Position;

// Corner bits (x 1, y 2, z 4) of the 12 triangles.
const int kCorners[36] = int[](0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3, 0, 4, 5, 0, 5, 1,
                               2, 3, 7, 2, 7, 6, 0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5);

void main() {
  int corner = kCorners[gl_VertexIndex];
  vec3 world = vec3((corner & 1) != 0 ? hi.x : lo.x, (corner & 2) != 0 ? hi.y : lo.y, (corner & 4) != 0 ? hi.z : lo.z);
  gl_Position = camera.clip_from_world * vec4(world, 1.0);
}
