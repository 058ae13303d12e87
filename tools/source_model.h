// The model that a verb gives times to: glTF, or what Assimp reads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/read.h"
#include "scene/gltf/restructure.h"
#include "scene/import/import.h"
#include "scene/result.h"
#include "tools/cli.h"

namespace scenegen::tools {

/// --up and --unit, in the present group.
void add_import_options(Options& options, import::ImportOptions& target);
/// They mean nothing for glTF.
void add_import_conflicts(const std::string& model, std::vector<Conflict>& conflicts);

/// A model with every object in a node of its own.
struct SourceModel {
  gltf::ReadResult read;                          ///< with `source`
  std::uint64_t split_objects = 0, expanded = 0;  ///< gltf::Restructured
  std::vector<std::string> notes;                 ///< what was not imported, what stayed whole
};
/// Errors beside those of reading: a model without objects, and one of layout merged, whose objects have no
/// nodes.
[[nodiscard]] Result<SourceModel> read_source_model(const std::string& path,
                                                    const import::ImportOptions& options,
                                                    gltf::Split split = gltf::Split::none);

}  // namespace scenegen::tools
