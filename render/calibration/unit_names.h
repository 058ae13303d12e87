// The unit costs by name: for files, tables and messages.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "render/model/unit_costs.h"

namespace scenegen::render {

/// One of `value`, `curve` and `curves` is set.
struct UnitName {
  std::string_view name;    ///< in files
  std::string_view symbol;  ///< of the dissertation, or ours
  std::string_view meaning;
  double model::UnitCosts::*value = nullptr;  ///< seconds, or bytes; shares from 0 to 1 when `share`
  model::Curve model::UnitCosts::*curve = nullptr;
  std::array<model::Curve, model::kShadings> model::UnitCosts::*curves = nullptr;  ///< by shading
  std::string_view x = {};                                                         ///< what a curve's x is
  bool share = false;
  bool bytes = false;  ///< not seconds
};
[[nodiscard]] std::span<const UnitName> unit_names();
/// Names of the entries of `curves`.
constexpr std::array<std::string_view, model::kShadings> kShadingNames{"plain", "textured"};

}  // namespace scenegen::render
