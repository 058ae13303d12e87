// The look of reports.
#pragma once

#include <string_view>

namespace scenegen::tools {

/// Light and dark, screens from 320 pixels on, and paper.
[[nodiscard]] std::string_view report_style();

}  // namespace scenegen::tools
