// Linked into a test program, counts every allocation of it.
#pragma once

#include <cstdint>

namespace scenegen::timeline::test {

/// Calls of any operator new since the program began.
[[nodiscard]] std::uint64_t allocation_count();

}  // namespace scenegen::timeline::test
