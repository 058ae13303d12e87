// Unique names for objects, and the packed name table of our instances layout. Private to scene/gltf.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "scene/gltf/accessor.h"
#include "scene/name_table.h"

namespace scenegen::gltf::reading {

/// Fills a NameTable; a name that is taken gets "_2", "_3", …
class UniqueNames {
 public:
  UniqueNames(NameTable& names, std::size_t count);
  void add(std::string_view wanted) { add(wanted, hash_of(wanted)); }
  /// Keeps `name` for add_reserved(), whenever that comes. Call it before add().
  void reserve(std::string_view name) { reserved_.emplace(name); }
  void add_reserved(std::string_view name) {
    if (!insert(name, hash_of(name))) add(name);
  }
  [[nodiscard]] bool has_reserved() const { return !reserved_.empty(); }
  /// add(name_of(0)) ... add(name_of(count - 1)). Every insertion misses the cache; asking for the slots some
  /// names ahead makes a million of them three times as fast.
  template <class NameOf>
  void add_all(std::size_t count, const NameOf& name_of) {
    constexpr std::size_t kAhead = 16;
    std::array<std::uint64_t, kAhead> hashes{};
    const auto prepare = [&](std::size_t i) {
      hashes[i % kAhead] = hash_of(name_of(i));
      __builtin_prefetch(&slots_[hashes[i % kAhead] & (slots_.size() - 1)], 1);
    };
    for (std::size_t i = 0; i < std::min(kAhead, count); ++i) prepare(i);
    for (std::size_t i = 0; i < count; ++i) {
      add(name_of(i), hashes[i % kAhead]);
      if (i + kAhead < count) prepare(i + kAhead);
    }
  }

 private:
  [[nodiscard]] static std::uint64_t hash_of(std::string_view text);
  void add(std::string_view wanted, std::uint64_t hash);
  bool insert(std::string_view name, std::uint64_t hash);

  NameTable& names_;
  std::vector<std::uint64_t> slots_;  ///< open addressing: upper half of the hash, index + 1
  std::unordered_map<std::string, std::uint32_t> next_suffix_;
  std::unordered_set<std::string> reserved_;
};

/// Names of docs/FORMAT.md 4, in index order.
[[nodiscard]] NameTable decode_names(const NameList& list, Data& data, const Place& at);
/// Indices of objects of docs/FORMAT.md 2 (ids), in the order of the table.
[[nodiscard]] std::vector<std::uint32_t> decode_ids(const NameList& list, Data& data, const Place& at);

}  // namespace scenegen::gltf::reading
