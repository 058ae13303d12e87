#include "scene/temporary_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>

namespace scenegen {
namespace {

// Nothing but lock-free atomics and system calls: the handler may run at any point of any thread.
enum class Slot : int { empty, filling, used };
struct Remembered {
  std::atomic<Slot> state{Slot::empty};
  std::array<char, 4096> path{};
};
static_assert(std::atomic<Slot>::is_always_lock_free);

std::array<Remembered, 256> remembered;
std::atomic<int> creating{0};  // threads between "may I" and "it is remembered"
std::atomic<bool> ending{false};

constexpr std::array kEndingSignals{SIGINT, SIGTERM, SIGHUP};

sigset_t ending_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : kEndingSignals) sigaddset(&set, signal);
  return set;
}

int remember(const std::string& path) {
  for (std::size_t i = 0; i < remembered.size(); ++i) {
    Remembered& slot = remembered[i];
    Slot expected = Slot::empty;
    if (path.size() >= slot.path.size()) return -1;
    if (!slot.state.compare_exchange_strong(expected, Slot::filling)) continue;
    path.copy(slot.path.data(), path.size());
    slot.path[path.size()] = '\0';
    slot.state = Slot::used;
    return static_cast<int>(i);
  }
  return -1;
}

extern "C" void remove_and_end(int signal) {
  ending = true;
  // A thread that creates a file has these signals blocked, so this is not that thread; it is done soon.
  constexpr timespec kMillisecond{0, 1'000'000};
  for (int i = 0; i < 1000 && creating != 0; ++i) (void)::nanosleep(&kMillisecond, nullptr);
  for (const Remembered& slot : remembered) {
    if (slot.state == Slot::used) (void)::unlink(slot.path.data());
  }
  (void)::raise(signal);  // SA_RESETHAND: the default action, as soon as this returns
}

}  // namespace

TemporaryFile create_temporary_file(const std::string& path) {
  const sigset_t blocked = ending_signals();
  sigset_t before;
  (void)::pthread_sigmask(SIG_BLOCK, &blocked, &before);
  ++creating;
  if (ending) {  // nobody would remove the file any more; the process ends in a moment
    --creating;
    for (;;) (void)::pause();
  }
  TemporaryFile file;
  file.descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  const int error_number = errno;
  if (file.descriptor >= 0) file.slot = remember(path);
  --creating;
  (void)::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = error_number;
  return file;
}

void forget_temporary_file(int slot) {
  if (slot >= 0) remembered[static_cast<std::size_t>(slot)].state = Slot::empty;
}

void remove_temporary_files_on_signals() {
  for (const int signal : kEndingSignals) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;  // nohup
    action = {};
    action.sa_handler = remove_and_end;
    action.sa_mask = ending_signals();
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    (void)::sigaction(signal, &action, nullptr);
  }
}

}  // namespace scenegen
