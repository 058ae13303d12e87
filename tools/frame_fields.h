// The figures of a frame under the names that reports, traces and benchmarks give them.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "render/renderer.h"

namespace scenegen::tools {

struct CounterField {
  std::string_view name;
  std::uint64_t render::FrameReport::*value;
};
[[nodiscard]] std::span<const CounterField> counter_fields();

/// Milliseconds on the processor or the device, in the order in which they happen; negative: not known.
struct StageField {
  std::string_view name;
  double render::FrameReport::*value;
  bool cpu;  ///< the processor works in it, and it is part of no other stage
};
[[nodiscard]] std::span<const StageField> stage_fields();

/// Adds which way of drawing was taken, why, and what every way was predicted to take (if that was asked
/// for).
void add_choice(const render::FrameReport& report, nlohmann::ordered_json& to);

}  // namespace scenegen::tools
