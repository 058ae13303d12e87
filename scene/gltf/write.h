// Scene -> glTF 2.0 (.glb, or .gltf + .bin). docs/FORMAT.md says what is put where.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/result.h"
#include "scene/scene.h"

namespace scenegen::gltf {

class OutputFile;

enum class Layout : std::uint8_t {
  automatic,  ///< instances from kInstancesFrom objects on, else nodes
  nodes,      ///< a node and a channel per object
  groups,     ///< a node per object under one animated parent per (frame, visibility track, mesh track)
  instances,  ///< per (frame, visibility track, mesh track, mesh) one EXT_mesh_gpu_instancing node a look
  merged,     ///< per (frame, visibility track, mesh track) the geometry of all objects as one mesh a look
};
enum class VisibilityEncoding : std::uint8_t { scale, pointer, both };

/// "Some thousand": below it every layout loads at once and `nodes` is what most tools like best (INTEROP 3).
constexpr std::uint64_t kInstancesFrom = 2000;

/// KHR_draco_mesh_compression. The defaults are those of draco_encoder. Bits: 0 keeps float32 as it is, else
/// 2 to 30, of the largest extent of the attribute in the mesh (normals: of the octahedron).
struct DracoOptions {
  bool on = false;
  std::uint32_t level = 7;  ///< 0 (fast) to 10 (small)
  std::uint32_t position_bits = 11, normal_bits = 8, texcoord_bits = 10, color_bits = 8;
  std::uint32_t generic_bits = 8;  ///< tangents
};

struct WriteOptions {
  Layout layout = Layout::automatic;
  VisibilityEncoding visibility = VisibilityEncoding::scale;
  unsigned threads = 1;  ///< a hint; one thread writes 1 M objects in 0.4 s, so it is not used yet
  DracoOptions draco;
  /// Layout instances without looks: indices of objects in one table instead of an attribute `_OBJECT_ID` a
  /// node. Some 80 bytes a node and 2 an object less; tools that rewrite buffers lose the table (and the
  /// names with it).
  bool id_table = false;
  /// When given, complete files go here instead of to their places: who puts several there together, or none
  /// of them, does so with commit_all().
  std::vector<OutputFile>* later = nullptr;

  WriteOptions() = default;
  WriteOptions(Layout l, VisibilityEncoding v, unsigned t = 1) : layout(l), visibility(v), threads(t) {}
};

struct WriteReport {
  std::uint64_t bytes = 0;  ///< all files together
  std::uint64_t json_bytes = 0;
  std::uint64_t nodes = 0, channels = 0, samplers = 0, accessors = 0;
  std::uint64_t draws = 0;                 ///< primitives of the meshes of all nodes
  Layout layout = Layout::nodes;           ///< the one used
  std::uint64_t instance_groups = 0;       ///< layouts instances, merged: objects that share a node a look
  std::uint64_t instanced_objects = 0;     ///< in them; divided by them: objects per group
  std::uint64_t single_object_groups = 0;  ///< beside them: objects alone, with nodes of their own
  std::uint64_t draco_geometries = 0, draco_bytes = 0;  ///< compressed, and into how many bytes
  std::uint64_t draco_left = 0;                         ///< not compressed (a note says why)
  std::vector<std::string> notes;  ///< "instances: 61 % of groups hold one object; wrote groups instead"
};

/// Writes `path` (".glb" or ".gltf", the latter with its .bin beside it; "-" is a .glb on stdout). Files are
/// written beside their place and renamed when complete: an error leaves what was there before. Streaming:
/// memory beyond the scene does not grow with the text of nodes and animations.
[[nodiscard]] Result<WriteReport> write(const Scene& scene, const std::string& path,
                                        const WriteOptions& options);

/// The size `write` would produce, without writing (for --dry-run).
[[nodiscard]] Result<WriteReport> predict(const Scene& scene, const std::string& path,
                                          const WriteOptions& options);

}  // namespace scenegen::gltf
