// Everything that `scenegen schedule` can be asked for.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/write.h"
#include "scene/import/import.h"
#include "timeline/schedule/mapping.h"
#include "timeline/schedule/plan.h"
#include "tools/cli.h"
#include "tools/output.h"
#include "tools/profile_options.h"

namespace scenegen::tools {

/// What becomes of objects that no task is about.
enum class Unmatched : std::uint8_t { show, hide, error };

struct ScheduleRequest {
  std::string model, plan, output;
  import::ImportOptions import;
  timeline::PlanOptions plan_options;
  bool summary_tasks = false;
  std::string task_key = "task";
  std::string mapping, save_mapping;
  Unmatched unmatched = Unmatched::show;
  timeline::ActivityOptions activities;
  double hold_s = 1;
  ProfileRequest profile;
  gltf::VisibilityEncoding visibility = gltf::VisibilityEncoding::scale;
  std::uint32_t threads = 0;  ///< 0: one per processor

  std::string report;
  Format format = Format::table;
  bool dry_run = false;
  bool dump_config = false;
  bool quiet = false;
};

/// The options write into `request`, which must outlive them.
[[nodiscard]] Options schedule_options(ScheduleRequest& request);
[[nodiscard]] std::vector<Conflict> schedule_conflicts(const ScheduleRequest& request);
/// Before the long work: options that do not go together, files that cannot be written.
[[nodiscard]] Result<void> check_schedule(const ScheduleRequest& request, const Options& options);

}  // namespace scenegen::tools
