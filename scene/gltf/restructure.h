// Smaller or plainer objects: a document in which what was one object is several nodes, so that each can have
// a time of its own.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf/read.h"
#include "scene/result.h"

namespace scenegen::gltf {

enum class Split : std::uint8_t {
  none,
  primitives,  ///< a part for every primitive of a mesh
  components,  ///< a part for every connected piece of a mesh, welded by equal position
};

struct Restructured {
  ReadResult read;                  ///< of the new document, with `source`
  std::uint64_t split_objects = 0;  ///< objects that became parts
  std::uint64_t expanded = 0;       ///< instances that became nodes
  std::vector<std::string> notes;   ///< what was left whole, and why
};

/// Whether restructure() would do anything.
[[nodiscard]] bool needs_restructuring(const ReadResult& read, Split split);

/// Nodes with EXT_mesh_gpu_instancing get a child per instance, named as the reader names its object. With a
/// split, an object's node gets a child "<name>/part_<k>" per part instead of its mesh; parts are numbered by
/// the first triangle of theirs, have vertices of their own (all attributes survive, whatever their kind),
/// and are shared by the objects that shared the mesh. Nodes keep their indices: new ones come last. Skinned
/// and morphed meshes, points and strips of lines stay whole. `read` has a source.
[[nodiscard]] Result<Restructured> restructure(ReadResult read, Split split);

}  // namespace scenegen::gltf
