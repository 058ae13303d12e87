// How much memory there is, so that a scene that is too large is an error and not the end of the process.
#pragma once

#include <cstdint>
#include <optional>

namespace scenegen::tools {

/// Bytes that this process may still take: the kernel's MemAvailable, or less where a control group allows
/// less. None where it cannot be told.
[[nodiscard]] std::optional<std::uint64_t> available_memory();

}  // namespace scenegen::tools
