// The axes of a chart: which numbers stand beside them, and where a value is on them.
#pragma once

#include <string>
#include <vector>

namespace scenegen::tools {

struct Axis {
  bool log = false;
  double low = 0, high = 1;
  std::vector<double> ticks;  ///< ascending, within the axis
  int decimals = 0;           ///< of the ticks of a linear axis

  /// 0 at its low end, 1 at its high end.
  [[nodiscard]] double place(double value) const;
  /// Whether a value can be on it: a logarithmic axis has none at or below 0.
  [[nodiscard]] bool shows(double value) const;
  /// "0.5", "20k", "3M", "1e-7".
  [[nodiscard]] std::string text(double tick) const;
};

struct AxisOptions {
  bool log = false;
  int wanted = 6;          ///< ticks, about
  bool from_zero = false;  ///< a linear axis begins at 0 when its values are positive and not all alike
  bool to_ticks = false;   ///< a linear axis ends at ticks
  bool whole = false;      ///< its ticks are whole numbers
};
/// `values` that an axis cannot show are left out.
[[nodiscard]] Axis make_axis(const std::vector<double>& values, const AxisOptions& options);

}  // namespace scenegen::tools
