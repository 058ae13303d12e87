// Dates of a scene that has a calendar (Calendar in scene/scene.h).
#pragma once

#include <string>
#include <string_view>

#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::timeline {

/// Seconds on the timeline of "2024-03-15" (its midnight) or "2024-03-15T12:00"; may be outside the timeline.
/// Errors (usage, `where` empty).
[[nodiscard]] Result<double> time_of_date(const Calendar& calendar, std::string_view date);
/// Seconds on the timeline that "7d", "2w", "12h" take.
[[nodiscard]] Result<double> time_of_duration(const Calendar& calendar, std::string_view duration);
/// "2024-03-15", or "2024-03-15T12:00:00" when it is not midnight; to the second.
[[nodiscard]] std::string date_at(const Calendar& calendar, double time_s);

}  // namespace scenegen::timeline
