#version 460
// Results of queries, in the order in which they were asked, to the predicates of the chunks that they govern.
layout(local_size_x = 64) in;

struct Governed {
  uint query;
  uint chunk;
};

layout(set = 0, binding = 0, std430) readonly buffer Results { uint results[]; };
layout(set = 0, binding = 1, std430) readonly buffer Chunks { Governed governed[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Predicates { uint predicates[]; };

layout(push_constant) uniform Constants {
  uint count;
  uint let_pass;
};

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < count) predicates[governed[i].chunk + 1] = results[governed[i].query] != 0 ? let_pass : 0;
}
