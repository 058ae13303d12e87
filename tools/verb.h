// What all verbs do alike: from their arguments to an exit code, and how they say what they made.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scene/gltf/write_files.h"
#include "scene/result.h"
#include "tools/cli.h"
#include "tools/output.h"

namespace scenegen::tools {

struct VerbSteps {
  std::function<Result<void>()> check = {};  ///< of options against each other and of files, before the work
  const bool* dump_config = nullptr;         ///< --dump-config, when the verb has it
  std::function<std::vector<Conflict>()> conflicts = {};  ///< options that are left out of that
  std::function<Result<int>()> work;                      ///< the exit code
};
/// Reads the arguments into what `options` write to; prints the help, the version or the configuration, or
/// does the work. Errors are printed. Returns the exit code.
int run_verb(Options& options, std::span<const std::string> arguments, const VerbSteps& steps);

/// What a verb has made, and where it may say so.
struct Answer {
  const Report& facts;
  std::vector<std::string> notes;
  std::string text;                     ///< for people
  std::optional<std::string> csv = {};  ///< instead of the facts
  std::string report = {};              ///< --report
  /// Complete files that are put in their places once the report is complete too: all or none.
  std::vector<gltf::OutputFile>* files = nullptr;
  Format format = Format::table;
  bool quiet = false;
  bool stdout_taken = false;  ///< by a file: the text goes to stderr
};
/// Nothing is said before the files are in their places.
[[nodiscard]] Result<void> say(const Answer& answer);

/// Options that need stdout, which `--output -` or `--report -` takes. `output`: "" when nothing is written.
void add_stdout_conflicts(const std::string& output, const std::string& report,
                          std::vector<Conflict>& conflicts);
/// Whether a verb that makes one scene of one model can write its files. The model itself may be replaced: it
/// is read before that. `output`: "" when nothing is written.
[[nodiscard]] Result<void> check_output_and_report(const std::string& output, const std::string& report,
                                                   const NamedPath& model);

}  // namespace scenegen::tools
