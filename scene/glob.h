// Names with wildcards, as a shell has them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/result.h"

namespace scenegen {

/// `*` any characters, `?` one, `[abc]` `[a-z]` `[!a]` one of a set, `\*` the character itself. Characters
/// are UTF-8 code points. Time is at most the product of the two lengths: no pattern is exponential.
class Glob {
 public:
  /// Errors (usage, `where` empty): a set that does not end, a backslash at the end, not UTF-8.
  [[nodiscard]] static Result<Glob> parse(std::string_view text);
  /// Matches `text` only, whatever its characters.
  [[nodiscard]] static Glob literal(std::string_view text);

  [[nodiscard]] bool matches(std::string_view text) const;
  /// Every match begins with this.
  [[nodiscard]] const std::string& prefix() const { return prefix_; }
  /// No wildcards: matches prefix() and nothing else.
  [[nodiscard]] bool is_literal() const { return items_.empty(); }

 private:
  struct Range {
    char32_t first, last;
  };
  struct Item {
    bool star = false;
    bool negated = false;
    std::vector<Range> ranges;
  };
  [[nodiscard]] static Result<Item> parse_set(std::string_view text, std::size_t& at);
  [[nodiscard]] static bool accepts(const Item& item, char32_t c);

  std::string prefix_;
  std::vector<Item> items_;  ///< behind the prefix
};

}  // namespace scenegen
