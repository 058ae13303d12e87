#version 460
// Results of queries, in the order in which they were asked, to the predicates of the chunks they are about.
layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Results { uint results[]; };
layout(set = 0, binding = 1, std430) readonly buffer Chunks { uint chunks[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Predicates { uint predicates[]; };

layout(push_constant) uniform Count { uint count; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < count) predicates[chunks[i]] = results[i];
}
