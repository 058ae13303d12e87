// Which moments of a timeline are drawn.
#pragma once

#include <string_view>
#include <vector>

#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::tools {

/// More pictures than this in one call is taken for a mistake.
constexpr std::size_t kMaxFrames = 1'000'000;

/// "1.5,50%,2:8:0.5": seconds, percentages of the timeline, or FROM:TO:STEP with both ends (each in seconds
/// or percent), backwards where TO is before FROM. With a calendar also dates, "2024-03-15" (midnight) and
/// "2024-03-15T12:00", and steps such as "7d". Times outside the timeline are an error. The error's `where`
/// is empty. `calendar` may be null.
[[nodiscard]] Result<std::vector<double>> parse_times(std::string_view text, double duration_s,
                                                      const Calendar* calendar = nullptr);

/// The whole timeline in `length_s` seconds of film at `fps` pictures a second, first and last moment
/// included: round(length_s * fps) + 1 pictures.
[[nodiscard]] Result<std::vector<double>> film_times(double fps, double length_s, double duration_s);

}  // namespace scenegen::tools
