#include "scene/import/child.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <new>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SCENEGEN_SHADOW_MEMORY 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SCENEGEN_SHADOW_MEMORY 1
#endif
#endif

namespace scenegen::import {

namespace {

constexpr int kOutOfMemory = 3;  // exit codes of the child
constexpr int kOtherFailure = 4;

void lower(int resource, std::uint64_t wanted) {
  struct rlimit limit {};
  if (::getrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0) return;
  if (limit.rlim_max != RLIM_INFINITY) wanted = std::min<std::uint64_t>(wanted, limit.rlim_max);
  if (limit.rlim_cur != RLIM_INFINITY) wanted = std::min<std::uint64_t>(wanted, limit.rlim_cur);
  limit.rlim_cur = wanted;
  (void)::setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

#ifndef SCENEGEN_SHADOW_MEMORY
std::uint64_t address_space_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}
#endif

void restrain(const ChildLimits& limits, pid_t parent) {
  (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kOtherFailure);  // it died before the line above
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
    (void)::signal(signal, SIG_DFL);  // the parent's handlers would remove its temporary files
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (int descriptor = 0; descriptor < 3; ++descriptor) (void)::dup2(nowhere, descriptor);
  lower(RLIMIT_CORE, 0);
  lower(RLIMIT_CPU, limits.cpu_s);
  lower(RLIMIT_FSIZE, 0);  // it reads files and writes none
#ifndef SCENEGEN_SHADOW_MEMORY
  lower(RLIMIT_AS, address_space_bytes() + limits.memory_bytes);
#endif
}

[[noreturn]] void be_child(const std::function<void(int descriptor)>& body, int pipe_end,
                           const ChildLimits& limits, pid_t parent) {
  restrain(limits, parent);
  int code = 0;
  try {
    body(pipe_end);
  } catch (const std::bad_alloc&) {
    code = kOutOfMemory;
  } catch (...) {
    code = kOtherFailure;
  }
  ::_exit(code);  // no destructors, no buffers of the parent's streams
}

/// Until the child closes its end; false when it takes too long or sends too much.
ChildOutcome::End collect(int pipe_end, const ChildLimits& limits, std::vector<std::uint8_t>& out) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::seconds(10 * limits.cpu_s);
  constexpr std::size_t kStep = 1 << 20;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return ChildOutcome::End::too_long;
    struct pollfd wait {
      pipe_end, POLLIN, 0
    };
    const int ready = ::poll(&wait, 1, static_cast<int>(std::min<long>(left, 60'000)));
    if (ready <= 0) continue;
    const std::size_t before = out.size();
    if (before + kStep > limits.output_bytes) return ChildOutcome::End::too_much_output;
    out.resize(before + kStep);
    const ssize_t n = ::read(pipe_end, out.data() + before, kStep);
    out.resize(before + static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
    if (n == 0 || (n < 0 && errno != EINTR)) return ChildOutcome::End::finished;
  }
}

ChildOutcome::End how_it_ended(int status) {
  if (WIFEXITED(status)) {
    if (WEXITSTATUS(status) == 0) return ChildOutcome::End::finished;
    return WEXITSTATUS(status) == kOutOfMemory ? ChildOutcome::End::too_much_memory
                                               : ChildOutcome::End::crashed;
  }
  return WTERMSIG(status) == SIGXCPU ? ChildOutcome::End::too_long : ChildOutcome::End::crashed;
}

}  // namespace

ChildOutcome run_in_child(const std::function<void(int descriptor)>& body, const ChildLimits& limits) {
  ChildOutcome out;
  const auto not_started = [&out] {
    out.end = ChildOutcome::End::not_started;
    out.code = errno;
    return out;
  };
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return not_started();
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child < 0) {
    const int code = errno;
    ::close(ends[0]);
    ::close(ends[1]);
    errno = code;
    return not_started();
  }
  if (child == 0) {
    ::close(ends[0]);
    be_child(body, ends[1], limits, parent);
  }
  ::close(ends[1]);
  const ChildOutcome::End read = collect(ends[0], limits, out.bytes);
  ::close(ends[0]);
  if (read != ChildOutcome::End::finished) (void)::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  out.end = read != ChildOutcome::End::finished ? read : how_it_ended(status);
  if (WIFSIGNALED(status)) out.code = WTERMSIG(status);
  return out;
}

}  // namespace scenegen::import
