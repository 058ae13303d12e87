#include "tests/tools/process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace scenegen::test {

namespace {

constexpr unsigned kMostSeconds = 120;

void limit(int resource, const std::optional<std::uint64_t>& most) {
  if (!most) return;
  const rlimit both{*most, *most};
  if (::setrlimit(static_cast<__rlimit_resource>(resource), &both) != 0) ::_exit(126);
}

void redirect(const char* path, int flags, int target) {
  const int file = ::open(path, flags, 0600);
  if (file < 0 || ::dup2(file, target) < 0) ::_exit(126);
}

[[noreturn]] void become(std::vector<char*> argv, const ProcessOptions& options, const std::string& out,
                         const std::string& err) {
  redirect("/dev/null", O_RDONLY, STDIN_FILENO);
  redirect(out.c_str(), O_WRONLY | O_CREAT, STDOUT_FILENO);
  redirect(err.c_str(), O_WRONLY | O_CREAT, STDERR_FILENO);
  if (options.stdout_closed_pipe) {
    int ends[2];
    if (::pipe(ends) != 0 || ::dup2(ends[1], STDOUT_FILENO) < 0) ::_exit(126);
    (void)::close(ends[0]);
    (void)::close(ends[1]);
  }
  if (::chdir(options.folder.c_str()) != 0) ::_exit(126);
  limit(RLIMIT_FSIZE, options.most_file_bytes);
  limit(RLIMIT_AS, options.most_memory_bytes);
  (void)::alarm(kMostSeconds);
  (void)::execv(argv[0], argv.data());
  ::_exit(127);
}

}  // namespace

ProcessResult run(const std::string& program, const std::vector<std::string>& arguments,
                  const ProcessOptions& options) {
  const TemporaryFolder caught;
  const std::string out = options.stdout_path.empty() ? caught.file("out") : options.stdout_path;
  const std::string err = caught.file("err");
  std::vector<std::string> all{program};
  all.insert(all.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& argument : all) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) become(std::move(argv), options, out, err);
  int status = 0;
  bool ended = false;
  while (options.interrupt != 0 && !ended) {
    ended = ::waitpid(child, &status, WNOHANG) == child;
    if (ended || !options.interrupt_when()) continue;
    (void)::kill(child, options.interrupt);
    break;
  }
  while (!ended && ::waitpid(child, &status, 0) < 0) {
  }
  ProcessResult result;
  if (WIFEXITED(status)) result.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  if (options.stdout_path.empty()) result.out = read_file(out);
  result.err = read_file(err);
  return result;
}

std::vector<std::string> words(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "scenegen-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> TemporaryFolder::entries() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_file(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

void check_error(const ProcessResult& result, int code, const std::string& part) {
  INFO(result.err);
  CHECK(result.signal == 0);
  CHECK(result.code == code);
  CHECK(result.out.empty());
  CHECK(result.err.starts_with("error: "));
  CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  CHECK_THAT(result.err, Catch::Matchers::Contains(part));
}

}  // namespace scenegen::test
