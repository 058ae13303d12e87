// The command line of one verb: options in headed groups on top of CLI11, whose own messages are never shown.
//
//   AppOptions app;
//   Options options("sceneplay frames", {"sceneplay frames FILE -o DIR [options]"}, "draws a file to
//   pictures"); options.positional("FILE", app.file, "the .glb or .gltf to play"); options.group("Pictures");
//   options.add("--size", size2_value(app.size, {1, 1}, {16384, 16384}, "WxH"), "size in pixels");
//   options.group("General");
//   options.add_general(app.quiet);
//   const Result<Action> action = options.parse(arguments);
//   if (!action) return report_error(action.error());
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/result.h"
#include "tools/text.h"

namespace scenegen::tools {

/// How one option reads its text, and spells its present value.
struct Value {
  enum class Kind : std::uint8_t { text, number, boolean };
  Kind kind = Kind::text;
  std::string form;   ///< "WxL", "N": what stands behind the option in the help
  std::string range;  ///< "0 to 1", "hilbert, morton, row-prime"; empty: anything
  std::function<Result<void>(std::string_view)> parse;  ///< the error's `where` is filled in by Options
  std::function<std::string()> spell;                   ///< canonical; "" when there is no value
  /// For an option that may be given several times: what it holds, and how to make it hold nothing. parse()
  /// adds to it; a config file has an array.
  std::function<std::vector<std::string>()> spell_all = {};
  std::function<void()> clear = {};
};

/// `target` must outlive the Options. Bounds are inclusive.
template <class Whole>
[[nodiscard]] Value whole_value(Whole& target, Whole least, Whole most, std::string form = "N") {
  return {Value::Kind::number, std::move(form), std::to_string(least) + " to " + std::to_string(most),
          [&target, least, most](std::string_view text) -> Result<void> {
            auto value = parse_whole(text, least, most);
            if (!value) return forward_error(value);
            target = static_cast<Whole>(*value);
            return {};
          },
          [&target] { return std::to_string(target); }};
}
[[nodiscard]] Value real_value(double& target, double least, double most, std::string form);
[[nodiscard]] Value size2_value(glm::uvec2& target, glm::uvec2 least, glm::uvec2 most, std::string form);
[[nodiscard]] Value size3_value(glm::uvec3& target, glm::uvec3 least, glm::uvec3 most, std::string form);
[[nodiscard]] Value metres2_value(glm::dvec2& target, double least, double most, std::string form);
[[nodiscard]] Value metres3_value(glm::dvec3& target, double least, double most, std::string form);
[[nodiscard]] Value on_off_value(bool& target);
[[nodiscard]] Value text_value(std::string& target, std::string form, std::string range = {});
/// A check for texts_value().
[[nodiscard]] Result<void> not_empty(const std::string& text);
/// An option that may be given several times; `check` looks at each text.
[[nodiscard]] Value texts_value(std::vector<std::string>& target, std::string form, std::string range,
                                std::function<Result<void>(const std::string&)> check);
/// One word of a list; the error names the nearest one.
template <class Enum>
[[nodiscard]] Value choice_value(Enum& target, std::vector<std::pair<std::string, Enum>> choices,
                                 std::string form = "WORD") {
  std::vector<std::string> words;
  words.reserve(choices.size());
  for (const auto& choice : choices) words.push_back(choice.first);
  auto parse = [&target, choices, words](std::string_view text) -> Result<void> {
    for (const auto& [word, value] : choices) {
      if (word != text) continue;
      target = value;
      return {};
    }
    return fail(ErrorKind::usage, "", unknown_word("value", text, words));
  };
  auto spell = [&target, choices = std::move(choices)] {
    for (const auto& [word, value] : choices) {
      if (value == target) return word;
    }
    return std::string();
  };
  return {Value::Kind::text, std::move(form), join(words, ", "), std::move(parse), std::move(spell)};
}

/// What an option decides, and so where it is repeated.
enum class Role : std::uint8_t {
  run,      ///< how the program runs: in --dump-config when given
  content,  ///< what the scene holds: in --dump-config always, in the file's arguments when given
  once,     ///< this call only (--dry-run, --config): never repeated
};

enum class Action : std::uint8_t { run, help, version };

/// An option that cannot be together with others: "--grid" because of "--test-set".
struct Conflict {
  std::string option;
  std::string reason;  ///< "has no effect with --test-set"
};

class Options {
 public:
  /// `program` as typed: "scenegen", "scenegen inspect". `usage` are the lines behind "Usage:".
  Options(std::string program, std::vector<std::string> usage, std::string summary);
  ~Options();
  Options(Options&&) noexcept;
  Options& operator=(Options&&) noexcept;

  /// Heading of the options that follow.
  void group(std::string title);
  /// `names`: "-o,--output"; the last one is the long name that errors, config files and `given` use. The
  /// default shown in the help is what `value` spells at this call, unless `default_text` says it in words.
  void add(const std::string& names, Value value, std::string help, Role role = Role::run,
           std::string default_text = {});
  /// An option without a value.
  void flag(const std::string& names, bool& target, std::string help, Role role = Role::once);
  /// An argument without a name; every one is required.
  void positional(const std::string& name, std::string& target, std::string help);
  /// The last argument without a name, which may be given several times, at least once unless `optional`.
  /// `name`: "FILE...".
  void positional(const std::string& name, std::vector<std::string>& target, std::string help,
                  bool optional = false);
  /// --quiet, --version, --help.
  void add_general(bool& quiet);
  /// --config and --dump-config; parse() reads the file first, so that the command line wins.
  void add_config(bool& dump);

  /// Arguments without the program's name and the verb. Help and version win over every error but unknown
  /// options.
  [[nodiscard]] Result<Action> parse(std::span<const std::string> arguments);

  /// Takes the value of one option as a config file gives it; `key` is its long name without dashes. Only
  /// options of Role::content. The error's `where` is empty.
  [[nodiscard]] Result<void> set_content(const std::string& key, const nlohmann::ordered_json& value);
  /// The present value as config() gives it; null when it has none. By long name without dashes.
  [[nodiscard]] nlohmann::ordered_json config_value(std::string_view key) const;

  /// Given on the command line or in the config file. By long name with its dashes: "--grid".
  [[nodiscard]] bool given(std::string_view long_name) const;
  /// A usage error when one of these options was given.
  [[nodiscard]] Result<void> refuse(std::span<const Conflict> conflicts) const;
  /// The options of Role::content that were given, in the order of the help, canonically spelt.
  [[nodiscard]] std::vector<std::string> canonical_arguments() const;
  /// An object that --config reads back; `left_out` names long options that do not apply.
  [[nodiscard]] nlohmann::ordered_json config(std::span<const Conflict> left_out = {}) const;
  /// "scenegen 0.1.0" and a newline.
  [[nodiscard]] std::string version() const;
  /// At most 100 characters a line.
  [[nodiscard]] std::string help(bool colored) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A JSON object of at most 1 MiB; "-" is stdin. Errors name the file.
[[nodiscard]] Result<nlohmann::ordered_json> read_config_file(const std::string& path);

/// Other people's text for a terminal: line breaks and escape characters become question marks.
[[nodiscard]] std::string printable(std::string text);

/// Prints "error: ..." on stderr and gives the exit code that goes with its kind.
int report_error(const Error& error);

/// Runs a program's body: signals that failed writes send become errors, exceptions one line and an exit
/// code. Interrupted by the user, the process ends by that signal and leaves no part of a file behind.
int guarded_main(int argc, char** argv, int (*body)(std::span<const std::string> arguments));

}  // namespace scenegen::tools
