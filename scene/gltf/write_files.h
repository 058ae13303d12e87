// Files that appear complete or not at all.
#pragma once

#include <csignal>
#include <string>
#include <vector>

#include "scene/result.h"

namespace scenegen::gltf {

/// A file being written. A regular file is written beside its place (`path.tmp<pid>`) and renamed by
/// commit(); without commit() it is removed, also when a signal ends the process
/// (scene/temporary_files.h). stdout ("-") and devices are written in place.
class OutputFile {
 public:
  [[nodiscard]] static Result<OutputFile> open(const std::string& path);
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;
  ~OutputFile();

  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// Written in order only: no pwrite.
  [[nodiscard]] bool streams() const { return temporary_.empty(); }
  /// Closes, reporting what only close(2) finds out (quotas, network file systems).
  [[nodiscard]] Result<void> close();
  /// Puts the closed file in its place.
  [[nodiscard]] Result<void> commit();
  /// As the caller knows it.
  [[nodiscard]] const std::string& path() const { return shown_; }
  /// "town.glb: No space left on device"
  [[nodiscard]] tl::unexpected<Error> error(int code) const;

 private:
  OutputFile() = default;

  std::string shown_;      // the path as the caller knows it
  std::string target_;     // symbolic links resolved
  std::string temporary_;  // empty: in place, or committed
  int slot_ = -1;          // of the temporary file
  int descriptor_ = -1;
  bool owns_descriptor_ = true;
};

/// Puts closed files in their places, in this order. When one cannot be, the error says which already are.
[[nodiscard]] Result<void> commit_all(std::vector<OutputFile>& files);

/// While it lives, writing to a closed pipe gives EPIPE in this thread instead of ending the process.
class BlockSigpipe {
 public:
  BlockSigpipe();
  ~BlockSigpipe();
  BlockSigpipe(const BlockSigpipe&) = delete;
  BlockSigpipe& operator=(const BlockSigpipe&) = delete;

 private:
  sigset_t before_{};
  bool was_pending_ = false;
};

}  // namespace scenegen::gltf
