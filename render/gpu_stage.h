// What the device does in a frame, in the order in which it does it; measured by timestamps between them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace scenegen::render {

enum class GpuStage : std::uint8_t {
  updates,      ///< camera, changed object records and materials copied into place
  shadows,      ///< the sun's map
  solid,        ///< colour pass: opaque and masked objects, and boxes of queries
  second_part,  ///< colour pass: predicates from this frame's queries, and what was believed hidden
  rest,         ///< colour pass: sky and blended objects, resolve
  ids,          ///< pass of ids and depth, all of it
  readback      ///< pictures copied to where the processor reads them
};
constexpr std::size_t kGpuStages = 7;
constexpr std::array<std::string_view, kGpuStages> kGpuStageNames{
    "updates", "shadows", "solid", "secondPart", "rest", "ids", "readback"};

}  // namespace scenegen::render
