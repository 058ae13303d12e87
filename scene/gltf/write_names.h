// Names of nodes: unique in the file; and the table of object names of layout `instances`.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "scene/gltf/write_dedup.h"
#include "scene/gltf/write_sink.h"
#include "scene/name_table.h"

namespace scenegen::gltf {

/// Names for nodes that are not objects: as wished, or with ~2, ~3, … where that is taken. Object names come
/// first and are never changed.
class UniqueNames {
 public:
  void wish(std::string_view name);
  /// Settles all wishes against `objects` and each other.
  void settle(const NameTable& objects);
  [[nodiscard]] std::string_view operator[](std::size_t i) const { return names_[i]; }
  [[nodiscard]] std::size_t size() const { return names_.size(); }

 private:
  NameTable names_;
};

/// Front coding: LEB128 length of the prefix shared with the name before, LEB128 length of the rest, the
/// rest.
void write_front_coded(const NameTable& names, ByteSink& sink);
/// Seven bits a byte, the lowest first; the highest bit says that more follow.
void write_leb128(std::uint64_t value, ByteSink& sink);

}  // namespace scenegen::gltf
