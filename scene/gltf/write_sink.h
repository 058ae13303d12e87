// Where bytes go: a file descriptor, or nowhere (counting).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>

namespace scenegen::gltf {

/// Buffered output of bytes. With descriptor -1 it only counts, so that the same code gives a size and, run
/// again, the bytes. After a failed write(2) everything is dropped; error() keeps the errno of the first
/// failure.
class ByteSink {
 public:
  explicit ByteSink(int descriptor = -1);
  /// Appends to `memory` at every flush().
  explicit ByteSink(std::string& memory);

  /// Room for at least `most` (<= kRoom) bytes; commit() the end of what was put there.
  char* reserve(std::size_t most) {
    if (static_cast<std::size_t>(buffer_.get() + capacity_ - end_) < most) flush();
    return end_;
  }
  void commit(char* end) { end_ = end; }
  void write(const void* bytes, std::size_t count) {
    if (count == 0) return;  // memcpy must not see the null of an empty vector
    if (count > kRoom) return write_large(static_cast<const char*>(bytes), count);
    char* to = reserve(count);
    std::memcpy(to, bytes, count);
    end_ = to + count;
  }
  void fill(char byte, std::size_t count);
  void flush();

  /// Bytes given so far.
  [[nodiscard]] std::uint64_t total() const {
    return flushed_ + static_cast<std::uint64_t>(end_ - buffer_.get());
  }
  [[nodiscard]] bool failed() const { return error_ != 0; }
  [[nodiscard]] int error() const { return error_; }

  static constexpr std::size_t kRoom = 4096;

 private:
  void write_large(const char* bytes, std::size_t count);
  void write_out(const char* bytes, std::size_t count);

  static constexpr std::size_t kBufferBytes = 256 * 1024;  // larger does not make write(2) faster
  ByteSink(std::size_t capacity, int descriptor);

  std::size_t capacity_;
  std::unique_ptr<char[]> buffer_;
  char* end_;
  std::uint64_t flushed_ = 0;
  int descriptor_;
  std::string* memory_ = nullptr;
  int error_ = 0;
};

}  // namespace scenegen::gltf
