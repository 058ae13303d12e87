// Tables, charts and pictures of a page.
#pragma once

#include <string>

#include "tools/report/report.h"
#include "tools/report/write.h"

namespace scenegen::tools {

/// <figure>s. `run` numbers the run that the block is of.
[[nodiscard]] std::string table_html(const DocumentTable& table, std::size_t run);
[[nodiscard]] std::string chart_html(const Chart& chart, std::size_t run);
[[nodiscard]] std::string picture_html(const Picture& picture, std::size_t run, const std::string& folder,
                                       Warnings& warnings);
/// "✓ 1.8×" and what it means.
[[nodiscard]] std::string comparison_html(const Comparison& comparison);

}  // namespace scenegen::tools
