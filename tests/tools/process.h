// Runs a program as a user does: as a process, with its own stdout, stderr and exit code.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace scenegen::test {

struct ProcessOptions {
  std::string folder = ".";                             ///< working folder
  std::string stdout_path = {};                         ///< send stdout there instead of catching it
  bool stdout_closed_pipe = false;                      ///< stdout is a pipe that nobody reads
  std::optional<std::uint64_t> most_file_bytes = {};    ///< RLIMIT_FSIZE: a full disk
  std::optional<std::uint64_t> most_memory_bytes = {};  ///< RLIMIT_AS
  int interrupt = 0;                                    ///< signal to send as soon as `interrupt_when` holds
  std::function<bool()> interrupt_when = {};
};

struct ProcessResult {
  int code = -1;    ///< exit code; -1 when a signal ended it
  int signal = 0;   ///< 0: ended by itself
  std::string out;  ///< stdout
  std::string err;  ///< stderr
};

/// Stdin is empty. Ends it by a signal (and so fails the test) after two minutes.
[[nodiscard]] ProcessResult run(const std::string& program, const std::vector<std::string>& arguments,
                                const ProcessOptions& options = {});

/// That it ended with `code` and one line on stderr, an error that has `part` in it, and nothing else.
void check_error(const ProcessResult& result, int code, const std::string& part);

/// "--grid 4x4" -> {"--grid", "4x4"}.
[[nodiscard]] std::vector<std::string> words(const std::string& line);

/// A folder of its own, removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }
  /// Names of what is in it, sorted.
  [[nodiscard]] std::vector<std::string> entries() const;

 private:
  std::string path_;
};

[[nodiscard]] std::string read_file(const std::string& path);
void write_file(const std::string& path, const std::string& bytes);

}  // namespace scenegen::test
