#include "timeline/schedule/plan_values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>
#include <vector>

namespace scenegen::timeline {

namespace {

constexpr double kMostSeconds = 100.0 * 365.25 * kDay;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool all_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), is_digit);
}

/// Of at most 9 digits.
unsigned number_of(std::string_view digits) {
  unsigned out = 0;
  for (const char c : digits) out = out * 10 + static_cast<unsigned>(c - '0');
  return out;
}

constexpr std::array<std::string_view, 12> kMonths{"January",   "February", "March",    "April",
                                                   "May",       "June",     "July",     "August",
                                                   "September", "October",  "November", "December"};

/// 1 to 12 by the English name or its first three letters; 0: no month.
unsigned month_of(std::string_view word) {
  if (word.size() < 3) return 0;
  const std::string plain = plain_word(word);
  for (unsigned m = 0; m < kMonths.size(); ++m) {
    const std::string month = plain_word(kMonths[m]);
    if (plain == month || plain == month.substr(0, 3)) return m + 1;
  }
  return 0;
}

constexpr std::array<std::string_view, 7> kWeekdays{"Sunday",   "Monday", "Tuesday", "Wednesday",
                                                    "Thursday", "Friday", "Saturday"};
constexpr std::array<std::string_view, 7> kGermanWeekdays{"Sonntag",    "Montag",  "Dienstag", "Mittwoch",
                                                          "Donnerstag", "Freitag", "Samstag"};

/// 0 (Sunday) to 6 by the name, or its first three letters in English, its first two in German.
std::optional<unsigned> weekday_of(std::string_view word) {
  if (word.size() < 2) return std::nullopt;
  const std::string plain = plain_word(word);
  for (unsigned d = 0; d < kWeekdays.size(); ++d) {
    const std::string english = plain_word(kWeekdays[d]), german = plain_word(kGermanWeekdays[d]);
    if (plain == english || plain == english.substr(0, 3) || plain == german || plain == german.substr(0, 2))
      return d;
  }
  return std::nullopt;
}

unsigned weekday_at(CivilSeconds midnight_s) {
  namespace chr = std::chrono;
  return chr::weekday(chr::sys_days(chr::days(midnight_s / kDay))).c_encoding();
}

struct DateParts {
  unsigned year = 0, month = 0, day = 0;
};

constexpr std::string_view kWantedDate = "wanted a date YYYY-MM-DD, with a time YYYY-MM-DDTHH:MM";

tl::unexpected<Error> bad(std::string_view text, const std::string& what) {
  return fail(ErrorKind::bad_input, "", in_quotes(text) + ": " + what);
}

/// Days and months in numbers, year last: which is which?
Result<DateParts> order_parts(std::string_view text, unsigned first, unsigned second, unsigned year,
                              DateOrder order) {
  if (order == DateOrder::unknown && first != second) {
    if (first <= 12 && second <= 12) {
      return bad(text, "may be day or month first; write YYYY-MM-DD, or say --date-order dmy or mdy");
    }
    order = first > 12 ? DateOrder::day_month_year : DateOrder::month_day_year;
  }
  if (order == DateOrder::month_day_year) std::swap(first, second);
  if (second < 1 || second > 12) return bad(text, "there is no month " + std::to_string(second));
  return DateParts{year, second, first};
}

/// `short_years`: two digits are a year of this century.
Result<DateParts> parse_date_parts(std::string_view text, std::string_view date, DateOrder order,
                                   bool short_years) {
  if (date.size() == 8 && all_digits(date))
    return DateParts{number_of(date.substr(0, 4)), number_of(date.substr(4, 2)), number_of(date.substr(6))};
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= date.size() && parts.size() < 4;) {
    const std::size_t end = std::min(date.find_first_of("-/. ", begin), date.size());
    if (end > begin) parts.push_back(date.substr(begin, end - begin));
    begin = end + 1;
  }
  if (parts.size() != 3) return bad(text, std::string(kWantedDate));
  const auto short_number = [](std::string_view p) { return all_digits(p) && p.size() <= 2; };
  const auto year_number = [](std::string_view p) { return all_digits(p) && p.size() == 4; };
  const unsigned named = month_of(parts[1]);
  if (year_number(parts[0]) && short_number(parts[1]) && short_number(parts[2]))
    return DateParts{number_of(parts[0]), number_of(parts[1]), number_of(parts[2])};
  if (!short_number(parts[0]) || (named == 0 && !short_number(parts[1])))
    return bad(text, std::string(kWantedDate));
  const bool short_year = short_years && parts[2].size() == 2 && all_digits(parts[2]);
  if (!short_year && short_number(parts[2])) return bad(text, "the year needs four digits");
  if (!short_year && !year_number(parts[2])) return bad(text, std::string(kWantedDate));
  const unsigned year = number_of(parts[2]) + (short_year ? 2000 : 0);
  if (named != 0) return DateParts{year, named, number_of(parts[0])};
  return order_parts(text, number_of(parts[0]), number_of(parts[1]), year, order);
}

Result<CivilSeconds> date_seconds(std::string_view text, const DateParts& parts) {
  if (parts.year < 1 || parts.year > 9999) return bad(text, "years go from 1 to 9999");
  if (parts.month < 1 || parts.month > 12)
    return bad(text, "there is no month " + std::to_string(parts.month));
  namespace chr = std::chrono;
  const chr::year_month_day date{chr::year(static_cast<int>(parts.year)), chr::month(parts.month),
                                 chr::day(parts.day)};
  if (!date.ok()) {
    const chr::year_month_day_last last{date.year(), chr::month_day_last(date.month())};
    return bad(text, std::string(kMonths[parts.month - 1]) + " " + std::to_string(parts.year) + " has " +
                         std::to_string(static_cast<unsigned>(last.day())) + " days");
  }
  return CivilSeconds{chr::sys_days(date).time_since_epoch().count()} * kDay;
}

/// "Wed 10.04.24", as office programs write dates: the weekday tells days from months where both could be,
/// and that the century is right.
Result<CivilSeconds> parse_day_of_week(std::string_view text, std::string_view date, DateOrder order,
                                       unsigned weekday) {
  std::optional<Error> error;
  std::vector<CivilSeconds> days, fitting;
  for (const DateOrder tried : {DateOrder::day_month_year, DateOrder::month_day_year}) {
    if (order != DateOrder::unknown && tried != order) continue;
    const auto parts = parse_date_parts(text, date, tried, true);
    const auto day = parts ? date_seconds(text, *parts) : tl::unexpected<Error>(parts.error());
    if (!day) {
      if (!error) error = day.error();
      continue;
    }
    days.push_back(*day);
    if (weekday_at(*day) == weekday && (fitting.empty() || fitting.back() != *day)) fitting.push_back(*day);
  }
  if (fitting.size() == 1) return fitting.front();
  if (days.empty()) return tl::unexpected<Error>(std::move(*error));
  const std::string wanted(kWeekdays[weekday]);
  if (fitting.size() == 2) {
    return bad(text, "may be day or month first, a " + wanted +
                         " both; write YYYY-MM-DD, or say --date-order dmy or mdy");
  }
  return bad(text, "is no " + wanted + " but a " + std::string(kWeekdays[weekday_at(days.front())]));
}

/// HH:MM, HH:MM:SS, a fraction of the last is dropped.
Result<CivilSeconds> parse_clock(std::string_view text, std::string_view clock) {
  if (clock.ends_with('Z') || clock.ends_with('z')) clock.remove_suffix(1);
  if (clock.find_first_of("+-") != std::string_view::npos)
    return bad(text, "has a time zone; write the time of the site without one");
  std::array<unsigned, 3> parts{};
  std::size_t count = 0;
  const std::string_view whole = clock.substr(0, clock.find_first_of(".,"));
  for (std::size_t begin = 0; begin <= whole.size();) {
    const std::size_t end = std::min(whole.find(':', begin), whole.size());
    const std::string_view part = whole.substr(begin, end - begin);
    if (count == 3 || part.size() > 2 || !all_digits(part))
      return bad(text, "wanted a time HH:MM or HH:MM:SS behind the date");
    parts[count++] = number_of(part);
    begin = end + 1;
  }
  if (count < 2 || (whole.size() < clock.size() && !all_digits(clock.substr(whole.size() + 1))))
    return bad(text, "wanted a time HH:MM or HH:MM:SS behind the date");
  const CivilSeconds out = CivilSeconds{parts[0]} * 3600 + parts[1] * 60 + parts[2];
  if (parts[1] > 59 || parts[2] > 59 || out > kDay) return bad(text, "a day goes from 00:00 to 24:00");
  return out;
}

struct Unit {
  std::string_view words;  ///< between blanks
  double seconds;
};
constexpr std::array<Unit, 4> kUnits{{{" d day days ed eday edays dy dys ", kDay},
                                      {" w wk wks week weeks ew ewk ewks ", 7.0 * kDay},
                                      {" h hr hrs hour hours eh ehr ehrs ", 3600},
                                      {" min mins minute minutes emin emins ", 60}}};
constexpr std::string_view kWantedDuration =
    "wanted a duration: a number of days, or with a unit w, d, h or min (5, 2w, 8h, PT8H)";

/// P5DT8H30M: designators in this order, each at most once.
Result<CivilSeconds> parse_iso_duration(std::string_view text) {
  constexpr std::string_view kDesignators = "YMWDTHMS";
  constexpr std::array<double, 8> kSeconds{-1, -1, 7.0 * kDay, kDay, 0, 3600, 60, 1};
  std::size_t next = 0;
  double total = 0;
  std::string_view rest = text.substr(1);
  if (rest.empty()) return bad(text, std::string(kWantedDuration));
  while (!rest.empty()) {
    if (rest[0] == 'T' && next <= 4 && rest.size() > 1) {
      next = 5;
      rest.remove_prefix(1);
      continue;
    }
    double value = 0;
    const auto [end, code] =
        std::from_chars(rest.data(), rest.data() + rest.size(), value, std::chars_format::fixed);
    const auto used = static_cast<std::size_t>(end - rest.data());
    if (code != std::errc() || used == rest.size() || rest[0] == '-')
      return bad(text, std::string(kWantedDuration));
    const std::size_t unit = kDesignators.find(rest[used], next);
    if (unit == std::string_view::npos || unit == 4 || (next < 5 && unit > 4))
      return bad(text, std::string(kWantedDuration));
    if (kSeconds[unit] < 0 && value != 0)
      return bad(text, "months and years differ in length; say it in days");
    total += value * std::max(0.0, kSeconds[unit]);
    next = unit + 1;
    rest.remove_prefix(used + 1);
  }
  return whole_seconds(total, text);
}

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return out;
}

constexpr std::array<std::string_view, 4> kLinkKinds{"FS", "SS", "FF", "SF"};

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

std::string plain_word(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == ' ' || c == '_' || c == '-' || c == '\t' || c == '\n' || c == '\r') continue;
    out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return out;
}

Result<CivilSeconds> whole_seconds(double seconds, std::string_view text) {
  if (!(std::abs(seconds) <= kMostSeconds)) return bad(text, "is longer than 100 years");
  return static_cast<CivilSeconds>(std::llround(seconds));
}

namespace {

Result<CivilSeconds> parse_day(std::string_view text, std::string_view date, DateOrder order) {
  const std::size_t end = date.find_first_of(" ,.");
  if (end != std::string_view::npos) {
    if (const auto weekday = weekday_of(date.substr(0, end))) {
      const std::size_t rest = std::min(date.find_first_not_of(" ,.", end), date.size());
      return parse_day_of_week(text, date.substr(rest), order, *weekday);
    }
  }
  auto parts = parse_date_parts(text, date, order, false);
  return parts ? date_seconds(text, *parts) : forward_error(parts);
}

}  // namespace

Result<Moment> parse_moment(std::string_view text, DateOrder order) {
  const std::string_view whole = trimmed(text);
  const std::size_t colon = whole.find(':');
  std::string_view date = whole, clock;
  if (colon != std::string_view::npos) {
    const std::size_t gap = whole.substr(0, colon).find_last_of("Tt ");
    if (gap == std::string_view::npos) return bad(text, std::string(kWantedDate));
    date = trimmed(whole.substr(0, gap));
    clock = whole.substr(gap + 1);
  }
  auto seconds = parse_day(whole, date, order);
  if (!seconds) return forward_error(seconds);
  if (clock.empty()) return Moment{*seconds, false};
  auto of_day = parse_clock(whole, clock);
  if (!of_day) return forward_error(of_day);
  return Moment{*seconds + *of_day, true};
}

std::string moment_text(CivilSeconds at_s) {
  namespace chr = std::chrono;
  const CivilSeconds days = at_s >= 0 ? at_s / kDay : -((kDay - 1 - at_s) / kDay);
  const chr::year_month_day date{chr::sys_days(chr::days(days))};
  const auto padded = [](unsigned value, std::size_t width) {
    std::string out = std::to_string(value);
    return std::string(out.size() < width ? width - out.size() : 0, '0') + out;
  };
  std::string out = padded(static_cast<unsigned>(static_cast<int>(date.year())), 4) + "-" +
                    padded(static_cast<unsigned>(date.month()), 2) + "-" +
                    padded(static_cast<unsigned>(date.day()), 2);
  const auto of_day = static_cast<unsigned>(at_s - days * kDay);
  if (of_day == 0) return out;
  return out + "T" + padded(of_day / 3600, 2) + ":" + padded(of_day / 60 % 60, 2) + ":" +
         padded(of_day % 60, 2);
}

Result<CivilSeconds> parse_duration(std::string_view text) {
  std::string_view rest = trimmed(text);
  if (rest.ends_with('?')) rest = trimmed(rest.substr(0, rest.size() - 1));  // MS Project: estimated
  if (rest.starts_with('P')) return parse_iso_duration(rest);
  double value = 0;
  const auto [end, code] =
      std::from_chars(rest.data(), rest.data() + rest.size(), value, std::chars_format::fixed);
  if (code != std::errc()) return bad(text, std::string(kWantedDuration));
  if (value < 0 || rest[0] == '-') return bad(text, "a duration cannot be negative");
  const std::string unit = plain_word(rest.substr(static_cast<std::size_t>(end - rest.data())));
  if (unit.empty()) return whole_seconds(value * kDay, text);
  for (const Unit& known : kUnits) {
    if (known.words.find(" " + unit + " ") != std::string_view::npos)
      return whole_seconds(value * known.seconds, text);
  }
  return bad(text, std::string(kWantedDuration));
}

Result<LinkText> parse_link(std::string_view text) {
  LinkText out;
  std::string_view head = trimmed(text);
  const auto kind_at_end = [](std::string_view of) -> std::size_t {
    if (of.size() < 2) return kLinkKinds.size();
    const std::string last = upper(of.substr(of.size() - 2));
    return static_cast<std::size_t>(std::find(kLinkKinds.begin(), kLinkKinds.end(), last) -
                                    kLinkKinds.begin());
  };
  if (const std::size_t sign = head.find_last_of("+-"); sign != std::string_view::npos && sign > 0) {
    const std::string_view before = trimmed(head.substr(0, sign));
    auto lag = parse_duration(head.substr(sign + 1));
    if (!lag && kind_at_end(before) < kLinkKinds.size()) return forward_error(lag);
    if (lag) {
      out.lag_s = head[sign] == '-' ? -*lag : *lag;
      head = before;
    }
  }
  out.lag_without_kind = head.size() < trimmed(text).size();
  if (const std::size_t kind = kind_at_end(head); kind < kLinkKinds.size() && head.size() > 2) {
    out.lag_without_kind = false;
    out.kind = static_cast<LinkKind>(kind);
    head = trimmed(head.substr(0, head.size() - 2));
  }
  out.id = head;
  return out;
}

namespace {

struct TypeWords {
  Profile profile;
  std::string_view words;  ///< between blanks, plain
};
/// IfcTaskTypeEnum of IFC4 and IFC4.3, Navisworks TimeLiner, and what people write.
constexpr std::array<TypeWords, kProfileCount> kTypes{{
    {Profile::construct,
     " construct construction install installation build erect erection assemble assembly new create "},
    {Profile::demolish,
     " demolish demolition dismantle dismantling remove removal disposal destroy destruction deconstruct "},
    {Profile::temporary, " temporary temp scaffold scaffolding "},
    {Profile::move, " move moving relocate relocation transport "},
    {Profile::operate,
     " operate operation maintenance maintain renovation renovate attendance logistic logistics inspection "
     "testing calibration commissioning adjustment emergency safety shutdown startup troubleshooting "},
    {Profile::neutral, " neutral none userdefined notdefined other milestone "},
    {Profile::appear, " appear appearance show "},
    {Profile::drop, " drop lower lowering "},
}};

}  // namespace

Result<Profile> parse_task_type(std::string_view text) {
  const std::string plain = plain_word(text);
  if (plain.find(' ') == std::string::npos && !plain.empty()) {
    for (const TypeWords& type : kTypes) {
      if (type.words.find(" " + plain + " ") != std::string_view::npos) return type.profile;
    }
  }
  std::string what = "unknown type " + in_quotes(text);
  std::string list;
  std::string_view nearest;
  std::size_t least = plain.size() / 3 + 1;
  for (const TypeWords& type : kTypes) {
    const std::string_view word = name(type.profile);
    if (const std::size_t distance = edit_distance(plain.substr(0, 40), word); distance < least) {
      least = distance;
      nearest = word;
    }
    list.append(list.empty() ? "" : ", ").append(word);
  }
  if (!nearest.empty()) what += " (did you mean '" + std::string(nearest) + "'? one of: ";
  return fail(ErrorKind::bad_input, "", what + (nearest.empty() ? " (one of: " : "") + list + ")");
}

}  // namespace scenegen::timeline
