// Words and numbers as a person writes and reads them on a command line.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/result.h"

namespace scenegen::tools {

/// Decimal digits only: "16". The error says what was wrong ("'1.5' is not a whole number"), its `where` is
/// empty.
[[nodiscard]] Result<std::uint64_t> parse_whole(std::string_view text, std::uint64_t least,
                                                std::uint64_t most);
/// A finite decimal number, nothing behind it: "0.95", "1e-3".
[[nodiscard]] Result<double> parse_real(std::string_view text, double least, double most);
/// "4x4", "16x16x16": exactly `count` parts between `x`. The error shows `form` ("WxL").
[[nodiscard]] Result<std::vector<std::string_view>> split_size(std::string_view text, std::size_t count,
                                                               std::string_view form);

/// Shortest digits that read back as the same double: "0.1", "1000000"; with an exponent below 1e-6 and from
/// 1e15 on.
[[nodiscard]] std::string shortest(double value);
/// The shortest text that reads back as the same float32: 41.74, not 41.7400016784668.
[[nodiscard]] std::string shortest_float(float value);

/// The candidate that `text` was most likely meant to be, or "" when none is near: optimal string alignment
/// distance (Damerau 1964) of at most a third of its length, or `text` is the beginning of exactly one
/// candidate.
[[nodiscard]] std::string nearest_word(std::string_view text, std::span<const std::string> candidates);
/// "unknown value 'hilber' (did you mean 'hilbert'? one of: hilbert, morton, row-prime)"
[[nodiscard]] std::string unknown_word(std::string_view kind, std::string_view text,
                                       std::span<const std::string> candidates);
[[nodiscard]] std::string join(std::span<const std::string> words, std::string_view separator);

/// Decimal units, two significant digits or more: "512 B", "5.1 MB", "1.20 GB".
[[nodiscard]] std::string human_bytes(std::uint64_t bytes);
/// Groups of three digits: "38 016".
[[nodiscard]] std::string human_count(std::uint64_t count);
/// "1 object", "38 016 objects"; `many`: a plural that is not made with an s.
[[nodiscard]] std::string counted(std::uint64_t count, const std::string& one, const std::string& many = {});
/// "0.21 s", "12.5 s", "3 min 05 s".
[[nodiscard]] std::string human_seconds(double seconds);
/// `digits` behind the point, trailing zeros dropped: (0.95, 3) is "0.95".
[[nodiscard]] std::string human_real(double value, int digits);

/// What makes a JSON text unlike any of ours, empty if nothing does; for use before parsing. "is nested
/// deeper than 64 levels": nlohmann copies and destroys values by recursion, which a file of 200 000 brackets
/// would end on the stack. "has an object of more than 1000 members": they are compared with each other.
[[nodiscard]] std::string_view json_excess(std::string_view json);

/// Breaks at blanks so that no line is longer than `width` characters (UTF-8 code points).
[[nodiscard]] std::vector<std::string> wrap(std::string_view text, std::size_t width);
/// Characters (code points) of a UTF-8 string: what a column of text takes on a terminal.
[[nodiscard]] std::size_t display_width(std::string_view text);

}  // namespace scenegen::tools
