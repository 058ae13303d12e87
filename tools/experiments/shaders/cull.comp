#version 460
// Sets the number of instances of each draw: 0 when a plane has its box outside.
layout(local_size_x = 64) in;

struct Command {
  uint index_count;
  uint instance_count;
  uint first_index;
  int vertex_offset;
  uint first_instance;
};
struct Bounds {
  vec4 lo;
  vec4 hi;
};

layout(set = 0, binding = 0, std430) readonly buffer Boxes { Bounds boxes[]; };
layout(set = 0, binding = 1, std430) buffer Commands { Command commands[]; };

layout(push_constant) uniform Constants {
  vec4 planes[6];
  uint plane_count;
  uint count;
};

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  bool inside = true;
  for (uint p = 0; p < plane_count; ++p) {
    vec3 far = mix(boxes[i].lo.xyz, boxes[i].hi.xyz, greaterThan(planes[p].xyz, vec3(0.0)));
    inside = inside && dot(planes[p].xyz, far) + planes[p].w >= 0.0;
  }
  commands[i].instance_count = inside ? 1 : 0;
}
