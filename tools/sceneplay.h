// The verbs of sceneplay, each in a file of its own. They return the exit code (docs/CLI.md).
#pragma once

#include <span>
#include <string>

namespace scenegen::tools {

int calibrate_verb(std::span<const std::string> arguments);
int frames_verb(std::span<const std::string> arguments);
int camera_path_verb(std::span<const std::string> arguments);
int bench_compare_verb(std::span<const std::string> arguments);
int bench_verb(std::span<const std::string> arguments);
int experiment_verb(std::span<const std::string> arguments);
int report_verb(std::span<const std::string> arguments);
/// Prints the Vulkan devices there are.
int list_devices_verb();

}  // namespace scenegen::tools
