#include "render/vk/free_list.h"

#include <cassert>

namespace scenegen::render::vkr {

std::optional<std::uint64_t> FreeList::allocate(std::uint64_t bytes, std::uint64_t alignment) {
  assert(bytes > 0 && (alignment & (alignment - 1)) == 0);
  for (auto it = free_.begin(); it != free_.end(); ++it) {
    const auto [begin, length] = *it;
    const std::uint64_t offset = (begin + alignment - 1) & ~(alignment - 1);
    const std::uint64_t skipped = offset - begin;
    if (skipped > length || length - skipped < bytes) continue;
    free_.erase(it);
    if (skipped > 0) free_[begin] = skipped;
    if (const std::uint64_t rest = length - skipped - bytes; rest > 0) free_[offset + bytes] = rest;
    return offset;
  }
  return std::nullopt;
}

void FreeList::release(std::uint64_t offset, std::uint64_t bytes) {
  auto [it, inserted] = free_.emplace(offset, bytes);
  assert(inserted);
  if (const auto next = std::next(it); next != free_.end() && offset + bytes == next->first) {
    it->second += next->second;
    free_.erase(next);
  }
  if (it != free_.begin()) {
    const auto previous = std::prev(it);
    assert(previous->first + previous->second <= offset);
    if (previous->first + previous->second == offset) {
      previous->second += it->second;
      free_.erase(it);
    }
  }
}

std::uint64_t FreeList::free_bytes() const {
  std::uint64_t sum = 0;
  for (const auto& [offset, bytes] : free_) sum += bytes;
  return sum;
}

}  // namespace scenegen::render::vkr
