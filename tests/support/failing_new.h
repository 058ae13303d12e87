// Replaces operator new of a test program: while armed, allocations of this thread are counted and one fails.
#pragma once

#include <cstdint>
#include <vector>

namespace scenegen::test {

struct FailingNew {
  bool armed = false;
  bool record = false;  ///< fills `stacks`, one an allocation
  bool failed = false;
  std::uint64_t count = 0;            ///< while armed
  std::uint64_t fail_at = 0;          ///< this one throws std::bad_alloc; 0: none
  bool (*exempt)() = nullptr;         ///< true: not ours (a driver's); neither counted nor failed
  std::vector<std::uint64_t> stacks;  ///< stack_hash() of each

  /// Counts from 0 when armed; the `n`th fails (0: none).
  void reset(std::uint64_t n = 0) {
    record = failed = false;
    count = 0;
    fail_at = n;
    stacks.clear();
  }
};
/// Of this thread.
FailingNew& failing_new();

}  // namespace scenegen::test
