// Results of experiments and benchmarks, as reports take them.
#pragma once

#include <string>
#include <vector>

#include "scene/result.h"
#include "tools/report/report.h"

namespace scenegen::tools {

/// What a file says it is: "sceneplay/experiment". Errors: it cannot be read, is no JSON, or says nothing.
[[nodiscard]] Result<std::string> results_schema(const std::string& file);
/// One file: "sceneplay/experiment" 1. Errors name file and JSON pointer.
[[nodiscard]] Result<ReportRun> read_results(const std::string& file);
/// The results files that a path means: itself, or those of a folder, else those of its folders, by name.
/// Error when there is none.
[[nodiscard]] Result<std::vector<std::string>> results_files(const std::string& path);

}  // namespace scenegen::tools
