// Charts as SVG, drawn for the page of html.cpp, whose style sheet gives them their colors.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tools/report/document.h"

namespace scenegen::tools {

/// Colors that the style sheet has: classes s0, s1, ...
constexpr std::size_t kSeriesColors = 8;

/// Per series. One of the paper's has the color of ours that has the same name but for what stands in
/// brackets.
[[nodiscard]] std::vector<std::size_t> series_colors(const Chart& chart);

/// Text has the same size in all of them, so there is one for wide and one for narrow screens.
struct ChartSize {
  std::string name;  ///< class of the svg, and what its ids end with
  double width = 0, height = 0;
};
/// One <svg>. `id` is unique in the page.
[[nodiscard]] std::string chart_svg(const Chart& chart, const std::string& id, const ChartSize& size);
/// A line and a marker for the legend.
[[nodiscard]] std::string series_swatch(std::size_t color, Origin origin);
/// What the drawing leaves out, as sentences; "" when nothing.
[[nodiscard]] std::string left_out(const Chart& chart);

/// Text as HTML and XML: nothing in it is markup.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace scenegen::tools
