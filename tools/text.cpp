#include "tools/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace scenegen::tools {

namespace {

std::string quoted(std::string_view text) {
  constexpr std::size_t kMost = 60;  // a pasted file must not become the error message
  std::string out = "'";
  for (const char c : text.substr(0, kMost))
    out += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  if (text.size() > kMost) out += "...";
  return out + "'";
}

std::string out_of_range(std::string_view text, const std::string& least, const std::string& most,
                         bool too_small) {
  return std::string(text) + " is out of range (" + least + " to " + most +
         "; nearest: " + (too_small ? least : most) + ")";
}

bool all_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

Result<std::uint64_t> parse_whole(std::string_view text, std::uint64_t least, std::uint64_t most) {
  const bool negative = text.size() > 1 && text[0] == '-';
  if (!all_digits(negative ? text.substr(1) : text)) {
    return fail(ErrorKind::usage, "", quoted(text) + " is not a whole number");
  }
  std::uint64_t value = 0;
  const auto [end, code] =
      std::from_chars(text.data() + (negative ? 1 : 0), text.data() + text.size(), value);
  const bool too_large = code == std::errc::result_out_of_range || value > most;
  const bool too_small = (negative && (too_large || value > 0)) || (!too_large && value < least);
  if (too_small || too_large) {
    return fail(ErrorKind::usage, "",
                out_of_range(text, std::to_string(least), std::to_string(most), too_small));
  }
  return value;
}

Result<double> parse_real(std::string_view text, double least, double most) {
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole_text = end == text.data() + text.size() && !text.empty();
  if (!whole_text || code == std::errc::invalid_argument) {
    return fail(ErrorKind::usage, "", quoted(text) + " is not a number");
  }
  if (code == std::errc::result_out_of_range) {
    return fail(ErrorKind::usage, "",
                quoted(text) + " does not fit a number (" + shortest(least) + " to " + shortest(most) + ")");
  }
  if (!std::isfinite(value)) return fail(ErrorKind::usage, "", quoted(text) + " is not a finite number");
  if (value < least || value > most) {
    return fail(ErrorKind::usage, "", out_of_range(text, shortest(least), shortest(most), value < least));
  }
  return value == 0 ? 0.0 : value;  // no negative zero
}

Result<std::vector<std::string_view>> split_size(std::string_view text, std::size_t count,
                                                 std::string_view form) {
  std::vector<std::string_view> parts;
  std::string_view rest = text;
  while (parts.size() <= count) {
    const std::size_t cut = rest.find('x');
    parts.push_back(rest.substr(0, cut));
    if (cut == std::string_view::npos) break;
    rest.remove_prefix(cut + 1);
  }
  const bool empty_part =
      std::any_of(parts.begin(), parts.end(), [](std::string_view p) { return p.empty(); });
  if (parts.size() != count || empty_part) {
    return fail(ErrorKind::usage, "", quoted(text) + " is not of the form " + std::string(form));
  }
  return parts;
}

std::string shortest_float(float value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const double size = std::abs(value);
  const bool plain = size == 0 || (size >= 1e-6 && size < 1e15);
  char* const limit = buffer.data() + buffer.size();
  const auto [end, code] = plain ? std::to_chars(buffer.data(), limit, value, std::chars_format::fixed)
                                 : std::to_chars(buffer.data(), limit, value);
  return {buffer.data(), end};
}

namespace {

/// Optimal string alignment: insertions, deletions, substitutions, swaps of neighbours.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, substituted});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string nearest_word(std::string_view text, std::span<const std::string> candidates) {
  constexpr std::size_t kLongest = 64;  // longer is no slip of the fingers
  if (text.empty() || text.size() > kLongest) return {};
  const std::string* best = nullptr;
  std::size_t best_distance = 0;
  std::size_t starting_so = 0;
  const std::string* start = nullptr;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(text, candidate);
    if (best == nullptr || distance < best_distance) {
      best = &candidate;
      best_distance = distance;
    }
    if (candidate.starts_with(text)) {
      ++starting_so;
      start = &candidate;
    }
  }
  if (best == nullptr) return {};
  if (best_distance <= std::max<std::size_t>(1, best->size() / 3) && best_distance < best->size())
    return *best;
  return starting_so == 1 ? *start : std::string();
}

std::string unknown_word(std::string_view kind, std::string_view text,
                         std::span<const std::string> candidates) {
  const std::string nearest = nearest_word(text, candidates);
  std::string out = "unknown " + std::string(kind) + " " + quoted(text) + " (";
  if (!nearest.empty()) out += "did you mean '" + nearest + "'? ";
  return out + "one of: " + join(candidates, ", ") + ")";
}

std::string join(std::span<const std::string> words, std::string_view separator) {
  std::string out;
  for (const std::string& word : words) {
    if (!out.empty()) out += separator;
    out += word;
  }
  return out;
}

std::string human_bytes(std::uint64_t bytes) {
  constexpr std::array kUnits{"kB", "MB", "GB", "TB", "PB", "EB"};
  if (bytes < 1000) return std::to_string(bytes) + " B";
  auto value = static_cast<double>(bytes) / 1000;
  std::size_t unit = 0;
  while (value >= 999.5 && unit + 1 < kUnits.size()) {
    value /= 1000;
    ++unit;
  }
  std::array<char, 32> buffer{};
  (void)std::snprintf(buffer.data(), buffer.size(), value < 99.95 ? "%.1f %s" : "%.0f %s", value,
                      kUnits[unit]);
  return buffer.data();
}

std::string human_count(std::uint64_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ' ');
  return digits;
}

std::string counted(std::uint64_t count, const std::string& one, const std::string& many) {
  return human_count(count) + " " + (count == 1 ? one : many.empty() ? one + "s" : many);
}

std::string human_seconds(double seconds) {
  std::array<char, 48> buffer{};
  if (seconds >= 99.95) {
    const auto whole = static_cast<std::uint64_t>(std::llround(seconds));
    (void)std::snprintf(buffer.data(), buffer.size(), "%llu min %02llu s",
                        static_cast<unsigned long long>(whole / 60),
                        static_cast<unsigned long long>(whole % 60));
  } else {
    (void)std::snprintf(buffer.data(), buffer.size(), seconds < 9.995 ? "%.2f s" : "%.1f s", seconds);
  }
  return buffer.data();
}

std::string human_real(double value, int digits) {
  std::array<char, 400> buffer{};  // the longest finite double takes 309 digits before the point
  (void)std::snprintf(buffer.data(), buffer.size(), "%.*f", digits, value);
  std::string out = buffer.data();
  if (out.find('.') != std::string::npos) {
    while (out.back() == '0') out.pop_back();
    if (out.back() == '.') out.pop_back();
  }
  return out;
}

std::size_t display_width(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::vector<std::string> wrap(std::string_view text, std::size_t width) {
  std::vector<std::string> lines(1);
  while (!text.empty()) {
    const std::size_t cut = std::min(text.find(' '), text.size());
    const std::string_view word = text.substr(0, cut);
    text.remove_prefix(std::min(cut + 1, text.size()));
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (display_width(line) + 1 + display_width(word) <= width) {
      line.append(" ").append(word);
    } else {
      lines.emplace_back(word);
    }
  }
  return lines;
}

std::string_view json_excess(std::string_view json) {
  constexpr std::size_t kMostLevels = 64;
  constexpr std::uint32_t kMostMembers = 1000;
  std::array<std::uint32_t, kMostLevels + 1> members{};
  std::size_t depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (depth == kMostLevels) return "is nested deeper than 64 levels";
      members[++depth] = 0;
    } else if (c == ']' || c == '}') {
      if (depth > 0) --depth;
    } else if (c == ':') {
      if (++members[depth] > kMostMembers) return "has an object of more than 1000 members";
    }
  }
  return {};
}

}  // namespace scenegen::tools
