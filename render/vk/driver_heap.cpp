#include "render/vk/driver_heap.h"

#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace scenegen::render::vkr {
namespace {

using Count = std::atomic<std::uint64_t>;

/// What a piece takes of the heap: its room and the size in front of it.
std::uint64_t taken(void* piece) {
  return malloc_usable_size(piece) + sizeof(std::size_t);
}

void* VKAPI_PTR allocate(void* count, std::size_t bytes, std::size_t alignment, VkSystemAllocationScope) {
  void* piece = nullptr;
  if (alignment <= alignof(std::max_align_t)) {
    piece = std::malloc(bytes);
  } else {
    piece = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  }
  if (piece != nullptr) static_cast<Count*>(count)->fetch_add(taken(piece), std::memory_order_relaxed);
  return piece;
}

void VKAPI_PTR release(void* count, void* piece) {
  if (piece == nullptr) return;
  static_cast<Count*>(count)->fetch_sub(taken(piece), std::memory_order_relaxed);
  std::free(piece);
}

void* VKAPI_PTR reallocate(void* count, void* piece, std::size_t bytes, std::size_t alignment,
                           VkSystemAllocationScope scope) {
  if (bytes == 0) {
    release(count, piece);
    return nullptr;
  }
  void* other = allocate(count, bytes, alignment, scope);
  if (other == nullptr || piece == nullptr) return other;
  std::memcpy(other, piece, std::min(bytes, malloc_usable_size(piece)));
  release(count, piece);
  return other;
}

}  // namespace

DriverHeap::DriverHeap() : callbacks_(&bytes_, &allocate, &reallocate, &release) {}

std::uint64_t process_bytes() {
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  std::array<char, 128> text{};
  const ssize_t length = ::read(file, text.data(), text.size() - 1);
  ::close(file);
  unsigned long long all = 0;
  unsigned long long resident = 0;
  if (length <= 0 || std::sscanf(text.data(), "%llu %llu", &all, &resident) != 2) return 0;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace scenegen::render::vkr
