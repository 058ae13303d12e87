// Which moments of a timeline are drawn.
#pragma once

#include <string_view>
#include <vector>

#include "scene/result.h"

namespace scenegen::tools {

/// More pictures than this in one call is taken for a mistake.
constexpr std::size_t kMaxFrames = 1'000'000;

/// "1.5,50%,2:8:0.5": seconds, percentages of the timeline, or FROM:TO:STEP with both ends (each in seconds
/// or percent). Seconds beyond `duration_s` are an error. The error's `where` is empty.
[[nodiscard]] Result<std::vector<double>> parse_times(std::string_view text, double duration_s);

/// The whole timeline in `length_s` seconds of film at `fps` pictures a second, first and last moment
/// included: round(length_s * fps) + 1 pictures.
[[nodiscard]] Result<std::vector<double>> film_times(double fps, double length_s, double duration_s);

}  // namespace scenegen::tools
