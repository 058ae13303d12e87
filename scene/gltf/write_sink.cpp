#include "scene/gltf/write_sink.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace scenegen::gltf {

ByteSink::ByteSink(std::size_t capacity, int descriptor)
    : capacity_(capacity), buffer_(new char[capacity]), end_(buffer_.get()), descriptor_(descriptor) {}

ByteSink::ByteSink(int descriptor) : ByteSink(kBufferBytes, descriptor) {}

ByteSink::ByteSink(std::string& memory) : ByteSink(2 * kRoom, -1) {
  memory_ = &memory;
}

void ByteSink::fill(char byte, std::size_t count) {
  for (; count > 0; --count) {
    char* to = reserve(1);
    *to = byte;
    end_ = to + 1;
  }
}

void ByteSink::flush() {
  const auto count = static_cast<std::size_t>(end_ - buffer_.get());
  write_out(buffer_.get(), count);
  flushed_ += count;
  end_ = buffer_.get();
}

void ByteSink::write_large(const char* bytes, std::size_t count) {
  flush();
  write_out(bytes, count);
  flushed_ += count;
}

void ByteSink::write_out(const char* bytes, std::size_t count) {
  if (memory_ != nullptr) memory_->append(bytes, count);
  if (descriptor_ < 0 || error_ != 0) return;
  constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;  // write(2) takes at most 2^31 - 4096
  while (count > 0) {
    const ssize_t written = ::write(descriptor_, bytes, std::min(count, kMostAtOnce));
    if (written < 0) {
      if (errno == EINTR) continue;
      error_ = errno;
      return;
    }
    bytes += written;
    count -= static_cast<std::size_t>(written);
  }
}

}  // namespace scenegen::gltf
