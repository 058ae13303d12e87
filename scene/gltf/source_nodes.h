// What a document says of its nodes beyond the scene: which hangs on which, names, extras. Private to scene/.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scene/gltf/read.h"
#include "scene/name_table.h"
#include "scene/result.h"

namespace scenegen::gltf {

struct SourceNodes {
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  /// A member of extras, by way of its parent: /extras/ifc/guid is {path of ifc, "guid"}.
  struct ExtraPath {
    std::uint32_t parent;  ///< kNone: a member of extras itself
    std::string key;
  };
  struct Extra {
    std::uint32_t node, path;
    std::uint32_t text;  ///< into extra_texts: a string, or a number, true, false as in the file
  };

  std::vector<std::uint32_t> parent;  ///< kNone for a root
  NameTable names;                    ///< as in the file; empty for a nameless node
  std::vector<ExtraPath> paths;       ///< distinct; a parent stands before its members
  std::vector<Extra> extras;          ///< by node, then path
  NameTable extra_texts;
};

/// Objects in extras are followed eight deep; arrays, null and our own `scenegen` are left out.
[[nodiscard]] Result<SourceNodes> read_source_nodes(const SourceDocument& source);

}  // namespace scenegen::gltf
