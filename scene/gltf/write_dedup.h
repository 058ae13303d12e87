// Numbers distinct things in the order in which they come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace scenegen::gltf {

/// Hash of bytes, eight at a time (mix as in SplitMix64); equal bytes, equal hash, on every machine of one
/// endianness.
[[nodiscard]] std::uint64_t fast_hash(const void* bytes, std::size_t count, std::uint64_t seed = 0);
[[nodiscard]] inline std::uint64_t fast_hash(std::string_view text) {
  return fast_hash(text.data(), text.size());
}

/// Open-addressing index over things kept elsewhere; 12 to 24 bytes a thing.
class Dedup {
 public:
  static constexpr std::uint32_t kMissing = 0xFFFFFFFF;

  /// Index of the thing with this hash for which equal(index) holds, or kMissing.
  template <class Equal>
  [[nodiscard]] std::uint32_t find(std::uint64_t hash, const Equal& equal) const {
    if (slots_.empty()) return kMissing;
    for (std::size_t at = hash & mask();; at = (at + 1) & mask()) {
      const std::uint32_t index = slots_[at];
      if (index == kMissing || (hashes_[index] == hash && equal(index))) return index;
    }
  }
  /// The same, giving the thing the next index when it is new; `is_new` says so.
  template <class Equal>
  std::uint32_t add(std::uint64_t hash, const Equal& equal, bool& is_new) {
    const std::uint32_t found = find(hash, equal);
    is_new = found == kMissing;
    return is_new ? insert(hash) : found;
  }
  [[nodiscard]] std::size_t size() const { return hashes_.size(); }

 private:
  [[nodiscard]] std::size_t mask() const { return slots_.size() - 1; }
  std::uint32_t insert(std::uint64_t hash);
  void place(std::uint32_t index);

  std::vector<std::uint64_t> hashes_;
  std::vector<std::uint32_t> slots_;  // at most half full, power of two
};

}  // namespace scenegen::gltf
