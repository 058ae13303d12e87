#include "tools/report/chart.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "tools/report/axis.h"
#include "tools/report/report.h"
#include "tools/text.h"

namespace scenegen::tools {
namespace {

constexpr double kFont = 13;  // as in the style sheet
// More points than pixels say no more; the page would only be slow.
constexpr std::size_t kMostDrawn = 1500;
// Markers and whiskers of more points than this run into each other: then there is a band.
constexpr std::size_t kMostMarked = 40;

std::string number(double value) {
  std::array<char, 32> buffer{};
  (void)std::snprintf(buffer.data(), buffer.size(), "%.1f", value);
  const std::string out = buffer.data();
  return out == "-0.0" ? "0.0" : out;
}

/// "octree (D 5.6)" and "Octree" are one.
std::string plain_name(const std::string& name) {
  std::string out = name.substr(0, name.find('('));
  while (!out.empty() && out.back() == ' ') out.pop_back();
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::size_t stride_of(const Series& series) {
  return (series.points.size() + kMostDrawn - 1) / kMostDrawn;
}

/// How far up spreads may reach: one frame that took thirty times as long would press all curves flat. Charts
/// with a logarithmic axis show it.
double spread_limit(const Chart& chart) {
  constexpr double kMost = 2;  // of the highest point
  double highest = -INFINITY;
  for (const Series& series : chart.series) {
    for (const ChartPoint& point : series.points) {
      if (std::isfinite(point.y)) highest = std::max(highest, point.y);
    }
  }
  return chart.log_y || !(highest > 0) ? INFINITY : kMost * highest;
}

/// Where things are on the drawing.
struct Plot {
  const Chart& chart;
  Axis x, y;
  double left = 0, right = 0, top = 0, bottom = 0;

  // Markers at the ends must not run out of the drawing.
  [[nodiscard]] double px(double value) const { return left + 8 + x.place(value) * (right - left - 16); }
  [[nodiscard]] double py(double value) const {
    const double foot = y.log ? 8 : 0;
    return bottom - foot - y.place(value) * (bottom - foot - top - 4);
  }
  /// An end of a spread, cut at the top of the drawing.
  [[nodiscard]] double cut(double end) const { return std::min(end, y.high); }
  [[nodiscard]] std::string at(double vx, double vy) const { return number(px(vx)) + " " + number(py(vy)); }
  [[nodiscard]] bool shows(const ChartPoint& point) const { return x.shows(point.x) && y.shows(point.y); }
  /// What of a series is drawn.
  [[nodiscard]] std::vector<ChartPoint> drawn(const Series& series) const {
    std::vector<ChartPoint> out;
    const std::size_t stride = std::max<std::size_t>(1, stride_of(series));
    for (std::size_t i = 0; i < series.points.size(); i += stride) {
      if (shows(series.points[i])) out.push_back(series.points[i]);
    }
    return out;
  }
};

Plot make_plot(const Chart& chart, const ChartSize& size) {
  std::vector<double> xs;
  std::vector<double> ys;
  for (const Series& series : chart.series) {
    for (const ChartPoint& point : series.points) {
      xs.push_back(point.x);
      ys.push_back(point.y);
    }
  }
  const double most = spread_limit(chart);
  for (const Series& series : chart.series) {
    for (const ChartPoint& point : series.points) {
      if (point.low) ys.push_back(std::min(*point.low, most));
      if (point.high) ys.push_back(std::min(*point.high, most));
    }
  }
  // Numbers of views or of frames have nothing between them.
  const bool whole = std::all_of(xs.begin(), xs.end(), [](double x) { return x == std::floor(x); });
  const int wanted_x = std::max(3, static_cast<int>(size.width / 75));
  Plot out{chart, make_axis(xs, {chart.log_x, wanted_x, false, false, whole}),
           make_axis(ys, {chart.log_y, chart.log_y ? 8 : 6, true, true})};
  std::size_t widest = 1;
  for (const double tick : out.y.ticks) widest = std::max(widest, display_width(out.y.text(tick)));
  out.left = 12 + 0.6 * kFont * static_cast<double>(widest);
  out.right = size.width - 16;
  out.top = chart.y_title.empty() ? 12 : 12 + 1.6 * kFont;
  out.bottom = size.height - (chart.x_title.empty() ? 2.0 : 3.6) * kFont;
  return out;
}

std::string text_at(double x, double y, std::string_view classes, std::string_view text) {
  return "<text class=\"" + std::string(classes) + "\" x=\"" + number(x) + "\" y=\"" + number(y) + "\">" +
         escaped(text) + "</text>";
}

std::string axes_svg(const Plot& plot) {
  std::string lines;
  std::string texts;
  for (const double tick : plot.y.ticks) {
    const double y = plot.py(tick);
    lines += "M" + number(plot.left) + " " + number(y) + "H" + number(plot.right);
    texts += text_at(plot.left - 8, y + 0.35 * kFont, "tick end", plot.y.text(tick));
  }
  std::string marks;
  for (const double tick : plot.x.ticks) {
    const double x = plot.px(tick);
    marks += "M" + number(x) + " " + number(plot.bottom) + "v5";
    texts += text_at(x, plot.bottom + 1.5 * kFont, "tick middle", plot.x.text(tick));
  }
  const std::string foot = "M" + number(plot.left) + " " + number(plot.bottom) + "H" + number(plot.right);
  std::string out =
      "<path class=\"grid\" d=\"" + lines + "\"/><path class=\"axis\" d=\"" + foot + marks + "\"/>" + texts;
  if (!plot.chart.y_title.empty()) out += text_at(2, 1.1 * kFont, "axis-title", plot.chart.y_title);
  if (!plot.chart.x_title.empty())
    out += text_at((plot.left + plot.right) / 2, plot.bottom + 3.1 * kFont, "axis-title middle",
                   plot.chart.x_title);
  return out;
}

std::string marker_path(std::size_t color, double x, double y) {
  const auto n = [](double value) { return number(value); };
  switch (color % 4) {
    case 0:
      return "M" + n(x - 4) + " " + n(y) + "a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z";
    case 1:
      return "M" + n(x - 3.6) + " " + n(y - 3.6) + "h7.2v7.2h-7.2z";
    case 2:
      return "M" + n(x) + " " + n(y - 4.8) + "l4.8 8.2h-9.6z";
    default:
      return "M" + n(x) + " " + n(y - 5) + "l5 5l-5 5l-5 -5z";
  }
}

std::string band_svg(const Plot& plot, const std::vector<ChartPoint>& points, const std::string& classes) {
  std::string there;
  std::string back;
  for (const ChartPoint& point : points) {
    const auto spread = [&](const std::optional<double>& end) {
      return end && plot.y.shows(*end) ? plot.cut(*end) : point.y;
    };
    there += (there.empty() ? "M" : "L") + plot.at(point.x, spread(point.high));
    back.insert(0, "L" + plot.at(point.x, spread(point.low)));
  }
  return "<path class=\"band " + classes + "\" d=\"" + there + back + "z\"/>";
}

std::string whiskers_svg(const Plot& plot, const std::vector<ChartPoint>& points,
                         const std::string& classes) {
  std::string path;
  for (const ChartPoint& point : points) {
    const double low = point.low.value_or(point.y);
    const double high = point.high.value_or(point.y);
    if (!(low < high) || !plot.y.shows(low) || !plot.y.shows(high)) continue;
    const double x = plot.px(point.x);
    for (const double end : {low, high}) {
      if (plot.cut(end) == end) path += "M" + number(x - 3) + " " + number(plot.py(end)) + "h6";
    }
    path += "M" + plot.at(point.x, plot.cut(low)) + "V" + number(plot.py(plot.cut(high)));
  }
  return path.empty() ? path : "<path class=\"whisker " + classes + "\" d=\"" + path + "\"/>";
}

/// "octree: 3.21 (3.1 to 3.4) at 0.5", shown where the pointer rests.
std::string point_text(const Series& series, const ChartPoint& point) {
  std::string out = series.name + ": " + figure_text(point.y);
  if (point.low && point.high)
    out += " (" + figure_text(*point.low) + " to " + figure_text(*point.high) + ")";
  return out + " at " + figure_text(point.x);
}

std::string series_svg(const Plot& plot, const Series& series, std::size_t color) {
  const std::vector<ChartPoint> points = plot.drawn(series);
  if (points.empty()) return {};
  const std::string classes =
      "s" + std::to_string(color % kSeriesColors) + (series.origin == Origin::paper ? " paper" : "");
  const bool spread =
      std::any_of(points.begin(), points.end(), [](const ChartPoint& p) { return p.low || p.high; });
  const bool marked = points.size() <= kMostMarked;
  std::string out;
  if (spread && points.size() > 1) out += band_svg(plot, points, classes);
  if (spread && marked) out += whiskers_svg(plot, points, classes);
  std::string line;
  for (const ChartPoint& point : points) line += (line.empty() ? "M" : "L") + plot.at(point.x, point.y);
  if (points.size() > 1) out += "<path class=\"line " + classes + "\" d=\"" + line + "\"/>";
  if (!marked) return out;
  for (const ChartPoint& point : points) {
    out += "<path class=\"marker " + classes + "\" d=\"" +
           marker_path(color, plot.px(point.x), plot.py(point.y)) + "\"><title>" +
           escaped(point_text(series, point)) + "</title></path>";
  }
  return out;
}

/// For those who do not see it: what is joined by what, and between which values.
std::string description(const Chart& chart, const Plot& plot) {
  std::string out = chart.y_title + " over " + chart.x_title + ".";
  for (const Series& series : chart.series) {
    double low = INFINITY;
    double high = -INFINITY;
    for (const ChartPoint& point : series.points) {
      if (!plot.shows(point)) continue;
      low = std::min(low, point.y);
      high = std::max(high, point.y);
    }
    out += " " + series.name + (series.origin == Origin::paper ? " (the paper's)" : "") + ": ";
    out += low <= high ? counted(series.points.size(), "point") + " from " + figure_text(low) + " to " +
                             figure_text(high) + "."
                       : "no point.";
  }
  return out;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        // Control characters are no characters of HTML.
        out += (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') || c == 0x7F ? '?' : c;
    }
  }
  return out;
}

std::vector<std::size_t> series_colors(const Chart& chart) {
  std::vector<std::size_t> out(chart.series.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    if (chart.series[i].origin == Origin::ours) out[i] = next++;
  }
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    if (chart.series[i].origin == Origin::ours) continue;
    const std::string name = plain_name(chart.series[i].name);
    const auto same = std::find_if(chart.series.begin(), chart.series.end(), [&](const Series& other) {
      return other.origin == Origin::ours && plain_name(other.name) == name;
    });
    out[i] = same != chart.series.end() ? out[static_cast<std::size_t>(same - chart.series.begin())] : next++;
  }
  return out;
}

std::string chart_svg(const Chart& chart, const std::string& id, const ChartSize& size) {
  const Plot plot = make_plot(chart, size);
  const std::string unique = escaped(id) + "." + size.name;  // no id of a document has a point
  std::string out = "<svg class=\"chart " + size.name + "\" viewBox=\"0 0 " + number(size.width) + " " +
                    number(size.height) + "\" role=\"img\" aria-labelledby=\"" + unique + ".t " + unique +
                    ".d\"><title id=\"" + unique + ".t\">" + escaped(chart.title) + "</title><desc id=\"" +
                    unique + ".d\">" + escaped(description(chart, plot)) + "</desc>";
  out += axes_svg(plot);
  const std::vector<std::size_t> colors = series_colors(chart);
  // Ours are drawn last, over the paper's.
  for (const Origin origin : {Origin::paper, Origin::ours}) {
    for (std::size_t i = 0; i < chart.series.size(); ++i) {
      if (chart.series[i].origin == origin) out += series_svg(plot, chart.series[i], colors[i]);
    }
  }
  return out + "</svg>\n";
}

std::string series_swatch(std::size_t color, Origin origin) {
  const std::string classes =
      "s" + std::to_string(color % kSeriesColors) + (origin == Origin::paper ? " paper" : "");
  return "<svg class=\"swatch\" viewBox=\"0 0 34 14\" aria-hidden=\"true\"><path class=\"line " + classes +
         "\" d=\"M1 7H33\"/><path class=\"marker " + classes + "\" d=\"" + marker_path(color, 17, 7) +
         "\"/></svg>";
}

std::string left_out(const Chart& chart) {
  const Plot plot = make_plot(chart, {"", 600, 400});
  std::size_t hidden = 0;
  std::size_t stride = 1;
  for (const Series& series : chart.series) {
    hidden += static_cast<std::size_t>(std::count_if(series.points.begin(), series.points.end(),
                                                     [&](const ChartPoint& p) { return !plot.shows(p); }));
    stride = std::max(stride, stride_of(series));
  }
  double reach = 0;
  for (const Series& series : chart.series) {
    for (const ChartPoint& point : series.points) {
      if (point.high && plot.shows(point) && plot.y.shows(*point.high)) reach = std::max(reach, *point.high);
    }
  }
  std::string out;
  if (reach > plot.y.high)
    out += "A spread that reaches up to " + figure_text(reach) + " is cut at the top. ";
  if (hidden > 0)
    out += counted(hidden, "point") + (hidden == 1 ? " is" : " are") +
           " not drawn: a logarithmic axis has no place for what is not above 0. ";
  if (stride > 1) out += "Of long curves every " + std::to_string(stride) + "th point is drawn. ";
  if (!out.empty()) out.pop_back();
  return out;
}

}  // namespace scenegen::tools
