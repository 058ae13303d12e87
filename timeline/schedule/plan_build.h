// What both plan readers do with what they read. Private to timeline/schedule.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <unordered_map>

#include "timeline/schedule/plan.h"

namespace scenegen::timeline {

enum class Column : std::uint8_t {
  id,
  name,
  start,
  finish,
  duration,
  type,
  parent,
  predecessors,
  objects,
  selector,
  offset,
  none
};
constexpr std::size_t kColumnCount = 11;
/// By the names that are understood (plain_word() of them), or none.
[[nodiscard]] Column column_of(std::string_view title);

/// Sets what a cell of that column says: name, start, finish, duration, type, objects, selector, offset. An
/// empty cell says nothing. Errors have no `where`.
[[nodiscard]] Result<void> take_cell(Task& task, Column column, std::string_view text,
                                     const PlanOptions& options);

/// "5;A7SS+2d": appends links; the error has no `where`.
[[nodiscard]] Result<void> take_predecessors(Task& task, std::uint32_t self, std::string_view text,
                                             const std::unordered_map<std::string, std::uint32_t>& ids);

/// Start and finish of every task from what is given, from predecessors and from tasks below. Errors name the
/// tasks: cycles of links or parents, dates that are missing or in the wrong order.
[[nodiscard]] Result<void> compute_dates(Plan& plan);

[[nodiscard]] Result<Plan> parse_plan_csv(std::string_view bytes, const std::string& name,
                                          const PlanOptions& options);
[[nodiscard]] Result<Plan> parse_plan_msproject(std::string_view bytes, const std::string& name,
                                                const PlanOptions& options);

}  // namespace scenegen::timeline
