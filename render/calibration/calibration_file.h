// Unit costs as a file: JSON, versioned, with what they hold for (docs/CALIBRATION.md).
#pragma once

#include <string>
#include <string_view>

#include "render/calibration/calibration.h"

namespace scenegen::render {

/// Ends with a newline; the same calibration gives the same bytes.
[[nodiscard]] std::string calibration_json(const Calibration& calibration);
/// Errors (bad_input) name the member: `where` is the file.
[[nodiscard]] Result<Calibration> parse_calibration(std::string_view text, const std::string& where);
/// Error (bad_input) that says what differs, when it was measured for something else.
[[nodiscard]] Result<void> check_calibration(const Calibration& calibration, const CalibrationKey& wanted,
                                             const std::string& where);
/// Below $XDG_CACHE_HOME, or $HOME/.cache; one file for each device, size, sample count and shadows. Error
/// (io) when neither variable is set.
[[nodiscard]] Result<std::string> calibration_path(const CalibrationKey& key);

}  // namespace scenegen::render
