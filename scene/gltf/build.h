// Document -> Scene, in steps. Private to scene/gltf.
#pragma once

#include <unordered_map>
#include <vector>

#include "scene/gltf/accessor.h"
#include "scene/gltf/visibility.h"

namespace scenegen::gltf::reading {

/// Geometries, meshes (MeshId = index in the file; one more for nodes that draw nothing is never made).
void build_meshes(Document& document, Data& data, Scene& scene);
/// KHR_draco_mesh_compression: the streams of `primitive` that the compressed data hold.
void decode_draco(const PrimitiveRecord& primitive, Data& data, const Place& at, Geometry& out);

/// Images as raw bytes, textures, materials.
void build_materials(Document& document, Data& data, const std::string& folder, Scene& scene);

/// The nodes of the scene that is drawn.
struct Hierarchy {
  std::vector<std::uint32_t> parent;  ///< by node; kNone for a root
  std::vector<std::uint32_t> order;   ///< nodes of the scene, parents before children
};
/// Faults on cycles, two parents, depth beyond limits::kMaxNodeDepth.
[[nodiscard]] Hierarchy build_hierarchy(Document& document);

/// What animation 0 does to nodes. Materials' tracks are already in the scene.
struct NodeMotion {
  static constexpr std::uint32_t kConstant = kNone - 1;  ///< a channel that only sets a constant
  std::uint32_t translation = kNone, rotation = kNone, scale = kNone;  ///< tracks of the scene
  std::uint32_t scale_visibility = VisibilityTable::kAlways, pointer_visibility = kNone;
  [[nodiscard]] bool moves() const {
    return translation < kConstant || rotation < kConstant || scale < kConstant;
  }
};
struct Motions {
  std::vector<std::uint32_t> of_node;  ///< into `motions`; empty when nothing is animated
  std::vector<NodeMotion> motions;
};
/// Also replaces the own scale of nodes whose scale track is a visibility track, by the one shown.
[[nodiscard]] Motions build_motions(Document& document, Data& data, VisibilityTable& visibility,
                                    Scene& scene);

/// Where each object comes from, for SourceDocument.
struct Origins {
  std::vector<std::uint32_t> node, instance;
};
/// Frames, objects, cameras, their tracks.
[[nodiscard]] Origins build_objects(Document& document, Data& data, const Hierarchy& hierarchy,
                                    const Motions& motions, VisibilityTable& visibility, Scene& scene);

}  // namespace scenegen::gltf::reading
