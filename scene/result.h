// Errors about data from outside (files, arguments): located, one line, never an exception across a room's
// border.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <utility>

namespace scenegen {

/// The numbers are the exit codes of the programs (docs/CLI.md).
enum class ErrorKind { bad_input = 1, usage = 2, io = 3, no_device = 4 };

/// What went wrong with data from outside. `str()` is the one line a person reads.
struct Error {
  ErrorKind kind = ErrorKind::bad_input;
  std::string where;  ///< option, file, file + JSON pointer, or file + line: "town.glb: /nodes/17/mesh"
  std::string what;   ///< what is wrong, what was allowed, and the nearest valid value where there is one

  [[nodiscard]] std::string str() const { return where.empty() ? what : where + ": " + what; }
};

template <class T>
using Result = tl::expected<T, Error>;

/// `return fail(ErrorKind::bad_input, "town.glb: /nodes/17/mesh", "index 90 of 12 meshes");`
inline tl::unexpected<Error> fail(ErrorKind kind, std::string where, std::string what) {
  return tl::unexpected<Error>(Error{kind, std::move(where), std::move(what)});
}

/// Passes the error of a failed Result on to a caller whose Result has another type.
template <class T>
tl::unexpected<Error> forward_error(Result<T>& result) {
  return tl::unexpected<Error>(std::move(result.error()));
}

}  // namespace scenegen
