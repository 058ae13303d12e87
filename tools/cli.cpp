#include "tools/cli.h"

#include <simdjson.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <new>
#include <system_error>

#include "scene/temporary_files.h"
#include "tools/output.h"
#include "tools/text.h"

namespace scenegen::tools {

namespace {

constexpr std::size_t kLineWidth = 100;

struct Option {
  std::string names;      // "-o,--output"
  std::string long_name;  // "--output"
  Value value;            // a flag's has no form
  std::string help;
  std::string default_text;
  Role role = Role::run;
  CLI::Option* handle = nullptr;
  bool given = false;

  [[nodiscard]] bool is_flag() const { return value.form.empty(); }
  [[nodiscard]] bool repeats() const { return value.spell_all != nullptr; }
};

struct Group {
  std::string title;
  std::vector<Option> options;
};

struct Positional {
  std::string name;
  std::function<void(const std::vector<std::string>&)> take;
  std::string help;
  CLI::Option* handle;
  bool optional = false;
};

}  // namespace

struct Options::State {
  std::string program;
  std::vector<std::string> usage;
  std::string summary;
  CLI::App app;
  std::vector<Group> groups;
  std::vector<Positional> positionals;
  std::string config_path;
  bool wants_help = false;
  bool wants_version = false;

  [[nodiscard]] Option* find(std::string_view long_name) {
    for (Group& group : groups) {
      for (Option& option : group.options) {
        if (option.long_name == long_name) return &option;
      }
    }
    return nullptr;
  }
  [[nodiscard]] std::vector<std::string> long_names(std::size_t dropped_dashes) const {
    std::vector<std::string> names;
    for (const Group& group : groups) {
      for (const Option& option : group.options) names.push_back(option.long_name.substr(dropped_dashes));
    }
    return names;
  }
  Result<void> tokenize(std::span<const std::string> arguments);
  [[nodiscard]] Result<void> check_values() const;
  Result<void> take_positionals();
  Result<void> take_options();
  Result<void> read_config();
  Result<void> take_config(const nlohmann::ordered_json& document);
};

Options::Options(std::string program, std::vector<std::string> usage, std::string summary)
    : state_(std::make_unique<State>()) {
  state_->program = std::move(program);
  state_->usage = std::move(usage);
  state_->summary = std::move(summary);
  state_->app.set_help_flag();
  state_->app.allow_extras();  // unknown options are reported by us, with a suggestion
}

Options::~Options() = default;
Options::Options(Options&&) noexcept = default;
Options& Options::operator=(Options&&) noexcept = default;

void Options::group(std::string title) {
  state_->groups.push_back({std::move(title), {}});
}

void Options::add(const std::string& names, Value value, std::string help, Role role,
                  std::string default_text) {
  Option option;
  option.names = names;
  option.long_name = names.substr(names.rfind("--"));
  option.value = std::move(value);
  option.help = std::move(help);
  option.role = role;
  option.default_text = default_text.empty() ? option.value.spell() : std::move(default_text);
  option.handle = option.is_flag() ? state_->app.add_flag(names) : state_->app.add_option(names);
  option.handle->multi_option_policy(option.repeats() ? CLI::MultiOptionPolicy::TakeAll
                                                      : CLI::MultiOptionPolicy::TakeLast);
  state_->groups.back().options.push_back(std::move(option));
}

void Options::flag(const std::string& names, bool& target, std::string help, Role role) {
  Value value;
  value.kind = Value::Kind::boolean;
  value.parse = [&target](std::string_view text) -> Result<void> {
    if (text != "true" && text != "false") return fail(ErrorKind::usage, "", "takes no value");
    target = text == "true";
    return {};
  };
  value.spell = [&target] { return std::string(target ? "true" : "false"); };
  add(names, std::move(value), std::move(help), role, "off");
}

void Options::positional(const std::string& name, std::string& target, std::string help) {
  state_->positionals.push_back({name,
                                 [&target](const std::vector<std::string>& texts) { target = texts.back(); },
                                 std::move(help), state_->app.add_option(name)});
}

void Options::positional(const std::string& name, std::vector<std::string>& target, std::string help,
                         bool optional) {
  CLI::Option* handle =
      state_->app.add_option(name.substr(0, name.find('.')))->expected(1, 1 << 20)->allow_extra_args();
  handle->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  state_->positionals.push_back({name, [&target](const std::vector<std::string>& texts) { target = texts; },
                                 std::move(help), handle, optional});
}

void Options::add_general(bool& quiet) {
  flag("-q,--quiet", quiet, "print errors only", Role::run);
  flag("--version", state_->wants_version, "print the version and stop");
  flag("-h,--help", state_->wants_help, "print this help and stop");
}

void Options::add_config(bool& dump) {
  add("--config", text_value(state_->config_path, "FILE"),
      "read options from a JSON file whose members are long options without their dashes, as --dump-config "
      "writes "
      "them; the command line wins",
      Role::once);
  flag("--dump-config", dump, "print the options in force as JSON on stdout and stop");
}

Result<void> Options::State::tokenize(std::span<const std::string> arguments) {
  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());  // the order that CLI11 wants
    app.parse(std::move(reversed));
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string_view text = error.what();
    return fail(ErrorKind::usage, std::string(text.substr(0, text.find(':'))), "needs a value");
  } catch (const CLI::Error& error) {
    return fail(ErrorKind::usage, "", error.what());
  }
  return {};
}

namespace {

Error unexpected_argument(const std::vector<std::string>& extras, const std::vector<std::string>& known) {
  const auto first_option = std::find_if(extras.begin(), extras.end(),
                                         [](const std::string& s) { return s.size() > 1 && s[0] == '-'; });
  if (first_option == extras.end())
    return {ErrorKind::usage, "", "unexpected argument '" + extras.front() + "'"};
  const std::string name = first_option->substr(0, first_option->find('='));
  const std::string nearest = nearest_word(name, known);
  return {
      ErrorKind::usage, name,
      "unknown option" + (nearest.empty() ? " (--help lists them)" : " (did you mean '" + nearest + "'?)")};
}

tl::unexpected<Error> located(Error error, const std::string& where) {
  error.where = where;
  return tl::unexpected<Error>(std::move(error));
}

Result<void> take_text(Option& option, const std::string& text, const std::string& where) {
  if (!simdjson::validate_utf8(text)) return fail(ErrorKind::usage, where, "is not valid UTF-8");
  if (auto taken = option.value.parse(text); !taken) return located(std::move(taken.error()), where);
  option.given = true;
  return {};
}

}  // namespace

Result<void> Options::State::take_positionals() {
  for (const Positional& positional : positionals) {
    if (positional.handle->count() == 0) {
      if (positional.optional) continue;
      return fail(ErrorKind::usage, "", "missing " + positional.name + " (usage: " + usage.front() + ")");
    }
    positional.take(positional.handle->results());
  }
  return {};
}

/// "--grid --seed 3": the second option was taken for the value of the first.
Result<void> Options::State::check_values() const {
  for (const Group& group : groups) {
    for (const Option& option : group.options) {
      if (option.handle->count() == 0) continue;
      const std::vector<std::string>& texts = option.handle->results();
      const auto wrong = std::find_if(option.repeats() ? texts.begin() : texts.end() - 1, texts.end(),
                                      [](const std::string& text) { return text.starts_with("--"); });
      if (wrong != texts.end())
        return fail(ErrorKind::usage, option.long_name, "needs a value ('" + *wrong + "' is an option)");
    }
  }
  return {};
}

Result<void> Options::State::take_options() {
  for (Group& group : groups) {
    for (Option& option : group.options) {
      if (option.handle->count() == 0) continue;
      if (option.repeats()) option.value.clear();  // what the config file said
      const std::vector<std::string>& texts = option.handle->results();
      const std::size_t first = option.repeats() ? 0 : texts.size() - 1;
      for (std::size_t i = first; i < texts.size(); ++i) {
        if (auto taken = take_text(option, texts[i], option.long_name); !taken) return taken;
      }
    }
  }
  return {};
}

namespace {

Result<std::string> read_small_file(const std::string& path) {
  constexpr std::size_t kMostBytes = 1 << 20;
  std::ifstream file;
  if (path != "-") file.open(path, std::ios::binary);
  std::istream& stream = path == "-" ? std::cin : file;
  std::string text(kMostBytes + 1, '\0');
  if (stream) stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (!stream.eof() && text.size() <= kMostBytes) return fail(ErrorKind::io, path, "cannot be read");
  if (text.size() > kMostBytes)
    return fail(ErrorKind::bad_input, path, "is longer than 1 MiB: not a config file");
  return text;
}

}  // namespace

Result<nlohmann::ordered_json> read_config_file(const std::string& path) {
  auto text = read_small_file(path);
  if (!text) return forward_error(text);
  nlohmann::ordered_json document;
  if (const std::string_view excess = json_excess(*text); !excess.empty())
    return fail(ErrorKind::bad_input, path, std::string(excess));
  try {
    document = nlohmann::ordered_json::parse(*text);
  } catch (const nlohmann::json::exception& error) {
    std::string what = error.what();  // "[json.exception.parse_error.101] parse error at line 1, ..."
    what.erase(0, what.find("] ") == std::string::npos ? 0 : what.find("] ") + 2);
    std::replace(what.begin(), what.end(), '\n', ' ');
    return fail(ErrorKind::bad_input, path, what);
  }
  if (!document.is_object()) return fail(ErrorKind::bad_input, path, "is not a JSON object");
  return document;
}

namespace {

/// The text that a JSON value stands for on the command line; none for null, arrays and objects.
std::optional<std::string> option_text(const nlohmann::ordered_json& value, const Option& option) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return shortest(value.get<double>());
  if (value.is_number()) return value.dump();
  if (!value.is_boolean()) return std::nullopt;
  if (option.is_flag()) return value.get<bool>() ? "true" : "false";
  return value.get<bool>() ? "on" : "off";
}

}  // namespace

Result<void> Options::State::read_config() {
  const Option* option = find("--config");
  if (option == nullptr || option->handle->count() == 0) return {};
  config_path = option->handle->results().back();
  const auto document = read_config_file(config_path);
  return document ? take_config(*document) : tl::unexpected(document.error());
}

Result<void> Options::State::take_config(const nlohmann::ordered_json& document) {
  for (const auto& [key, value] : document.items()) {
    const std::string where = config_path + ": /" + key;
    Option* option = find("--" + key);
    if (option == nullptr || option->role == Role::once) {
      const std::string nearest = nearest_word(key, long_names(2));
      return fail(ErrorKind::usage, where,
                  "unknown option" + (nearest.empty() ? "" : " (did you mean '" + nearest + "'?)"));
    }
    const bool list = option->repeats() && value.is_array();
    const auto texts = list ? value : nlohmann::ordered_json::array({value});
    for (const auto& entry : texts) {
      const std::optional<std::string> text = option_text(entry, *option);
      if (!text) return fail(ErrorKind::usage, where, "is neither text, nor a number, nor true or false");
      if (auto taken = take_text(*option, *text, where); !taken) return taken;
    }
  }
  return {};
}

Result<Action> Options::parse(std::span<const std::string> arguments) {
  State& s = *state_;
  if (auto done = s.tokenize(arguments); !done) return forward_error(done);
  const auto wanted = [&](std::string_view name) {
    const Option* option = s.find(name);
    return option != nullptr && option->handle->count() > 0;
  };
  if (wanted("--help")) return Action::help;
  if (wanted("--version")) return Action::version;
  if (auto done = s.check_values(); !done) return forward_error(done);
  if (const auto extras = s.app.remaining(); !extras.empty()) {
    return tl::unexpected<Error>(unexpected_argument(extras, s.long_names(0)));
  }
  if (auto done = s.take_positionals(); !done) return forward_error(done);
  if (auto done = s.read_config(); !done) return forward_error(done);
  if (auto done = s.take_options(); !done) return forward_error(done);
  return Action::run;
}

bool Options::given(std::string_view long_name) const {
  const Option* option = state_->find(long_name);
  return option != nullptr && option->given;
}

Result<void> Options::refuse(std::span<const Conflict> conflicts) const {
  for (const Conflict& conflict : conflicts) {
    if (given(conflict.option)) return fail(ErrorKind::usage, conflict.option, conflict.reason);
  }
  return {};
}

Result<void> Options::set_content(const std::string& key, const nlohmann::ordered_json& value) {
  Option* option = state_->find("--" + key);
  if (option == nullptr || option->role != Role::content) {
    std::vector<std::string> names;
    for (const Group& group : state_->groups) {
      for (const Option& other : group.options) {
        if (other.role == Role::content) names.push_back(other.long_name.substr(2));
      }
    }
    const std::string nearest = nearest_word(key, names);
    return fail(ErrorKind::usage, "",
                (option == nullptr ? "unknown option" : "decides nothing of a scene's content") +
                    (nearest.empty() || option != nullptr ? "" : " (did you mean '" + nearest + "'?)"));
  }
  const std::optional<std::string> text = option_text(value, *option);
  if (!text) return fail(ErrorKind::usage, "", "is neither text, nor a number, nor true or false");
  return take_text(*option, *text, "");
}

namespace {

nlohmann::ordered_json typed(const Option& option, const std::string& text) {
  if (option.value.kind == Value::Kind::boolean) return text == "on" || text == "true";
  if (option.value.kind == Value::Kind::number) return nlohmann::ordered_json::parse(text);
  return text;
}

}  // namespace

nlohmann::ordered_json Options::config_value(std::string_view key) const {
  const Option* option = state_->find("--" + std::string(key));
  const std::string text = option == nullptr ? std::string() : option->value.spell();
  return text.empty() ? nlohmann::ordered_json() : typed(*option, text);
}

std::vector<std::string> Options::canonical_arguments() const {
  std::vector<std::string> out;
  for (const Group& group : state_->groups) {
    for (const Option& option : group.options) {
      if (option.role != Role::content || !option.given) continue;
      if (option.repeats()) {
        for (const std::string& text : option.value.spell_all()) {
          out.push_back(option.long_name);
          out.push_back(text);
        }
        continue;
      }
      out.push_back(option.long_name);
      if (!option.is_flag()) out.push_back(option.value.spell());
    }
  }
  return out;
}

nlohmann::ordered_json Options::config(std::span<const Conflict> left_out) const {
  nlohmann::ordered_json out = nlohmann::ordered_json::object();
  for (const Group& group : state_->groups) {
    for (const Option& option : group.options) {
      const bool wanted = option.role == Role::content || (option.role == Role::run && option.given);
      const bool refused = std::any_of(left_out.begin(), left_out.end(),
                                       [&](const Conflict& c) { return c.option == option.long_name; });
      if (wanted && !refused && option.repeats() && !option.value.spell_all().empty())
        out[option.long_name.substr(2)] = option.value.spell_all();
      const std::string text = option.value.spell();
      if (!wanted || refused || text.empty()) continue;
      out[option.long_name.substr(2)] = typed(option, text);
    }
  }
  return out;
}

namespace {

/// "  --grid WxL             buildings along x and y (default: 1x1; 1x1 to 1000x1000)"
void append_entry(std::string& out, std::string left, const std::string& right) {
  constexpr std::size_t kColumn = 26;
  std::string line = "  " + std::move(left);
  const std::vector<std::string> lines = wrap(right, kLineWidth - kColumn);
  if (display_width(line) + 2 > kColumn) {
    out += line + "\n";
    line.clear();
  }
  for (const std::string& text : lines) {
    line.resize(std::max(line.size(), kColumn), ' ');
    out += line + text + "\n";
    line.clear();
  }
}

std::string described(const Option& option) {
  std::string facts;
  if (!option.value.range.empty()) facts = option.value.range;
  if (!option.is_flag() && !option.default_text.empty()) {
    facts += (facts.empty() ? "default: " : "; default: ") + option.default_text;
  }
  return option.help + (facts.empty() ? "" : " (" + facts + ")");
}

std::string heading(const std::string& title, bool colored) {
  return colored ? "\n\x1b[1m" + title + "\x1b[0m\n" : "\n" + title + "\n";
}

}  // namespace

std::string Options::help(bool colored) const {
  const State& s = *state_;
  std::string out;
  for (const std::string& line : wrap(s.program + ": " + s.summary, kLineWidth)) {
    out += line + "\n";
  }
  out += heading("Usage:", colored);
  for (const std::string& line : s.usage) out += "  " + line + "\n";
  if (!s.positionals.empty()) out += heading("Arguments:", colored);
  for (const Positional& positional : s.positionals) append_entry(out, positional.name, positional.help);
  for (const Group& group : s.groups) {
    out += heading(group.title + ":", colored);
    for (const Option& option : group.options) {
      std::string left = option.names;
      if (const std::size_t comma = left.find(','); comma != std::string::npos) left.insert(comma + 1, " ");
      if (!option.is_flag()) left += " " + option.value.form;
      append_entry(out, std::move(left), described(option));
    }
  }
  return out;
}

std::string Options::version() const {
  return state_->program.substr(0, state_->program.find(' ')) + " " SCENEGEN_VERSION "\n";
}

std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; },
      '?');
  return text;
}

int report_error(const Error& error) {
  const std::string line = printable(error.str());
  std::fprintf(stderr, colored(2) ? "\x1b[1;31merror:\x1b[0m %s\n" : "error: %s\n", line.c_str());
  return static_cast<int>(error.kind);
}

namespace {

int report_exception(const std::exception_ptr& exception) {
  try {
    if (exception) std::rethrow_exception(exception);
    (void)std::fputs("error: internal error\n", stderr);
  } catch (const std::bad_alloc&) {
    (void)std::fputs("error: out of memory (a smaller scene needs less)\n", stderr);
  } catch (const std::system_error& error) {  // no more threads
    (void)std::fprintf(stderr, "error: the system refused: %s\n", error.what());
  } catch (const std::exception& error) {
    (void)std::fprintf(stderr, "error: internal error: %s\n", error.what());
  } catch (...) {
    (void)std::fputs("error: internal error\n", stderr);
  }
  return static_cast<int>(ErrorKind::bad_input);
}

/// An exception in a worker thread ends here; the process must not end by a signal.
[[noreturn]] void on_terminate() {
  std::_Exit(report_exception(std::current_exception()));
}

}  // namespace

int guarded_main(int argc, char** argv, int (*body)(std::span<const std::string>)) {
  (void)std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a write error
  (void)std::signal(SIGXFSZ, SIG_IGN);  // so is a file that grows too large
  remove_temporary_files_on_signals();
  std::set_terminate(on_terminate);
  try {
    const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    return body(arguments);
  } catch (...) {
    return report_exception(std::current_exception());
  }
}

}  // namespace scenegen::tools
