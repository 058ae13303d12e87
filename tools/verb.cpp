#include "tools/verb.h"

#include <cstdio>

namespace scenegen::tools {

int run_verb(Options& options, std::span<const std::string> arguments, const VerbSteps& steps) {
  const auto printed = [](const std::string& text) {
    const auto written = write_stdout(text);
    return written ? 0 : report_error(written.error());
  };
  const Result<Action> action = options.parse(arguments);
  if (!action) return report_error(action.error());
  if (*action == Action::help) return printed(options.help(colored(1)));
  if (*action == Action::version) return printed(options.version());
  if (steps.check) {
    if (auto usable = steps.check(); !usable) return report_error(usable.error());
  }
  if (steps.dump_config != nullptr && *steps.dump_config)
    return printed(pretty(options.config(steps.conflicts())));
  const Result<int> done = steps.work();
  return done ? *done : report_error(done.error());
}

Result<void> say(const Answer& answer) {
  std::vector<gltf::OutputFile> none;
  std::vector<gltf::OutputFile>& files = answer.files != nullptr ? *answer.files : none;
  if (!answer.report.empty()) {
    auto report = prepare_file(answer.report, pretty(answer.facts.json()));
    if (!report) return forward_error(report);
    files.push_back(std::move(*report));
  }
  if (auto placed = gltf::commit_all(files); !placed) return placed;
  if (!answer.quiet) {
    for (const std::string& note : answer.notes)
      (void)std::fprintf(stderr, "note: %s\n", printable(note).c_str());
  }
  if (answer.format == Format::csv && answer.csv) return write_stdout(*answer.csv);
  if (answer.format != Format::table) return write_stdout(answer.facts.str(answer.format));
  if (answer.quiet) return {};
  if (!answer.stdout_taken) return write_stdout(answer.text);
  (void)std::fputs(answer.text.c_str(), stderr);
  return {};
}

void add_stdout_conflicts(const std::string& output, const std::string& report,
                          std::vector<Conflict>& conflicts) {
  if (output == "-") {
    conflicts.push_back(
        {"--format",
         "cannot be used with --output -, which puts the .glb on stdout (--report FILE writes JSON)"});
  }
  if (report != "-") return;
  conflicts.push_back({"--format", "cannot be used with --report -, which puts the report on stdout"});
  if (output == "-")
    conflicts.push_back({"--report", "cannot be used with --output -: stdout takes one of them"});
}

Result<void> check_output_and_report(const std::string& output, const std::string& report,
                                     const NamedPath& model) {
  if (auto apart = check_distinct_files({{"--output", output}, {"--report", report}}, {}); !apart)
    return apart;
  if (auto apart = check_distinct_files({{"--report", report}}, {model}); !apart) return apart;
  return report.empty() || report == "-" ? Result<void>() : check_output_file(report);
}

}  // namespace scenegen::tools
