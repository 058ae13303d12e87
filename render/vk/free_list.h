// First-fit suballocation of a range of bytes: the arithmetic of device memory, testable without a device.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace scenegen::render::vkr {

class FreeList {
 public:
  explicit FreeList(std::uint64_t bytes) : size_(bytes) {
    if (bytes > 0) free_[0] = bytes;
  }

  /// Offset of a free piece of `bytes` > 0 bytes at a multiple of `alignment` (a power of two).
  [[nodiscard]] std::optional<std::uint64_t> allocate(std::uint64_t bytes, std::uint64_t alignment);
  /// Gives a piece back exactly as it was allocated.
  void release(std::uint64_t offset, std::uint64_t bytes);
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t free_bytes() const;
  [[nodiscard]] bool unused() const { return free_bytes() == size_; }
  [[nodiscard]] std::size_t piece_count() const { return free_.size(); }

 private:
  std::uint64_t size_;
  std::map<std::uint64_t, std::uint64_t> free_;  // offset -> bytes; neighbours are always joined
};

}  // namespace scenegen::render::vkr
