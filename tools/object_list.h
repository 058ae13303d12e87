// What rules and plans can call the objects of a model: names, nodes above them, materials, extras.
#pragma once

#include <string>

#include "scene/gltf/read.h"
#include "scene/result.h"
#include "tools/output.h"

namespace scenegen::tools {

/// Table: the tree of nodes, one a line, with what is below it or what it is made of, and its extras. JSON
/// (scenegen/objects) and CSV: an object a row, with the extras that hold for it (its nearest node's that has
/// the member). `read` has a source. Errors: as ObjectFacts::make().
[[nodiscard]] Result<std::string> object_list(const std::string& file, const gltf::ReadResult& read,
                                              Format format);

}  // namespace scenegen::tools
