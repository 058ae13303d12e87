#include "tools/frame_times.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "tools/text.h"

namespace scenegen::tools {
namespace {

Result<double> parse_moment(std::string_view text, double duration_s) {
  if (text.ends_with('%')) {
    Result<double> percent = parse_real(text.substr(0, text.size() - 1), 0.0, 100.0);
    if (!percent) return percent;
    return *percent * 0.01 * duration_s;
  }
  Result<double> seconds = parse_real(text, 0.0, 1e9);
  if (seconds && static_cast<float>(*seconds) > static_cast<float>(duration_s))
    return fail(ErrorKind::usage, "",
                "'" + std::string(text) + "' is after the end of the timeline, " +
                    shortest_float(static_cast<float>(duration_s)) + " s");
  return seconds;
}

Result<void> add_range(std::string_view text, double duration_s, std::vector<double>& out) {
  const std::size_t first = text.find(':');
  const std::size_t second = text.find(':', first + 1);
  if (second == std::string_view::npos || text.find(':', second + 1) != std::string_view::npos)
    return fail(ErrorKind::usage, "", "'" + std::string(text) + "' is no FROM:TO:STEP");
  Result<double> from = parse_moment(text.substr(0, first), duration_s);
  if (!from) return forward_error(from);
  Result<double> to = parse_moment(text.substr(first + 1, second - first - 1), duration_s);
  if (!to) return forward_error(to);
  Result<double> step = parse_moment(text.substr(second + 1), duration_s);
  if (!step) return forward_error(step);
  if (!(*step > 0.0))
    return fail(ErrorKind::usage, "", "the step of '" + std::string(text) + "' must be above 0");
  if (*to < *from) return fail(ErrorKind::usage, "", "'" + std::string(text) + "' ends before it begins");
  const double steps = std::floor((*to - *from) / *step * (1.0 + 1e-12) + 1e-9);
  if (steps >= static_cast<double>(kMaxFrames - out.size()))
    return fail(ErrorKind::usage, "", "more than " + human_count(kMaxFrames) + " frames");
  for (std::size_t i = 0; i <= static_cast<std::size_t>(steps); ++i)
    out.push_back(std::min(*from + static_cast<double>(i) * *step, *to));
  return {};
}

}  // namespace

Result<std::vector<double>> parse_times(std::string_view text, double duration_s) {
  std::vector<double> out;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view item = text.substr(begin, end - begin);
    if (item.empty()) return fail(ErrorKind::usage, "", "'" + std::string(text) + "' has an empty entry");
    if (item.find(':') != std::string_view::npos) {
      if (Result<void> added = add_range(item, duration_s, out); !added) return forward_error(added);
    } else {
      Result<double> moment = parse_moment(item, duration_s);
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
