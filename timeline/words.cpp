#include "timeline/words.h"

#include <simdjson.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace scenegen::timeline {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMost = 60;
  std::size_t end = std::min(text.size(), kMost);
  while (end < text.size() && end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  const bool utf8 = simdjson::validate_utf8(text.data(), end);
  std::string out = "'";
  for (const char c : text.substr(0, end)) {
    const auto byte = static_cast<unsigned char>(c);
    out += byte < 0x20 || byte == 0x7F || (byte > 0x7F && !utf8) ? '?' : c;
  }
  return out + (end < text.size() ? "...'" : "'");
}

std::string unknown_word(std::string_view kind, std::string_view text,
                         std::span<const std::string_view> known) {
  const std::string_view beginning = text.substr(0, 40);
  const std::string_view nearest =
      *std::min_element(known.begin(), known.end(), [&](std::string_view a, std::string_view b) {
        return edit_distance(beginning, a) < edit_distance(beginning, b);
      });
  std::string out = "unknown " + std::string(kind) + " " + in_quotes(text) + " (did you mean '" +
                    std::string(nearest) + "'? one of: ";
  for (std::size_t i = 0; i < known.size(); ++i) out.append(i == 0 ? "" : ", ").append(known[i]);
  return out + ")";
}

}  // namespace scenegen::timeline
