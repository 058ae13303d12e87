// Tells places in a program apart by their callers.
#pragma once

#include <execinfo.h>

#include <array>
#include <cstdint>

namespace scenegen::test {

/// The same for the same place and callers, while the program runs.
inline std::uint64_t stack_hash() {
  std::array<void*, 64> frames{};
  const int depth = backtrace(frames.data(), static_cast<int>(frames.size()));
  std::uint64_t hash = 1469598103934665603ULL;  // FNV-1a, a frame at a time
  for (int i = 0; i < depth; ++i)
    hash = (hash ^ reinterpret_cast<std::uintptr_t>(frames[static_cast<std::size_t>(i)])) * 1099511628211ULL;
  return hash;
}

}  // namespace scenegen::test
