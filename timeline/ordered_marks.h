// A set of small integers that is filled in any order, read in ascending order and left empty, in time
// proportional to what is in it.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/held_bytes.h"

namespace scenegen::timeline {

/// Bitmap of `count` bits under two levels of summary bits: one bit a member plus 1/64. Draining scans
/// count / 2^18 words at the top (4 for a million, 382 for the 100 million of limits.h).
class OrderedMarks {
 public:
  explicit OrderedMarks(std::size_t count = 0)
      : words_((count + 63) / 64), groups_((words_.size() + 63) / 64), top_((groups_.size() + 63) / 64) {}

  void set(std::uint32_t i) {
    std::uint64_t& word = words_[i >> 6];
    if (word == 0) summarise(i);
    word |= 1ULL << (i & 63);
  }

  /// In the set if it was not, out of it if it was.
  void flip(std::uint32_t i) {
    std::uint64_t& word = words_[i >> 6];
    if (word == 0) summarise(i);
    word ^= 1ULL << (i & 63);
  }

  /// visit(index), ascending; it may set() greater indices, which are then visited too.
  template <class Visit>
  void drain(const Visit& visit) {
    drain_word_indices([&](std::size_t w) {
      while (words_[w] != 0) {
        const auto bit = static_cast<unsigned>(std::countr_zero(words_[w]));
        words_[w] &= words_[w] - 1;
        visit(static_cast<std::uint32_t>(w * 64 + bit));
      }
    });
  }

  /// visit(word index, bits), ascending; bits are never 0.
  template <class Visit>
  void drain_words(const Visit& visit) {
    drain_word_indices([&](std::size_t w) {
      const std::uint64_t bits = words_[w];
      words_[w] = 0;
      if (bits != 0) visit(w, bits);
    });
  }

  [[nodiscard]] std::uint64_t memory_bytes() const { return held_bytes(words_, groups_, top_); }

 private:
  void summarise(std::uint32_t i) {
    groups_[i >> 12] |= 1ULL << ((i >> 6) & 63);
    top_[i >> 18] |= 1ULL << ((i >> 12) & 63);
  }

  template <class Visit>
  void drain_word_indices(const Visit& visit) {
    for (std::size_t t = 0; t < top_.size(); ++t) {
      for (; top_[t] != 0; top_[t] &= top_[t] - 1) {
        const std::size_t g = t * 64 + static_cast<unsigned>(std::countr_zero(top_[t]));
        for (; groups_[g] != 0; groups_[g] &= groups_[g] - 1) {
          visit(g * 64 + static_cast<unsigned>(std::countr_zero(groups_[g])));
        }
      }
    }
  }

  std::vector<std::uint64_t> words_, groups_, top_;
};

}  // namespace scenegen::timeline
