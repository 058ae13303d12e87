// First in, first out, in room that is kept: std::deque gives its nodes back and asks for new ones as it
// moves along.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "scene/held_bytes.h"

namespace scenegen::render {

/// `T` is made without arguments and moved without throwing. Allocates only when it holds more than ever
/// before.
template <class T>
class RingQueue {
 public:
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] T& front() {
    assert(count_ > 0);
    return items_[first_];
  }
  /// Room for one more: after this, push_back() does not throw.
  void reserve_one() {
    if (count_ < items_.size()) return;
    std::vector<T> larger(items_.empty() ? 16 : 2 * items_.size());
    for (std::size_t i = 0; i < count_; ++i) larger[i] = std::move(items_[(first_ + i) % items_.size()]);
    items_ = std::move(larger);
    first_ = 0;
  }
  void push_back(T item) {
    reserve_one();
    items_[(first_ + count_++) % items_.size()] = std::move(item);
  }
  void pop_front() {
    assert(count_ > 0);
    items_[first_] = T{};
    first_ = (first_ + 1) % items_.size();
    --count_;
  }
  [[nodiscard]] std::uint64_t memory_bytes() const { return held_bytes(items_); }

 private:
  std::vector<T> items_;
  std::size_t first_ = 0, count_ = 0;
};

}  // namespace scenegen::render
