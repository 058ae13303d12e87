// Unique names for objects, and the packed name table of our instances layout. Private to scene/gltf.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "scene/gltf/accessor.h"
#include "scene/name_table.h"

namespace scenegen::gltf::reading {

/// Fills a NameTable; a name that is taken gets "_2", "_3", …
class UniqueNames {
 public:
  UniqueNames(NameTable& names, std::size_t count);
  void add(std::string_view wanted);

 private:
  bool insert(std::string_view name);

  NameTable& names_;
  std::vector<std::uint64_t> slots_;  ///< open addressing: upper half of the hash, index + 1
  std::unordered_map<std::string, std::uint32_t> next_suffix_;
};

/// Names of docs/FORMAT.md 4, in index order.
[[nodiscard]] NameTable decode_names(const NameList& list, Data& data, const Place& at);

}  // namespace scenegen::gltf::reading
