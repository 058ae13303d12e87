// scenegen: makes, inspects and compares dynamic scenes. See docs/CLI.md.
#include "tools/scenegen.h"

#include <array>

#include "tools/cli.h"
#include "tools/output.h"

namespace scenegen::tools {

namespace {

struct Verb {
  std::string_view name;
  int (*run)(std::span<const std::string>);
};
constexpr std::array<Verb, 7> kVerbs{{{"animate", animate_verb},
                                      {"schedule", schedule_verb},
                                      {"inspect", inspect_verb},
                                      {"diff", diff_verb},
                                      {"optimize", optimize_verb},
                                      {"truth", truth_verb},
                                      {"sweep", sweep_verb}}};

int run(std::span<const std::string> arguments) {
  if (arguments.empty()) {
    const auto written = write_stdout(generate_short_help());
    return written ? 0 : report_error(written.error());
  }
  const std::string& first = arguments.front();
  if (first.starts_with('-')) return generate_verb(arguments);
  std::vector<std::string> names;
  for (const Verb& verb : kVerbs) {
    if (verb.name == first) return verb.run(arguments.subspan(1));
    names.emplace_back(verb.name);
  }
  return report_error({ErrorKind::usage, "", unknown_word("command", first, names)});
}

}  // namespace

}  // namespace scenegen::tools

int main(int argc, char** argv) {
  return scenegen::tools::guarded_main(argc, argv, scenegen::tools::run);
}
