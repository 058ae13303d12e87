#include "tools/output.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace scenegen::tools {

using nlohmann::ordered_json;

Value format_value(Format& target) {
  return choice_value<Format>(
      target, {{"table", Format::table}, {"json", Format::json}, {"csv", Format::csv}}, "FORMAT");
}

std::string pretty(const ordered_json& json) {
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

namespace {

std::string csv_cell(const ordered_json& value) {
  std::string text;
  if (value.is_string()) {
    text = value.get<std::string>();
  } else if (!value.is_null()) {
    text = value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  }
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + "\"";
}

void append_csv(std::string& out, const std::string& key, const ordered_json& value) {
  if (value.is_structured()) {
    const std::string parent = key.empty() ? key : key + "/";
    for (const auto& [name, member] : value.items()) append_csv(out, parent + name, member);
  } else {
    out += csv_cell(key) + "," + csv_cell(value) + "\n";
  }
}

}  // namespace

// ---- Report ----------------------------------------------------------------------------------------------

void Report::section(std::string title) {
  sections_.push_back({std::move(title), {}});
}

void Report::add(Fact fact) {
  if (sections_.empty()) section("");
  sections_.back().facts.push_back(std::move(fact));
}

ordered_json Report::json() const {
  ordered_json out;
  out["schema"] = schema_;
  out["version"] = version_;
  for (const Section& section : sections_) {
    for (const Fact& fact : section.facts) {
      if (!fact.key.empty()) out[ordered_json::json_pointer("/" + fact.key)] = fact.value;
    }
  }
  return out;
}

std::string Report::table() const {
  constexpr std::size_t kLineWidth = 100;
  std::size_t width = 0;
  for (const Section& section : sections_) {
    for (const Fact& fact : section.facts) {
      if (!fact.text.empty()) width = std::max(width, display_width(fact.label));
    }
  }
  std::string out;
  for (const Section& section : sections_) {
    if (std::all_of(section.facts.begin(), section.facts.end(), [](const Fact& f) { return f.text.empty(); }))
      continue;
    if (!section.title.empty()) out += (out.empty() ? "" : "\n") + section.title + "\n";
    for (const Fact& fact : section.facts) {
      if (fact.text.empty()) continue;
      std::string left = "  " + fact.label;
      left.append(width - display_width(fact.label) + 2, ' ');
      for (const std::string& line : wrap(fact.text, kLineWidth - width - 4)) {
        out += left + line + "\n";
        left.assign(width + 4, ' ');
      }
    }
  }
  return out;
}

std::string Report::csv() const {
  std::string out = "key,value\n";
  append_csv(out, "", json());
  return out;
}

std::string Report::str(Format format) const {
  if (format == Format::json) return pretty(json());
  return format == Format::csv ? csv() : table();
}

// ---- Table -----------------------------------------------------------------------------------------------

void Table::row(std::vector<ordered_json> values) {
  rows_.push_back(std::move(values));
}

ordered_json Table::json() const {
  ordered_json out = ordered_json::array();
  for (const auto& values : rows_) {
    ordered_json row = ordered_json::object();
    for (std::size_t i = 0; i < columns_.size(); ++i) row[columns_[i].name] = values[i];
    out.push_back(std::move(row));
  }
  return out;
}

namespace {

std::string table_cell(const ordered_json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return human_real(value.get<double>(), 3);
  return value.is_null() ? "-" : value.dump();
}

std::string padded(const std::string& text, std::size_t width, bool right) {
  const std::string blanks(width - std::min(width, display_width(text)), ' ');
  return right ? blanks + text : text + blanks;
}

}  // namespace

std::string Table::str(Format format) const {
  if (format == Format::json) return pretty(json());
  std::string out;
  if (format == Format::csv) {
    for (std::size_t i = 0; i < columns_.size(); ++i) out += (i == 0 ? "" : ",") + csv_cell(columns_[i].name);
    out += "\n";
    for (const auto& values : rows_) {
      for (std::size_t i = 0; i < columns_.size(); ++i) out += (i == 0 ? "" : ",") + csv_cell(values[i]);
      out += "\n";
    }
    return out;
  }
  std::vector<std::size_t> widths;
  std::vector<bool> right;  // by column: it holds numbers
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    std::size_t width = display_width(columns_[i].title);
    for (const auto& values : rows_) width = std::max(width, display_width(table_cell(values[i])));
    widths.push_back(width);
    right.push_back(
        std::any_of(rows_.begin(), rows_.end(), [i](const auto& values) { return values[i].is_number(); }));
  }
  const auto append_line = [&](const auto& cell) {
    std::string line;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      line += (i == 0 ? "" : "  ") + padded(cell(i), widths[i], right[i]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  };
  append_line([&](std::size_t i) { return columns_[i].title; });
  for (const auto& values : rows_) append_line([&](std::size_t i) { return table_cell(values[i]); });
  return out;
}

// ---- Files -----------------------------------------------------------------------------------------------

namespace {

tl::unexpected<Error> cannot_write(const std::string& path, int error_number) {
  return fail(
      ErrorKind::io, path,
      "cannot be written: " + std::string(std::strerror(error_number)));  // NOLINT(concurrency-mt-unsafe)
}

/// 0 or the error number.
int write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return 0;
}

bool special_file(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

}  // namespace

Result<void> write_stdout(std::string_view text) {
  (void)std::fflush(stdout);
  if (const int error_number = write_all(STDOUT_FILENO, text); error_number != 0) {
    return cannot_write("standard output", error_number);
  }
  return {};
}

Result<gltf::OutputFile> prepare_file(const std::string& path, std::string_view bytes) {
  if (path == "-") (void)std::fflush(stdout);
  auto file = gltf::OutputFile::open(path);
  if (!file) return forward_error(file);
  if (const int error_number = write_all(file->descriptor(), bytes); error_number != 0)
    return cannot_write(path == "-" ? "standard output" : path, error_number);
  if (auto closed = file->close(); !closed) return forward_error(closed);
  return file;
}

Result<void> write_file(const std::string& path, std::string_view bytes) {
  auto file = prepare_file(path, bytes);
  return file ? file->commit() : forward_error(file);
}

Result<void> check_output_file(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode)) return cannot_write(path, EISDIR);
  const std::string folder = folder_of(path);
  if (::stat(folder.c_str(), &status) != 0) return cannot_write(path, errno);
  if (!S_ISDIR(status.st_mode)) return cannot_write(path, ENOTDIR);
  if (path.ends_with('/')) return cannot_write(path, EISDIR);
  if (!special_file(path) && ::access(folder.c_str(), W_OK | X_OK) != 0) return cannot_write(path, errno);
  return {};
}

Result<void> make_folder(const std::string& folder, const std::string& file) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder, error))
    return fail(ErrorKind::io, folder, error ? "cannot be made: " + error.message() : "is no folder");
  if (file.empty()) return {};
  return check_output_file((std::filesystem::path(folder) / file).string());
}

namespace {

/// Empty for what is no file.
std::filesystem::path real_path(const std::string& path) {
  if (path.empty() || path == "-" || special_file(path)) return {};
  std::error_code failed;  // then nothing can be written there, which is said elsewhere
  return std::filesystem::weakly_canonical(std::filesystem::absolute(path, failed), failed);
}

bool same_file(const NamedPath& a, const NamedPath& b) {
  const std::filesystem::path real = real_path(a.path);
  return !real.empty() && real == real_path(b.path);
}

}  // namespace

Result<void> check_distinct_files(const std::vector<NamedPath>& outputs,
                                  const std::vector<NamedPath>& inputs) {
  std::vector<NamedPath> before;
  for (const NamedPath& output : outputs) {
    std::vector<NamedPath> writes{output};
    if (const std::filesystem::path path(output.path); path.extension() == ".gltf")
      writes.push_back({output.option, std::filesystem::path(path).replace_extension(".bin").string()});
    for (const NamedPath& file : writes) {
      for (const NamedPath& other : before) {
        if (file.path == "-" && other.path == "-")
          return fail(ErrorKind::usage, file.option,
                      "cannot be used with " + other.option + " -: stdout takes one of them");
        if (same_file(file, other))
          return fail(ErrorKind::usage, file.option,
                      "would overwrite '" + other.path + "', which " + other.option + " writes");
      }
      for (const NamedPath& input : inputs) {
        if (same_file(file, input))
          return fail(ErrorKind::usage, file.option,
                      "would overwrite '" + input.path + "', which is read (" + input.option + ")");
      }
    }
    before.insert(before.end(), writes.begin(), writes.end());
  }
  return {};
}

// ---- Terminal --------------------------------------------------------------------------------------------

bool terminal(int file_descriptor) {
  return ::isatty(file_descriptor) == 1;
}

bool colored(int file_descriptor) {
  const char* no_color = std::getenv("NO_COLOR");  // NOLINT(concurrency-mt-unsafe): nobody sets variables
  const char* term = std::getenv("TERM");          // NOLINT(concurrency-mt-unsafe)
  const bool dumb = term != nullptr && std::strcmp(term, "dumb") == 0;
  return terminal(file_descriptor) && (no_color == nullptr || *no_color == '\0') && !dumb;
}

Progress::Progress(std::string label, std::uint64_t total, bool quiet)
    : label_(std::move(label)), total_(total), active_(!quiet && terminal(STDERR_FILENO)) {}

Progress::~Progress() {
  clear();
}

void Progress::clear() {
  if (std::exchange(drawn_, false)) (void)std::fputs("\r\x1b[K", stderr);
}

void Progress::advance(std::uint64_t count) {
  done_ += count;
  draw();
}

void Progress::stage(std::string label) {
  label_ = std::move(label);
  if (!active_) return;
  (void)std::fprintf(stderr, "\r\x1b[K%s ...", label_.c_str());
  (void)std::fflush(stderr);
  drawn_ = true;
}

void Progress::show(double spent_s, double left_s) {
  if (due()) draw(spent_s / std::max(spent_s + left_s, 1e-9), left_s);
}

bool Progress::due() {
  constexpr auto kPatience = std::chrono::milliseconds(500);
  constexpr auto kBetween = std::chrono::milliseconds(100);
  const Clock::time_point now = Clock::now();
  if (!active_ || now - start_ < kPatience || now - last_draw_ < kBetween) return false;
  last_draw_ = now;
  return true;
}

void Progress::draw() {
  if (total_ == 0 || !due()) return;
  const double share = std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_));
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - start_).count();
  draw(share, share > 0 ? elapsed_s * (1 - share) / share : 0);
}

void Progress::draw(double share, double left_s) {
  constexpr std::size_t kBar = 30;
  const auto filled = static_cast<std::size_t>(share * static_cast<double>(kBar));
  const std::string bar = std::string(filled, '#') + std::string(kBar - filled, '.');
  (void)std::fprintf(stderr, "\r\x1b[K%s [%s] %3.0f %%  %s left", label_.c_str(), bar.c_str(), share * 100,
                     human_seconds(left_s).c_str());
  (void)std::fflush(stderr);
  drawn_ = true;
}

}  // namespace scenegen::tools
