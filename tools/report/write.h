// Reports as files. The same report gives the same bytes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "scene/result.h"
#include "tools/report/report.h"

namespace scenegen::tools {

/// What could not be shown as it should: pictures that are missing or damaged.
using Warnings = std::vector<std::string>;

/// One page that needs nothing else: style, charts and pictures are inside, there is no script, and its
/// content security policy lets it load nothing.
[[nodiscard]] std::string report_html(const RunReport& report, Warnings& warnings);
/// GitHub's Markdown. Pictures are links relative to `folder`, in which the file will be.
[[nodiscard]] std::string report_markdown(const RunReport& report, const std::string& folder);
/// Name and content of each file: one a table or chart, _facts.csv; _glance.csv (the paper's
/// tables, a line each) and _failures.csv when there are such.
/// RFC 4180, all digits, `name`s of
/// columns as the heading.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> report_csv(const RunReport& report);
/// {"schema": "sceneplay/report", "version": 1, "title", "runs": [documents]}
[[nodiscard]] std::string report_json(const RunReport& report);

}  // namespace scenegen::tools
