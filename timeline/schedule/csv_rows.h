// Records of a CSV file with the lines that they begin on. Private to timeline/schedule.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/result.h"

namespace scenegen::timeline {

struct CsvRow {
  std::uint64_t line = 0;  ///< of its first character, from 1
  std::vector<std::string> cells;
};

/// RFC 4180 by libcsv in its strict mode: fields between `,` `;` or tabs (whichever the first line has most
/// of; a first line "sep=;" says it), quoted or not, blanks round unquoted ones dropped, empty lines left
/// out, a byte order mark allowed. Stops at the first error of `take`. Errors: not UTF-8 (with line and
/// column), wrong quotes, a quote that is not closed.
[[nodiscard]] Result<void> read_csv(std::string_view bytes, const std::string& name,
                                    const std::function<Result<void>(CsvRow&)>& take);

/// "plan.csv: line 7"
[[nodiscard]] std::string at_line(const std::string& name, std::uint64_t line);

}  // namespace scenegen::timeline
