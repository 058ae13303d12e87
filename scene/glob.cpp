#include "scene/glob.h"

#include <simdjson.h>

#include <algorithm>

namespace scenegen {

namespace {

/// One code point of valid UTF-8; of text that is not, a byte (names from files are checked when read).
char32_t next_character(std::string_view text, std::size_t& at) {
  const auto byte = [&](std::size_t i) -> char32_t {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
  };
  const char32_t first = byte(at);
  const std::size_t length = first < 0xC0 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  if (length == 1 || at + length > text.size()) {
    ++at;
    return first;
  }
  char32_t out = first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) out = (out << 6) | (byte(at + i) & 0x3F);
  at += length;
  return out;
}

constexpr char32_t kMostCharacter = 0x10FFFF;

}  // namespace

Result<Glob::Item> Glob::parse_set(std::string_view text, std::size_t& at) {
  const auto unfinished = [&] {
    return fail(ErrorKind::usage, "", "the set '[' of '" + std::string(text) + "' has no ']'");
  };
  Item item;
  if (at < text.size() && (text[at] == '!' || text[at] == '^')) {
    item.negated = true;
    ++at;
  }
  for (bool first = true;; first = false) {
    if (at >= text.size()) return unfinished();
    if (text[at] == ']' && !first) break;
    if (text[at] == '\\' && at + 1 < text.size()) ++at;
    const char32_t low = next_character(text, at);
    char32_t high = low;
    if (at + 1 < text.size() && text[at] == '-' && text[at + 1] != ']') {
      ++at;
      if (text[at] == '\\' && at + 1 < text.size()) ++at;
      high = next_character(text, at);
    }
    item.ranges.push_back({low, high});
  }
  ++at;
  return item;
}

Result<Glob> Glob::parse(std::string_view text) {
  Glob out;
  if (!simdjson::validate_utf8(text.data(), text.size()))
    return fail(ErrorKind::usage, "", "a pattern is not valid UTF-8");
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == '*') {
      if (out.items_.empty() || !out.items_.back().star) out.items_.push_back({true, false, {}});
      ++at;
    } else if (text[at] == '?') {
      out.items_.push_back({false, false, {{0, kMostCharacter}}});
      ++at;
    } else if (text[at] == '[') {
      auto set = parse_set(text, ++at);
      if (!set) return forward_error(set);
      out.items_.push_back(std::move(*set));
    } else {
      if (text[at] == '\\' && ++at == text.size())
        return fail(ErrorKind::usage, "", "'" + std::string(text) + "' ends in a backslash");
      const std::size_t begin = at;
      const char32_t c = next_character(text, at);
      if (out.items_.empty()) {
        out.prefix_.append(text.substr(begin, at - begin));
      } else {
        out.items_.push_back({false, false, {{c, c}}});
      }
    }
  }
  return out;
}

Glob Glob::literal(std::string_view text) {
  Glob out;
  out.prefix_ = text;
  return out;
}

bool Glob::accepts(const Item& item, char32_t c) {
  const bool inside = std::any_of(item.ranges.begin(), item.ranges.end(),
                                  [c](const Range& r) { return r.first <= c && c <= r.last; });
  return inside != item.negated;
}

bool Glob::matches(std::string_view text) const {
  if (!text.starts_with(prefix_)) return false;
  constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t at = prefix_.size(), item = 0;
  std::size_t star = kNone, star_at = 0;  // the last star, and how far it reaches: earlier ones need not move
  while (at < text.size()) {
    if (item < items_.size() && items_[item].star) {
      star = item++;
      star_at = at;
      continue;
    }
    if (item < items_.size()) {
      std::size_t next = at;
      if (accepts(items_[item], next_character(text, next))) {
        at = next;
        ++item;
        continue;
      }
    }
    if (star == kNone) return false;
    (void)next_character(text, star_at);
    at = star_at;
    item = star + 1;
  }
  while (item < items_.size() && items_[item].star) ++item;
  return item == items_.size();
}

}  // namespace scenegen
