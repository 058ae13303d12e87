// What the renderer's memory is for, under the names that reports and benchmarks give it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "render/memory_account.h"

namespace scenegen::tools {

/// Members "memory" (by kind: hostBytes, deviceBytes, spilledBytes), "ownBytes", "bytesPerObject",
/// "commandMemory" (null without kept command buffers).
[[nodiscard]] nlohmann::ordered_json memory_json(const render::MemoryAccount& account);
/// The same for people, kinds without a byte left out.
[[nodiscard]] std::string memory_table(const render::MemoryAccount& account);

}  // namespace scenegen::tools
