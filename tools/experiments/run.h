// Runs experiments, one after the other, and keeps what they found.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tools/experiments/experiment.h"

namespace scenegen::tools {

struct ExperimentResults {
  Document document;
  std::vector<std::pair<std::string, Error>> failures;  ///< name of the experiment
};

/// What --list prints.
[[nodiscard]] std::string experiment_list();
/// Those of these names; "all": all of them. Each once. The error names the nearest.
[[nodiscard]] Result<std::vector<const Experiment*>> find_experiments(const std::vector<std::string>& names);

/// {"schema": "sceneplay/experiment", "version": 1, …, "document"}. `run` says how: program, machine, device,
/// seed, arguments.
[[nodiscard]] nlohmann::ordered_json experiment_json(const nlohmann::ordered_json& run,
                                                     const ExperimentResults& results);
/// Name and content of a file for each table.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> table_files(const Document& document);
/// Tables and sentences for a terminal.
[[nodiscard]] std::string section_text(const DocumentSection& section);
[[nodiscard]] std::string table_text(const DocumentTable& table);

}  // namespace scenegen::tools
