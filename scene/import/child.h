// Work that may crash, hang or ask for any amount of memory, in a process of its own. Private to
// scene/import.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace scenegen::import {

struct ChildLimits {
  std::uint64_t memory_bytes = 0;  ///< address space beyond what this process has now
  std::uint64_t cpu_s = 0;         ///< wall-clock time is bounded by ten times as much
  std::uint64_t output_bytes = 0;
};

struct ChildOutcome {
  enum class End : std::uint8_t {
    finished,
    crashed,
    too_long,
    too_much_memory,
    too_much_output,
    not_started
  };
  End end = End::finished;
  int code = 0;                     ///< crashed: the signal; not_started: errno
  std::vector<std::uint8_t> bytes;  ///< what `body` wrote
};

/// Forks; the child calls `body`, which writes to the descriptor, and ends. Nothing that it prints is seen.
/// It dies with this process. Call it while this process has one thread.
[[nodiscard]] ChildOutcome run_in_child(const std::function<void(int descriptor)>& body,
                                        const ChildLimits& limits);

}  // namespace scenegen::import
