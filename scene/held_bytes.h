// How much memory containers hold: exact, by capacity, so that what one object costs can be asserted.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

namespace scenegen {

/// Bytes behind a vector: what it reserved, not what it uses. What its elements hold themselves is not in it,
/// nor what the allocator adds (some 8 B an allocation).
template <class T>
[[nodiscard]] std::uint64_t held_bytes(const std::vector<T>& values) {
  return std::uint64_t{values.capacity()} * sizeof(T);
}
template <class T>
[[nodiscard]] std::uint64_t held_bytes(const std::vector<std::vector<T>>& values) {
  std::uint64_t sum = std::uint64_t{values.capacity()} * sizeof(std::vector<T>);
  for (const std::vector<T>& inner : values) sum += held_bytes(inner);
  return sum;
}
/// A deque gives no capacity: what it uses.
template <class T>
[[nodiscard]] std::uint64_t held_bytes(const std::deque<T>& values) {
  return std::uint64_t{values.size()} * sizeof(T);
}
/// Of all of them.
template <class First, class Second, class... Rest>
[[nodiscard]] std::uint64_t held_bytes(const First& first, const Second& second, const Rest&... rest) {
  std::uint64_t sum = held_bytes(first) + held_bytes(second);
  ((sum += held_bytes(rest)), ...);
  return sum;
}

}  // namespace scenegen
