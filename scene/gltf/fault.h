// Errors inside the reader: a place in the document and an exception that read() turns into an Error. Private
// to scene/gltf; nothing is thrown across the room's border.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "scene/result.h"

namespace scenegen::gltf::reading {

/// A JSON pointer as a chain of places on the stack: costs nothing until it is printed. A Place refers to the
/// one it was made from, which must outlive it: `at.key("a").at(3)` is good as an argument, not as a
/// variable.
struct Place {
  const Place* up = nullptr;
  std::string_view name;  ///< member of an object when its data() is set
  std::uint64_t index = 0;

  [[nodiscard]] Place key(std::string_view k) const { return {this, k, 0}; }
  [[nodiscard]] Place at(std::uint64_t i) const { return {this, {}, i}; }
  /// "/nodes/17/mesh"; "" is the whole document.
  [[nodiscard]] std::string str() const;
};

/// Thrown by everything below read(); carries the pointer, not yet the file's name.
struct Fault {
  Error error;
};

[[noreturn]] void reject(const Place& at, std::string what, ErrorKind kind = ErrorKind::bad_input);

/// Text from a file made fit for one line of output: at most `most` bytes, control characters as '?'.
[[nodiscard]] std::string printable(std::string_view text, std::size_t most = 80);

/// "nodes/17": index checked against the size of what it points into.
void check_index(std::uint64_t index, std::uint64_t count, std::string_view kind, const Place& at);

}  // namespace scenegen::gltf::reading
