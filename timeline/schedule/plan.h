// A Gantt plan as plain data (METHODS 10): tasks, what they do to which objects, when, and after which.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/result.h"
#include "timeline/profiles.h"

namespace scenegen::timeline {

/// Seconds since 1970-01-01T00:00 by the clock on the wall of the site: no time zones, no leap seconds, no
/// daylight saving.
using CivilSeconds = std::int64_t;
constexpr CivilSeconds kDay = 86400;

enum class LinkKind : std::uint8_t { finish_start, start_start, finish_finish, start_finish };

/// The task that has it cannot start (or finish) before `lag_s` after the other one finishes (or starts).
struct Link {
  std::uint32_t task = 0;  ///< into Plan::tasks
  LinkKind kind = LinkKind::finish_start;
  CivilSeconds lag_s = 0;
};

struct Task {
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  std::string id, name;
  Profile profile = Profile::construct;
  std::optional<CivilSeconds> start_s, finish_s,
      duration_s;                ///< after compute_dates(): start and finish are set
  std::uint32_t parent = kNone;  ///< into Plan::tasks
  bool summary = false;          ///< has tasks below it, or the plan says so
  std::vector<Link> predecessors;
  std::vector<std::string> objects;    ///< names, identifiers or selectors
  std::vector<std::string> selectors;  ///< selectors (scene/selector.h)
  glm::vec3 offset_z_up_m{0.0F};       ///< of a move; z up, as authors think
  std::string where;                   ///< "plan.csv: line 5", "plan.xml: Task with UID 7"
};

struct Plan {
  std::string path;
  std::vector<Task> tasks;
  std::vector<std::string> notes;  ///< what was left out, one line each
};

enum class DateOrder : std::uint8_t { unknown, day_month_year, month_day_year };

struct PlanOptions {
  DateOrder date_order = DateOrder::unknown;
  Profile default_profile = Profile::construct;  ///< of tasks that do not say their type
};

/// Reads CSV, or MS Project XML where the text begins with '<'; "-" is standard input. docs/SCHEDULES.md says
/// what is understood. Dates that are missing are computed; summary tasks span what is below them. Errors
/// (bad_input) name the line or the element, what is wrong and what is allowed. Any content whatever gives a
/// plan whose ids are unique, whose indices point into `tasks`, and whose tasks start before they finish, or
/// an error.
[[nodiscard]] Result<Plan> read_plan(const std::string& path, const PlanOptions& options = {});
/// The same from memory.
[[nodiscard]] Result<Plan> parse_plan(std::string_view bytes, const std::string& name,
                                      const PlanOptions& options = {});

/// "2024-03-01", or "2024-03-01T08:00:00" when it is not midnight.
[[nodiscard]] std::string moment_text(CivilSeconds at_s);

/// "construct" and the like, and what IFC (IfcTaskTypeEnum), Navisworks and people call the same: in any
/// case, with or without blanks, dashes and underscores. The error names the nearest; its `where` is empty.
[[nodiscard]] Result<Profile> parse_task_type(std::string_view text);

}  // namespace scenegen::timeline
