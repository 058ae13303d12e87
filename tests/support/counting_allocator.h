// Linked into a test program, counts every allocation of it.
#pragma once

#include <cstdint>

namespace scenegen::test {

/// Calls of any operator new since the program began.
[[nodiscard]] std::uint64_t allocation_count();
/// Those of the calling thread alone: drivers have threads of their own, whose number differs.
[[nodiscard]] std::uint64_t thread_allocation_count();

}  // namespace scenegen::test
