// Where the programs take unit costs from.
#pragma once

#include <string>

#include "render/calibration/calibration.h"
#include "render/renderer.h"
#include "tools/cli.h"

namespace scenegen::tools {

/// Where the user's cache keeps the calibration of `key`; its folder is made, and a file can be written
/// there.
[[nodiscard]] Result<std::string> calibration_place(const render::CalibrationKey& key);
/// Replaces the file in the user's cache as a whole, or makes it. Gives its path.
[[nodiscard]] Result<std::string> store_calibration(const render::Calibration& calibration);

/// How --calibration is read: a file, or auto, quick, none.
[[nodiscard]] Value calibration_value(std::string& target);
/// Sets `options.costs` as --calibration says, and `options.shared_device` when that takes opening a device.
/// A file must be for exactly this device, size, sample count and shadows. `auto` sets nothing unless the
/// strategy chooses by costs (StrategyTraits); it takes the cache's file if that is good, else measures
/// quickly and keeps that there. `quick` measures in any case and keeps nothing; `none` sets nothing. What is
/// measured is said on stderr unless `quiet`.
[[nodiscard]] Result<void> set_costs(render::RendererOptions& options, const std::string& wanted, bool quiet);

}  // namespace scenegen::tools
