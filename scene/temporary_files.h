// Files that must not outlive the process, even when a signal ends it.
#pragma once

#include <string>

namespace scenegen {

/// A file that is removed when SIGINT, SIGTERM or SIGHUP ends the process, once
/// remove_temporary_files_on_signals() was called. `descriptor` is -1 when it could not be made (errno says
/// why).
struct TemporaryFile {
  int descriptor = -1;
  int slot = -1;  ///< -1: not remembered (the path is above 4095 bytes or 256 others are open)
};

/// Makes `path` for writing; EEXIST when it is there. For use from several threads.
[[nodiscard]] TemporaryFile create_temporary_file(const std::string& path);
/// The file was renamed or removed; -1 is fine.
void forget_temporary_file(int slot);

/// For the main function of a program: signals that are not ignored remove what is remembered, then end the
/// process as they do by default.
void remove_temporary_files_on_signals();

}  // namespace scenegen
