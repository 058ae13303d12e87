// Results of benchmarks as tables and charts for `sceneplay report`.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "tools/bench_compare.h"
#include "tools/report/document.h"

namespace scenegen::tools {

/// One section of any number of results (docs/BENCH_FORMAT.md), ours and other renderers': cases of the same
/// scene and camera stand in one table, whatever file they are from. A member that is missing or of another
/// kind is an empty cell. Ids begin with `id`.
[[nodiscard]] DocumentSection bench_section_of_all(std::span<const nlohmann::ordered_json> results,
                                                   const std::string& id = "bench");
[[nodiscard]] DocumentSection bench_section(const nlohmann::ordered_json& results);

/// That section with the facts of the first of the results; not of nothing.
[[nodiscard]] Document bench_document(std::span<const nlohmann::ordered_json> results);

}  // namespace scenegen::tools
