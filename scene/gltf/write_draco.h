// Geometry as Draco streams, for KHR_draco_mesh_compression. Debian's tinygltf has no Draco inside, so its
// library is called directly.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/gltf/write.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// One compressed geometry. What stands in its accessors is counted in the decoded stream: the encoder drops
/// triangles without area and vertices that no triangle uses, splits and joins others, and rounds.
struct DracoStream {
  std::vector<char> bytes;  ///< empty: not compressed
  std::uint64_t vertices = 0, indices = 0;
  Box box;
  /// Ids of the attributes in the stream; -1 where there is none.
  int position = -1, normal = -1, tangent = -1, color = -1;
  std::array<int, 2> texcoord{-1, -1};

  [[nodiscard]] bool used() const { return !bytes.empty(); }
};

struct DracoStreams {
  std::vector<DracoStream> of_geometry;  ///< in Scene::geometries order; empty without options.on
  std::uint64_t larger = 0;              ///< geometries left as they are because Draco would need more bytes
  std::uint64_t unfit = 0;  ///< … because they are no triangle lists, or do not come back whole

  [[nodiscard]] bool any() const;
  [[nodiscard]] const DracoStream* find(std::size_t geometry) const {
    return geometry < of_geometry.size() && of_geometry[geometry].used() ? &of_geometry[geometry] : nullptr;
  }
};

/// Each geometry that some mesh uses is encoded once, however many meshes and objects share it. Same input,
/// same bytes.
[[nodiscard]] DracoStreams encode_draco(const Scene& scene, const DracoOptions& options);

}  // namespace scenegen::gltf
