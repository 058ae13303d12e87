// Names of many things in one block of memory: 4 or 8 bytes a name beside its characters.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scenegen {

/// Append-only list of UTF-8 strings.
class NameTable {
 public:
  void reserve(std::size_t names, std::size_t bytes) {
    ends_.reserve(names);
    bytes_.reserve(bytes);
  }
  void push_back(std::string_view name) {
    bytes_.append(name);
    ends_.push_back(bytes_.size());
  }
  [[nodiscard]] std::size_t size() const { return ends_.size(); }
  [[nodiscard]] bool empty() const { return ends_.empty(); }
  [[nodiscard]] std::size_t byte_count() const { return bytes_.size(); }
  [[nodiscard]] std::string_view operator[](std::size_t i) const {
    const std::uint64_t begin = i == 0 ? 0 : ends_[i - 1];
    return std::string_view(bytes_).substr(begin, ends_[i] - begin);
  }
  friend bool operator==(const NameTable&, const NameTable&) = default;

 private:
  std::string bytes_;
  std::vector<std::uint64_t> ends_;
};

}  // namespace scenegen
