// What a program says: data on stdout, everything else on stderr; files that are whole or not there.
#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scene/gltf/write_files.h"
#include "scene/result.h"
#include "tools/cli.h"

namespace scenegen::tools {

enum class Format : std::uint8_t { table, json, csv };
[[nodiscard]] Value format_value(Format& target);

/// One fact: a line of a table, a member of the JSON, a row of the CSV.
struct Fact {
  std::string key;    ///< JSON pointer without the first slash: "events/mean"
  std::string label;  ///< "events per moment"
  nlohmann::ordered_json value;
  std::string text;  ///< for people: "9.3 (1 to 12)"; empty: not in the table
};

/// Facts under headings, in one of three forms. `schema` and `version` open the JSON.
class Report {
 public:
  Report(std::string schema, int version) : schema_(std::move(schema)), version_(version) {}

  void section(std::string title);
  void add(Fact fact);
  [[nodiscard]] nlohmann::ordered_json json() const;
  /// Ends with a newline. Table: two columns, at most 100 characters a line. CSV (RFC 4180): key,value.
  [[nodiscard]] std::string str(Format format) const;

 private:
  struct Section {
    std::string title;
    std::vector<Fact> facts;
  };
  [[nodiscard]] std::string table() const;
  [[nodiscard]] std::string csv() const;

  std::string schema_;
  int version_;
  std::vector<Section> sections_;
};

/// Rows under named columns, for lists that are long or regular (frames, benchmarks).
class Table {
 public:
  struct Column {
    std::string name;   ///< in JSON and CSV
    std::string title;  ///< in the table
  };
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
  /// A number is right-aligned in the table; one value a column.
  void row(std::vector<nlohmann::ordered_json> values);
  [[nodiscard]] nlohmann::ordered_json json() const;  ///< an array of objects
  [[nodiscard]] std::string str(Format format) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<nlohmann::ordered_json>> rows_;
};

/// Two blanks indented; never throws: bytes that are no UTF-8 become U+FFFD. Ends with a newline.
[[nodiscard]] std::string pretty(const nlohmann::ordered_json& json);

/// All of `text` on stdout, or an error (a closed pipe, a full disk).
[[nodiscard]] Result<void> write_stdout(std::string_view text);
/// A file that is complete beside its place: commit() puts it there, else it goes away. What is no file
/// (stdout, a device) is written at once.
[[nodiscard]] Result<gltf::OutputFile> prepare_file(const std::string& path, std::string_view bytes);
/// Writes beside `path` and renames when complete; what was there before stays when it fails. `path` may be
/// "-" (stdout) or a device or pipe, which is written directly.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view bytes);
/// Whether a file can be made at `path`, before the long work: not a folder, its folder is there and
/// writable.
[[nodiscard]] Result<void> check_output_file(const std::string& path);
/// Makes `folder` unless it is there; with `file`, also whether that can be made in it.
[[nodiscard]] Result<void> make_folder(const std::string& folder, const std::string& file = "");
/// A path and the option or argument that gave it; an empty path is no file.
struct NamedPath {
  std::string option, path;
};
/// Whether no output would overwrite an input or another output, before the long work. Paths are the same
/// when they lead to the same place; devices and pipes take what comes.
[[nodiscard]] Result<void> check_distinct_files(const std::vector<NamedPath>& outputs,
                                                const std::vector<NamedPath>& inputs);

[[nodiscard]] bool terminal(int file_descriptor);
/// A terminal that wants colours (https://no-color.org).
[[nodiscard]] bool colored(int file_descriptor);

/// One line on stderr that shows how far long work is: only on a terminal, only after half a second, gone
/// when done. For use from one thread.
class Progress {
 public:
  Progress(std::string label, std::uint64_t total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(std::uint64_t count = 1);
  /// For work that tells its own time: seconds behind it and before it.
  void show(double spent_s, double left_s);
  /// Steps of unlike work: shows the name of the step that begins.
  void stage(std::string label);
  /// Takes the line away until the next step, so that other output has the terminal to itself.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void draw();
  void draw(double share, double left_s);
  /// Whether to draw now.
  bool due();

  std::string label_;
  std::uint64_t total_;
  std::uint64_t done_ = 0;
  bool active_;
  bool drawn_ = false;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_draw_;
};

/// Wall-clock seconds since it was made.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace scenegen::tools
