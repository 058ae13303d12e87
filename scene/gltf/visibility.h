// Visibility tracks while a document is read: each distinct one once, whatever the number of nodes that name
// it. Private to scene/gltf.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "scene/gltf/fault.h"
#include "scene/scene.h"

namespace scenegen::gltf::reading {

class VisibilityTable {
 public:
  static constexpr std::uint32_t kAlways = 0;

  /// `most_keys`: keys that nested tracks may unfold to (a parent's million keys times a million children).
  explicit VisibilityTable(std::uint64_t most_keys);
  /// Id of the track with these keys; kAlways when every value is 1.
  std::uint32_t intern(std::span<const float> times_s, std::span<const std::uint8_t> shown);
  std::uint32_t never();
  /// Visible where both are.
  std::uint32_t both(std::uint32_t a, std::uint32_t b, const Place& at);

  [[nodiscard]] std::span<const float> times_s(std::uint32_t id) const;
  [[nodiscard]] std::span<const std::uint8_t> shown(std::uint32_t id) const;
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(entries_.size()); }

 private:
  struct Entry {
    std::uint64_t first = 0;
    std::uint64_t count = 0;
    std::uint32_t next = kAlways;  ///< with the same hash
  };
  std::vector<Entry> entries_;
  std::vector<float> times_s_;
  std::vector<std::uint8_t> shown_;
  std::unordered_map<std::uint64_t, std::uint32_t> by_hash_;
  std::unordered_map<std::uint64_t, std::uint32_t> by_pair_;
  std::uint64_t keys_left_;
};

}  // namespace scenegen::gltf::reading
