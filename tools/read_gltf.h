// Reading glTF where nothing else can be read.
#pragma once

#include <string>

#include "scene/gltf/read.h"
#include "scene/result.h"

namespace scenegen::tools {

/// gltf::read(); when the file is a model of another format, the error names the verbs that read it.
[[nodiscard]] Result<gltf::ReadResult> read_gltf(const std::string& path,
                                                 const gltf::ReadOptions& options = {});

}  // namespace scenegen::tools
