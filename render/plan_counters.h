// What a strategy says of a frame: part of the frame's report.
#pragma once

#include <cstdint>

namespace scenegen::render {

/// Parts of recording on the processor, in all passes; strategies add to them with StageTimer.
struct StageTimes {
  double keep_ms = 0;         ///< recording chunks that are kept, T_buf(H_upd), and finding the others
  double secondaries_ms = 0;  ///< executing kept chunks, T_sec
  double ask_ms = 0;          ///< recording queries, T_buf(H_q), and choosing what to ask
  double receive_ms = 0;      ///< reading results of queries, T_recv
};

/// What planning and drawing found.
struct PlanCounters : StageTimes {
  std::uint64_t tested = 0;             ///< boxes tested against the frustum
  std::uint64_t drawn = 0;              ///< slots (object x primitive) that are drawn in the colour pass
  std::uint64_t nodes = 0;              ///< octree nodes visited
  std::uint64_t tree_nodes = 0;         ///< nodes that the octree has
  std::uint64_t chunks = 0;             ///< of the octree, in the frustum
  std::uint64_t refreshed_chunks = 0;   ///< of the octree, in which something changed
  std::uint64_t refreshed_slots = 0;    ///< of those whose boxes and sums were made anew
  std::uint64_t secondaries = 0;        ///< kept command buffers executed, in all passes but the shadows'
  std::uint64_t recorded = 0;           ///< kept chunks recorded, or written for indirect draws, anew
  std::uint64_t recorded_draws = 0;     ///< slots that those draw
  std::uint64_t indirect_commands = 0;  ///< indirect draw commands in the place of secondaries
  std::uint64_t queries = 0;            ///< occlusion queries sent, in all passes
  std::uint64_t believed_hidden = 0;    ///< parts believed hidden that they are about; some share a query
  std::uint64_t answers = 0;            ///< results of earlier frames, read in this one
  std::uint64_t found_hidden = 0;       ///< of them those that say hidden
  std::uint64_t list_bytes = 0;         ///< lists of slots and blocks, part of the bytes uploaded
  std::uint64_t reveals = 0;            ///< those that say visible of what was believed hidden
};

}  // namespace scenegen::render
