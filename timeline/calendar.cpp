#include "timeline/calendar.h"

#include <algorithm>
#include <cmath>

#include "timeline/schedule/plan_values.h"

namespace scenegen::timeline {

namespace {

constexpr CivilSeconds kFirst = -62135596800;  // 0001-01-01
constexpr CivilSeconds kLast = 253402300799;   // 9999-12-31T23:59:59

/// The reader has checked it (scene/gltf/parse_asset.cpp).
CivilSeconds start_of(const Calendar& calendar) {
  const auto start = parse_moment(calendar.start, DateOrder::unknown);
  return start ? start->at_s : 0;
}

tl::unexpected<Error> usage(Error error) {
  error.kind = ErrorKind::usage;
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace

Result<double> time_of_date(const Calendar& calendar, std::string_view date) {
  auto moment = parse_moment(date, DateOrder::unknown);
  if (!moment) return usage(std::move(moment.error()));
  return static_cast<double>(moment->at_s - start_of(calendar)) / static_cast<double>(kDay) *
         calendar.seconds_per_day;
}

Result<double> time_of_duration(const Calendar& calendar, std::string_view duration) {
  auto seconds = parse_duration(duration);
  if (!seconds) return usage(std::move(seconds.error()));
  return static_cast<double>(*seconds) / static_cast<double>(kDay) * calendar.seconds_per_day;
}

std::string date_at(const Calendar& calendar, double time_s) {
  const double civil_s = static_cast<double>(start_of(calendar)) +
                         std::round(time_s / calendar.seconds_per_day * static_cast<double>(kDay));
  return moment_text(static_cast<CivilSeconds>(
      std::clamp(civil_s, static_cast<double>(kFirst), static_cast<double>(kLast))));
}

}  // namespace scenegen::timeline
