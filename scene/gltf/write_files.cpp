#include "scene/gltf/write_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <utility>

#include "scene/temporary_files.h"

namespace scenegen::gltf {

OutputFile::OutputFile(OutputFile&& other) noexcept
    : shown_(std::move(other.shown_)),
      target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      slot_(std::exchange(other.slot_, -1)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      owns_descriptor_(other.owns_descriptor_) {}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0 && owns_descriptor_) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  forget_temporary_file(slot_);
}

tl::unexpected<Error> OutputFile::error(int code) const {
  return fail(ErrorKind::io, shown_, std::strerror(code));
}

Result<OutputFile> OutputFile::open(const std::string& path) {
  OutputFile file;
  file.shown_ = path == "-" ? "standard output" : path;
  if (path == "-") {
    file.descriptor_ = STDOUT_FILENO;
    file.owns_descriptor_ = false;
    return file;
  }
  // Through symbolic links: the file they point at is replaced, not the link.
  std::error_code ignored;
  file.target_ = path;
  if (std::filesystem::is_symlink(path, ignored)) {
    const std::filesystem::path resolved = std::filesystem::weakly_canonical(path, ignored);
    if (!ignored && !resolved.empty()) file.target_ = resolved.string();
  }
  struct stat before {};
  const bool exists = ::stat(file.target_.c_str(), &before) == 0;
  if (exists && S_ISDIR(before.st_mode)) return file.error(EISDIR);
  if (exists && !S_ISREG(before.st_mode)) {  // a device or a pipe
    file.descriptor_ = ::open(file.target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (file.descriptor_ < 0) return file.error(errno);
    return file;
  }
  if (exists && ::access(file.target_.c_str(), W_OK) != 0) return file.error(errno);
  for (int attempt = 0; file.descriptor_ < 0; ++attempt) {
    std::string temporary = file.target_ + ".tmp" + std::to_string(::getpid());
    if (attempt > 0) temporary += "." + std::to_string(attempt);
    const TemporaryFile made = create_temporary_file(temporary);
    if (made.descriptor >= 0) {
      file.descriptor_ = made.descriptor;
      file.slot_ = made.slot;
      file.temporary_ = std::move(temporary);
    } else if (errno != EEXIST || attempt == 100) {
      return file.error(errno);
    }
  }
  if (exists) (void)::fchmod(file.descriptor_, before.st_mode & 07777);  // the mode is a courtesy
  return file;
}

Result<void> OutputFile::close() {
  if (!owns_descriptor_ || descriptor_ < 0) return {};
  if (::close(std::exchange(descriptor_, -1)) != 0) return error(errno);
  return {};
}

Result<void> OutputFile::commit() {
  if (temporary_.empty()) return {};
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) return error(errno);
  temporary_.clear();
  return {};
}

Result<void> commit_all(std::vector<OutputFile>& files) {
  std::string placed;
  for (OutputFile& file : files) {
    if (Result<void> done = file.commit(); !done) {
      if (!placed.empty()) done.error().what += "; " + placed + " is already the new one";
      return done;
    }
    placed += (placed.empty() ? "" : ", ") + file.path();
  }
  return {};
}

BlockSigpipe::BlockSigpipe() {
  sigset_t pending, pipe;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  sigpending(&pending);
  was_pending_ = sigismember(&pending, SIGPIPE) == 1;
  pthread_sigmask(SIG_BLOCK, &pipe, &before_);
}

BlockSigpipe::~BlockSigpipe() {
  sigset_t pipe;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  const timespec now{};
  if (!was_pending_) {
    while (sigtimedwait(&pipe, nullptr, &now) < 0 && errno == EINTR) {
    }
  }
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace scenegen::gltf
