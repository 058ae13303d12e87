// The verbs of scenegen, each in a file of its own. They return the exit code (docs/CLI.md).
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace scenegen::tools {

int generate_verb(std::span<const std::string> arguments);
int animate_verb(std::span<const std::string> arguments);
int schedule_verb(std::span<const std::string> arguments);
int inspect_verb(std::span<const std::string> arguments);
int diff_verb(std::span<const std::string> arguments);
int optimize_verb(std::span<const std::string> arguments);
int truth_verb(std::span<const std::string> arguments);
int sweep_verb(std::span<const std::string> arguments);

/// What `scenegen` says when it is called without arguments.
[[nodiscard]] std::string generate_short_help();

}  // namespace scenegen::tools
