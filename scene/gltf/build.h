// Document -> Scene, in steps. Private to scene/gltf.
#pragma once

#include <map>
#include <unordered_map>
#include <vector>

#include "scene/gltf/accessor.h"
#include "scene/gltf/visibility.h"

namespace scenegen::gltf::reading {

/// Layout merged: checks what the file says of the objects that its meshes were merged from. If it holds, the
/// merged meshes are forgotten and their nodes stand for those objects; else (other tools keep extras but
/// renumber what they point at) it is the plain glTF that others see, and that is noted.
void settle_merged(Document& document, Data& data);

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
  std::vector<SourceDocument::ScaleVisibility> scale_visibility;
};
/// Also replaces the own scale of nodes whose scale track is a visibility track, by the one shown.
[[nodiscard]] Motions build_motions(Document& document, Data& data, VisibilityTable& visibility,
                                    Scene& scene);

/// What objects with looks show, and when (docs/FORMAT.md 5).
class LookTable {
 public:
  LookTable(const Document& document, Data& data, VisibilityTable& visibility, Scene& scene);

  /// One look of an object: the visibility of its node, and what it shows.
  struct Look {
    std::uint32_t visible = VisibilityTable::kAlways;
    std::uint32_t mesh = kNone;
    friend bool operator==(const Look&, const Look&) = default;
  };
  struct Resolved {
    std::uint32_t visible = VisibilityTable::kAlways;
    TrackId meshes;
  };
  /// Looks of which exactly one is shown at any time: the object's visibility is elsewhere. No track without
  /// looks.
  [[nodiscard]] TrackId always_one(const std::vector<Look>& looks, const Place& at);
  /// Looks of which at most one is shown at any time. `visibility` and `meshes` are timelines of the scene
  /// (or kNone); where they say the same as the animation they are what the writer had.
  [[nodiscard]] Resolved at_most_one(const std::vector<Look>& looks, std::uint32_t visibility,
                                     std::uint32_t meshes, const Place& at);
  /// Groups whose timelines are missing or say something else than the animation does.
  [[nodiscard]] std::uint64_t disagreements() const { return disagreements_; }

 private:
  /// Which look is shown from when on; kNone: none.
  struct State {
    float time_s;
    std::uint32_t look;
  };
  /// Keys of a mesh track, in numbers of looks.
  struct Course {
    std::uint32_t visible = VisibilityTable::kAlways;
    std::vector<float> times_s;
    std::vector<std::uint32_t> looks;
    std::map<std::vector<std::uint32_t>, TrackId> tracks;  ///< by the meshes of the looks
  };
  [[nodiscard]] std::vector<State> states_of(const std::vector<Look>& looks, const Place& at);
  [[nodiscard]] Course from_states(const std::vector<State>& states);
  [[nodiscard]] bool from_timelines(const std::vector<State>& states, std::uint32_t visibility,
                                    std::uint32_t meshes, std::size_t look_count, Course& out);
  [[nodiscard]] const Timeline* timeline(std::uint32_t index, bool is_looks) const;
  [[nodiscard]] TrackId track_of(Course& course, const std::vector<Look>& looks, const Place& at);

  const Document& document_;
  Data& data_;
  VisibilityTable& visibility_;
  Scene& scene_;
  std::map<std::vector<std::uint32_t>, Course> courses_;
  std::map<std::vector<float>, TrackId> tracks_;  ///< by times and values
  std::uint64_t disagreements_ = 0;
};

/// Where each object comes from, for SourceDocument.
struct Origins {
  std::vector<std::uint32_t> node, instance;  ///< by object
  std::vector<std::uint32_t> node_of_frame;
  bool merged = false;  ///< SourceDocument::merged
};
/// Frames, objects, cameras, their tracks.
[[nodiscard]] Origins build_objects(Document& document, Data& data, const Hierarchy& hierarchy,
                                    const Motions& motions, VisibilityTable& visibility, Scene& scene);

}  // namespace scenegen::gltf::reading
