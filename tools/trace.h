// What happened frame by frame, as a file for spreadsheets and scripts: --trace.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "render/renderer.h"
#include "render/view.h"
#include "scene/result.h"

namespace scenegen::tools {

/// Objects as CSV (RFC 4180), one line each: members of members are joined by a point, entries of a list by
/// their "name" (lists of anything else are left out). The columns are those of all of them.
[[nodiscard]] std::string flat_csv(const nlohmann::ordered_json& rows);

/// One row: time, eye and view direction, what was drawn how, counters, stages. `alphaN` is the share of the
/// chunks in the frustum that were recorded anew (D 3.3), `dAnim` that of objects that changed (D 2.5).
/// `choiceLeftMs` and `choiceRightMs` are what the way that was taken and its nearest rival would take, null
/// where nothing was chosen (3.13).
/// `passes`: how many have kept commands of their own (colour; ids and depth).
[[nodiscard]] nlohmann::ordered_json trace_row(const render::FrameReport& report, const render::View& view,
                                               const std::string& strategy, double seek_ms,
                                               std::uint32_t passes);

/// Whether the name ends with .csv or .json; an empty one is no file.
[[nodiscard]] Result<void> check_trace_name(const std::string& path);
[[nodiscard]] Result<void> write_trace(const std::string& path, const nlohmann::ordered_json& rows);

}  // namespace scenegen::tools
