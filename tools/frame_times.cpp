#include "tools/frame_times.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "timeline/calendar.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

/// The timeline that times are read for.
struct Span {
  double duration_s;
  const Calendar* calendar;

  [[nodiscard]] std::string end() const {
    const std::string seconds = shortest_float(static_cast<float>(duration_s)) + " s";
    return calendar == nullptr ? seconds : timeline::date_at(*calendar, duration_s) + " (" + seconds + ")";
  }
};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Begins like 2024-03.
bool is_date(std::string_view text) {
  const std::size_t dash = text.find('-');
  return dash == 4 && text.size() > 5 && std::all_of(text.begin(), text.begin() + 4, is_digit) &&
         is_digit(text[5]);
}

tl::unexpected<Error> no_calendar(std::string_view text) {
  return fail(
      ErrorKind::usage, "",
      "'" + std::string(text) + "': the file has no calendar (scenegen schedule makes files that have)");
}

Result<double> parse_date(std::string_view text, const Span& span) {
  if (span.calendar == nullptr) return no_calendar(text);
  auto time_s = timeline::time_of_date(*span.calendar, text);
  if (!time_s) return time_s;
  // Keys are float32 and so may the end be: a date at the end is not after it.
  if (static_cast<float>(*time_s) > static_cast<float>(span.duration_s))
    return fail(ErrorKind::usage, "",
                "'" + std::string(text) + "' is after the end of the timeline, " + span.end());
  if (*time_s < 0) {
    return fail(
        ErrorKind::usage, "",
        "'" + std::string(text) + "' is before the timeline begins, " + timeline::date_at(*span.calendar, 0));
  }
  return time_s;
}

Result<double> parse_moment(std::string_view text, const Span& span) {
  if (is_date(text)) return parse_date(text, span);
  if (text.ends_with('%')) {
    Result<double> percent = parse_real(text.substr(0, text.size() - 1), 0.0, 100.0);
    if (!percent) return percent;
    return *percent * 0.01 * span.duration_s;
  }
  Result<double> seconds = parse_real(text, 0.0, 1e9);
  if (seconds && static_cast<float>(*seconds) > static_cast<float>(span.duration_s))
    return fail(ErrorKind::usage, "",
                "'" + std::string(text) + "' is after the end of the timeline, " + span.end());
  return seconds;
}

/// "7d", "12h": a number with a unit of days.
Result<double> parse_step(std::string_view text, const Span& span) {
  const bool unit = !text.empty() && is_digit(text[0]) && text.back() >= 'a' && text.back() <= 'z';
  if (!unit) return parse_moment(text, span);
  if (span.calendar == nullptr) return no_calendar(text);
  return timeline::time_of_duration(*span.calendar, text);
}

/// Between colons, but for that of 2024-03-15T12:00.
std::vector<std::string_view> fields_of(std::string_view text) {
  std::vector<std::string_view> out;
  for (std::size_t begin = 0; begin <= text.size();) {
    std::size_t end = std::min(text.find(':', begin), text.size());
    const std::string_view field = text.substr(begin, end - begin);
    if (is_date(field) && field.find_first_of("Tt") != std::string_view::npos && end < text.size())
      end = std::min(text.find(':', end + 1), text.size());
    out.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  if (out.size() == 2 && is_date(out[0]) && out[1].size() == 2) return {text};  // 2024-03-15T12:00:30
  return out;
}

Result<void> add_range(std::string_view text, const std::vector<std::string_view>& fields, const Span& span,
                       std::vector<double>& out) {
  if (fields.size() != 3) return fail(ErrorKind::usage, "", "'" + std::string(text) + "' is no FROM:TO:STEP");
  Result<double> from = parse_moment(fields[0], span);
  if (!from) return forward_error(from);
  Result<double> to = parse_moment(fields[1], span);
  if (!to) return forward_error(to);
  Result<double> step = parse_step(fields[2], span);
  if (!step) return forward_error(step);
  if (!(*step > 0.0))
    return fail(ErrorKind::usage, "", "the step of '" + std::string(text) + "' must be above 0");
  const double steps = std::floor(std::abs(*to - *from) / *step * (1.0 + 1e-12) + 1e-9);
  if (steps >= static_cast<double>(kMaxFrames - out.size()))
    return fail(ErrorKind::usage, "", "more than " + human_count(kMaxFrames) + " frames");
  for (std::size_t i = 0; i <= static_cast<std::size_t>(steps); ++i) {
    const double past_s = static_cast<double>(i) * *step;
    out.push_back(*to < *from ? std::max(*from - past_s, *to) : std::min(*from + past_s, *to));
  }
  return {};
}

}  // namespace

Result<std::vector<double>> parse_times(std::string_view text, double duration_s, const Calendar* calendar) {
  const Span span{duration_s, calendar};
  std::vector<double> out;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view item = text.substr(begin, end - begin);
    if (item.empty()) return fail(ErrorKind::usage, "", "'" + std::string(text) + "' has an empty entry");
    const std::vector<std::string_view> fields = fields_of(item);
    if (fields.size() > 1) {
      if (Result<void> added = add_range(item, fields, span, out); !added) return forward_error(added);
    } else {
      Result<double> moment = parse_moment(item, span);
      if (!moment) return forward_error(moment);
      out.push_back(*moment);
    }
    if (out.size() > kMaxFrames)
      return fail(ErrorKind::usage, "", "more than " + human_count(kMaxFrames) + " frames");
    begin = end + 1;
  }
  // Keys are float32: "0.1" must meet the key at 0.1 s, which lies 1.5e-9 s above the double of that name.
  for (double& time_s : out) time_s = static_cast<double>(static_cast<float>(time_s));
  return out;
}

Result<std::vector<double>> film_times(double fps, double length_s, double duration_s) {
  const double intervals = std::round(fps * length_s);
  if (!(intervals < static_cast<double>(kMaxFrames)))
    return fail(ErrorKind::usage, "", "more than " + human_count(kMaxFrames) + " frames");
  const auto n = static_cast<std::size_t>(intervals);
  std::vector<double> out;
  for (std::size_t i = 0; i <= n; ++i)
    out.push_back(n == 0 ? duration_s : duration_s * static_cast<double>(i) / static_cast<double>(n));
  return out;
}

}  // namespace scenegen::tools
