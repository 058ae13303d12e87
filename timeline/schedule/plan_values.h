// Dates, durations and links as plans spell them. Private to timeline/schedule; errors have no `where`.
#pragma once

#include <string>
#include <string_view>

#include "timeline/schedule/plan.h"
#include "timeline/words.h"

namespace scenegen::timeline {

struct Moment {
  CivilSeconds at_s = 0;
  bool has_time = false;  ///< a date alone: as a finish it includes the day
};

/// "2024-03-01", "2024-03-01T08:00", "2024-03-01 08:00:30", "20240301", "2024/03/01"; "13.03.2024",
/// "03/13/2024" where only one order is a date or `order` says which; "1-Mar-2024"; "Wed 10.04.24"
/// (English, "Mi" German), where the weekday must fit, may tell the order, and a year of two digits is of
/// this century. Years 1 to 9999. A zone "Z" is let be, others are refused.
[[nodiscard]] Result<Moment> parse_moment(std::string_view text, DateOrder order);
/// "5" (days), "5d", "2w", "8h", "30min", "P5D", "PT8H0M0S"; not negative, at most 100 years. Days have 24
/// hours and weeks 7 days.
[[nodiscard]] Result<CivilSeconds> parse_duration(std::string_view text);

/// A predecessor without its task: "3FS+2d" is {"3", finish_start, 2 days}.
struct LinkText {
  std::string_view id;
  LinkKind kind = LinkKind::finish_start;
  CivilSeconds lag_s = 0;
  bool lag_without_kind = false;  ///< "3+2d": MS Project writes it only behind FS, SS, FF or SF
};
[[nodiscard]] Result<LinkText> parse_link(std::string_view text);

/// A number of the plan in seconds, rounded; an error above 100 years.
[[nodiscard]] Result<CivilSeconds> whole_seconds(double seconds, std::string_view text);

/// Without blanks, dashes and underscores, in lower case (ASCII): "Task_Type" is "tasktype".
[[nodiscard]] std::string plain_word(std::string_view text);
[[nodiscard]] std::string_view trimmed(std::string_view text);

}  // namespace scenegen::timeline
