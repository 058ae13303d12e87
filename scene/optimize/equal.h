// Finding equal things: by hash first, then by comparing. Private to scene/optimize.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>
#include <unordered_map>
#include <vector>

namespace scenegen::optimizing {

/// 64 bits of content; the multiply-and-fold step of wyhash (Wang Yi 2019). Only ever compared within a run.
class ContentHash {
 public:
  void add_bytes(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    for (; size >= 8; size -= 8, bytes += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes, 8);
      mix(word);
    }
    std::uint64_t rest = size;
    for (std::size_t i = 0; i < size; ++i) rest = rest << 8 | bytes[i];
    mix(rest);
  }
  template <class T>
  void add(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    mix(values.size());
    if (!values.empty()) add_bytes(values.data(), values.size() * sizeof(T));
  }
  void mix(std::uint64_t word) {
    __extension__ using Wide = unsigned __int128;
    const Wide product = static_cast<Wide>(state_ ^ word) * 0xA0761D6478BD642FULL;
    state_ = static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64) ^
             0x9E3779B97F4A7C15ULL;
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xE7037ED1A0B428DBULL;
};

/// For each of `count` things the first that is equal to it (itself if none before is).
template <class Hash, class Equal>
std::vector<std::uint32_t> first_equals(std::size_t count, const Hash& hash_of, const Equal& equal) {
  std::vector<std::uint32_t> out(count);
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> known;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::vector<std::uint32_t>& candidates = known[hash_of(i)];
    out[i] = i;
    for (const std::uint32_t candidate : candidates) {
      if (!equal(candidate, i)) continue;
      out[i] = candidate;
      break;
    }
    if (out[i] == i) candidates.push_back(i);
  }
  return out;
}

}  // namespace scenegen::optimizing
