// What error messages of this room say of words that they do not know.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace scenegen::timeline {

/// Levenshtein distance: insertions, deletions and substitutions.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// Text from outside fit for one line of output, in quotes, cut at 60 bytes (between characters);
/// what is no UTF-8 becomes question marks.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// "unknown value 'hilber' (did you mean 'hilbert'? one of: hilbert, morton, row-prime)"
[[nodiscard]] std::string unknown_word(std::string_view kind, std::string_view text,
                                       std::span<const std::string_view> known);

}  // namespace scenegen::timeline
