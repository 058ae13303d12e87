#version 460
#extension GL_GOOGLE_include_directive : require
// Which slots a part of a pass draws, a workgroup for each block of slots: the first part what was seen in the frame
// before and is still in the frustum, the second what else is not hidden behind the depth that the first left. Within a block
// nearer slots come first, of equally near ones those that stand first in it: the same frames give the same draws however threads run.
#include "common.glsl"
#include "hi_z_types.h"

layout(local_size_x_id = 3) in;
layout(constant_id = 3) const uint kBlockSlots = 256;

layout(set = 1, binding = 0, std430) readonly buffer Blocks { HiZBlock blocks[]; };
layout(set = 1, binding = 1, std430) readonly buffer Groups { HiZGroup groups[]; };
layout(set = 1, binding = 2, std430) readonly buffer Bits { uint bits[]; };  // visible slots, then mirrored ones
layout(set = 1, binding = 3, std430) buffer Seen { uint seen[]; };           // kBlockSlots / 32 words a block
layout(set = 1, binding = 4, std430) writeonly buffer List { uint list[]; };
layout(set = 1, binding = 5, std430) writeonly buffer Commands { uint commands[]; };
layout(set = 1, binding = 6, std430) readonly buffer Pyramid { float pyramid[]; };
layout(set = 1, binding = 7, std430) buffer Counts { uint counts[]; };
layout(set = 1, binding = 8, std430) readonly buffer Slots { uint slots[]; };  // by block
layout(set = 1, binding = 9, std430) readonly buffer Order { uint order[]; };  // of blocks

layout(push_constant) uniform Constants { HiZConstants constants; };

const uint kWords = kBlockSlots / 32;
const float kInfinity = 3.4e38;
shared uint s_drawn[8];  // slots of the block that are drawn
shared uint s_mirrored[8];
shared float s_near[256];  // of what is drawn, in the order of the block, mirrored ones last

// Where a box of a slot lies in the picture.
struct Footprint {
  bool in_frustum;
  bool at_eye;  // it may reach behind the near plane: what it covers is not known
  vec2 lo_px, hi_px;
  float nearest;  // depth
};

Footprint footprint(uint slot, vec3 lo, vec3 hi) {
  vec3 corners[8];
  float farthest_m = max(abs(camera.eye_m.x), max(abs(camera.eye_m.y), abs(camera.eye_m.z))) * camera.eye_m.w;
  for (int i = 0; i < 8; ++i) {
    vec4 p = vec4((i & 1) != 0 ? hi.x : lo.x, (i & 2) != 0 ? hi.y : lo.y, (i & 4) != 0 ? hi.z : lo.z, 1.0);
    corners[i] = vec3(dot(objects[slot].world_from_object[0], p), dot(objects[slot].world_from_object[1], p),
                      dot(objects[slot].world_from_object[2], p));
    vec3 from_origin = abs(corners[i]);
    farthest_m = max(farthest_m, max(from_origin.x, max(from_origin.y, from_origin.z)));
  }
  // What rounding of a vertex on its way to the screen may come to: 8 ulp of the largest coordinate, as SlotBoxes.
  vec4 slack = 1e-6 * farthest_m *
               (abs(camera.clip_from_world[0]) + abs(camera.clip_from_world[1]) + abs(camera.clip_from_world[2]));
  Footprint f;
  f.at_eye = false;
  f.nearest = 0.0;
  vec2 lo_ndc = vec2(kInfinity);
  vec2 hi_ndc = vec2(-kInfinity);
  uint outside = 63;
  for (int i = 0; i < 8; ++i) {
    vec4 clip = camera.clip_from_world * vec4(corners[i], 1.0);
    uint sides = 0;
    if (clip.x + slack.x < -clip.w - slack.w) sides |= 1;
    if (clip.x - slack.x > clip.w + slack.w) sides |= 2;
    if (clip.y + slack.y < -clip.w - slack.w) sides |= 4;
    if (clip.y - slack.y > clip.w + slack.w) sides |= 8;
    if (clip.z + slack.z < 0.0) sides |= 16;                // beyond the far plane: depth is reversed
    if (clip.z - slack.z > clip.w + slack.w) sides |= 32;
    outside &= sides;
    float w = clip.w - slack.w;
    if (w <= 4.0 * slack.w || w <= 0.0) {
      f.at_eye = true;
    } else {
      vec3 ndc = clip.xyz / clip.w;
      vec3 grow = (slack.xyz + abs(ndc) * slack.w) / w;
      lo_ndc = min(lo_ndc, ndc.xy - grow.xy);
      hi_ndc = max(hi_ndc, ndc.xy + grow.xy);
      f.nearest = max(f.nearest, ndc.z + grow.z);
    }
  }
  f.in_frustum = outside == 0;
  // Interpolated depths may lie some ulp outside those of the corners: of the plane's coefficients, not of the
  // depth itself. With a perspective a share of the distance, without one a share of the whole range.
  f.nearest = camera.eye_m.w != 0.0 ? f.nearest * (1.0 + 5e-4) : f.nearest + 2e-6;
  // A sample is covered only if it lies inside; a quarter of a pixel is far more than edges are snapped by.
  f.lo_px = (0.5 * lo_ndc + 0.5) * vec2(constants.size_px) - 0.25;
  f.hi_px = (0.5 * hi_ndc + 0.5) * vec2(constants.size_px) + 0.25;
  return f;
}

// Is everything there nearer than the box? Texels of the pyramid hold the farthest depth below them.
bool hidden(Footprint f) {
  if (f.at_eye) return false;
  vec2 last = vec2(constants.size_px) - 1.0;
  uvec2 lo = uvec2(clamp(f.lo_px, vec2(0.0), last));
  uvec2 hi = uvec2(clamp(f.hi_px, vec2(0.0), last));
  uint level = 0;
  uint offset = 0;
  uvec2 size = constants.size_px;
  while (level + 1 < constants.levels && any(greaterThan((hi >> level) - (lo >> level), uvec2(3)))) {
    offset += size.x * size.y;
    size = (size + 1) / 2;
    ++level;
  }
  lo >>= level;
  hi >>= level;
  for (uint y = lo.y; y <= hi.y; ++y) {
    for (uint x = lo.x; x <= hi.x; ++x) {
      if (pyramid[offset + y * size.x + x] <= f.nearest) return false;
    }
  }
  return true;
}

bool bit(uint first_word, uint i) { return (bits[first_word + i / 32] >> (i % 32) & 1) != 0; }

void write_command(uint at, HiZBlock block, uint instances, uint first) {
  commands[at] = block.index_count;
  commands[at + 1] = instances;
  commands[at + 2] = block.first_index;
  commands[at + 3] = block.vertex_offset;
  commands[at + 4] = first;
}

void main() {
  uint place = gl_WorkGroupID.y * constants.groups_x + gl_WorkGroupID.x;
  if (place >= constants.blocks) return;  // the same for all threads
  uint number = order[place];
  HiZBlock block = blocks[number];
  uint i = gl_LocalInvocationIndex;
  if (i < kWords) {
    s_drawn[i] = 0;
    s_mirrored[i] = 0;
  }
  barrier();

  uint slot = i < block.count ? slots[block.first + i] : 0;
  bool second = constants.part != 0;
  bool before = (seen[number * kWords + i / 32] >> (i % 32) & 1) != 0;  // in the second part: drawn by the first
  bool shown = i < block.count && bit(0, slot);
  bool passes = false;
  float near = 0.0;
  if (shown && (second || before)) {
    Footprint f = footprint(slot, groups[block.group].lo.xyz, groups[block.group].hi.xyz);
    passes = f.in_frustum && (!second || !hidden(f));
    near = f.at_eye ? kInfinity : f.nearest;
  }
  bool draws = passes && !(second && before);
  bool mirrored = draws && block.mirrored != 0 && bit(constants.bit_words, slot);
  // Bits of what to remember go where those of what was drawn before stand: all of them are read by now.
  uint drawn_before = 0;
  if (second) {
    for (uint k = 0; k < kWords; ++k) drawn_before += bitCount(seen[number * kWords + k]);
  }
  if (draws) atomicOr(s_drawn[i / 32], 1u << (i % 32));
  if (mirrored) atomicOr(s_mirrored[i / 32], 1u << (i % 32));
  barrier();

  uint normal_before = 0, normal_all = 0, mirrored_before = 0, mirrored_all = 0;
  for (uint k = 0; k < kWords; ++k) {
    uint below = k < i / 32 ? 0xFFFFFFFFu : k == i / 32 ? (1u << (i % 32)) - 1 : 0;
    uint normal = s_drawn[k] & ~s_mirrored[k];
    normal_before += bitCount(normal & below);
    normal_all += bitCount(normal);
    mirrored_before += bitCount(s_mirrored[k] & below);
    mirrored_all += bitCount(s_mirrored[k]);
  }
  uint at = mirrored ? normal_all + mirrored_before : normal_before;
  if (draws) s_near[at] = near;
  barrier();
  // What the first part drew stands first in the block's piece of the list.
  uint first = block.first + drawn_before;
  if (draws) {
    uint rank = mirrored ? normal_all : 0;
    uint end = mirrored ? normal_all + mirrored_all : normal_all;
    for (uint k = rank; k < end; ++k) {
      if (s_near[k] > near || (s_near[k] == near && k < at)) ++rank;
    }
    list[first + rank] = slot;
  }
  if (i == 0) {
    uint to = constants.part * constants.command_words + 5 * place;
    write_command(to, block, normal_all, first);
    if (block.mirrored != 0)
      write_command(to + constants.mirrored_words, block, mirrored_all, first + normal_all);
    uint drawn = normal_all + mirrored_all;
    if (drawn != 0) {
      atomicAdd(counts[2 * constants.part], drawn);
      atomicAdd(counts[2 * constants.part + 1], drawn * block.triangles);
    }
  }
  // In the first part: what it draws. In the second: what is not hidden, for the frame that follows.
  barrier();
  if (i < kWords) s_drawn[i] = 0;
  barrier();
  if (passes) atomicOr(s_drawn[i / 32], 1u << (i % 32));
  barrier();
  if (i < kWords) seen[number * kWords + i] = s_drawn[i];
}
