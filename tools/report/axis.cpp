#include "tools/report/axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tools/report/report.h"

namespace scenegen::tools {
namespace {

// Beyond these, differences and quotients of values are no numbers any more; nothing measured is that large.
constexpr double kMost = 1e100;
constexpr double kLeast = 1e-100;

/// 1, 2 or 5 times a power of ten, at least `least`.
double nice_step(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

void linear_ticks(Axis& axis, const AxisOptions& options) {
  if (options.from_zero && axis.low > 0 && axis.low < 0.7 * axis.high) axis.low = 0;
  const double middle = std::max(std::abs(axis.low), std::abs(axis.high));
  if (axis.high - axis.low <= 1e-9 * middle || axis.high - axis.low < kLeast) {
    const double half = middle > 0 ? 0.1 * middle : 1;
    axis.low -= half;
    axis.high += half;
  }
  const double least = (axis.high - axis.low) / options.wanted;
  const double step = nice_step(options.whole ? std::max(least, 1.0) : least);
  double first = std::ceil(axis.low / step - 1e-9);
  double last = std::floor(axis.high / step + 1e-9);
  if (options.to_ticks) {
    first = std::floor(axis.low / step + 1e-9);
    last = std::ceil(axis.high / step - 1e-9);
    axis.low = std::min(axis.low, first * step);
    axis.high = std::max(axis.high, last * step);
  }
  for (double k = first; k <= last; ++k) axis.ticks.push_back(k == 0 ? 0.0 : k * step);
  axis.decimals = std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 12);
}

void log_ticks(Axis& axis, int wanted) {
  if (axis.high < 1.2 * axis.low) {
    axis.low /= 1.5;
    axis.high *= 1.5;
  }
  const int first = static_cast<int>(std::floor(std::log10(axis.low)));
  const int last = static_cast<int>(std::ceil(std::log10(axis.high)));
  const auto collect = [&](std::initializer_list<double> factors, int stride) {
    axis.ticks.clear();
    for (int order = first; order <= last; ++order) {
      if (((order % stride) + stride) % stride != 0) continue;
      for (const double factor : factors) {
        const double tick = factor * std::pow(10.0, order);
        if (tick >= axis.low * (1 - 1e-9) && tick <= axis.high * (1 + 1e-9)) axis.ticks.push_back(tick);
      }
    }
  };
  collect({1, 2, 3, 4, 5, 6, 7, 8}, 1);
  if (axis.ticks.size() > static_cast<std::size_t>(wanted)) collect({1, 2, 5}, 1);
  for (int stride = 1; axis.ticks.size() > static_cast<std::size_t>(wanted); ++stride) {
    collect({1}, stride);
    if (axis.ticks.size() <= 2) break;
  }
}

}  // namespace

double Axis::place(double value) const {
  if (log) return std::log(value / low) / std::log(high / low);
  return (value - low) / (high - low);
}

bool Axis::shows(double value) const {
  return std::isfinite(value) && std::abs(value) <= kMost && (!log || value >= kLeast);
}

std::string Axis::text(double tick) const {
  constexpr std::array<const char*, 5> kSuffixes{"", "k", "M", "G", "T"};
  const double most = std::max(std::abs(low), std::abs(high));
  const double size = log ? std::abs(tick) : most;
  if (size >= 1e16 || (log && tick < 1e-4)) {
    std::array<char, 32> buffer{};
    (void)std::snprintf(buffer.data(), buffer.size(), "%.3g", tick);
    return buffer.data();
  }
  if (size < 10'000) {
    if (log) return figure_text(tick, 1);
    std::array<char, 64> buffer{};
    (void)std::snprintf(buffer.data(), buffer.size(), "%.*f", decimals, std::abs(tick));
    return (tick < 0 ? "\u2212" : "") + std::string(buffer.data());
  }
  std::size_t suffix = 0;
  double scaled = tick;
  for (double left = size; left >= 1000 && suffix + 1 < kSuffixes.size(); left /= 1000, ++suffix)
    scaled /= 1000;
  return tick == 0 ? "0" : figure_text(scaled, 3) + kSuffixes[suffix];
}

Axis make_axis(const std::vector<double>& values, const AxisOptions& options) {
  Axis out;
  out.log = options.log;
  std::vector<double> shown;
  std::copy_if(values.begin(), values.end(), std::back_inserter(shown),
               [&](double value) { return out.shows(value); });
  if (!shown.empty()) {
    const auto [least, most] = std::minmax_element(shown.begin(), shown.end());
    out.low = *least;
    out.high = *most;
  } else if (out.log) {
    out.low = 0.1;
  }
  if (out.log) {
    log_ticks(out, options.wanted);
  } else {
    linear_ticks(out, options);
  }
  return out;
}

}  // namespace scenegen::tools
