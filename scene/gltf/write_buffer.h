// The binary part: buffer views, where every accessor's data lies, and the bytes themselves, streamed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/gltf/write_draco.h"
#include "scene/gltf/write_instances.h"
#include "scene/gltf/write_merge.h"
#include "scene/gltf/write_plan.h"
#include "scene/gltf/write_sink.h"
#include "scene/gltf/write_text.h"
#include "scene/gltf/write_tracks.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// One buffer view for each kind of data, in this order; Draco streams and images follow, one view each. An
/// empty one is left out.
enum class ViewKind : std::uint8_t {
  positions,
  normals,
  tangents,
  texcoords_0,
  texcoords_1,
  colors,
  vertex_ids,
  indices_16,
  indices_32,
  times,
  values,
  bytes,
  translations,
  rotations,
  scales,
  object_ids,
  names,
};
constexpr std::size_t kViewKinds = 17;

/// Accessors of a geometry; -1 where it has none (or where no mesh uses it).
struct GeometryAccessors {
  int position = -1, normal = -1, tangent = -1, color = -1, indices = -1;
  std::array<int, 2> texcoord{-1, -1};
};

struct BufferPlan {
  struct View {
    std::uint64_t offset = 0, bytes = 0;
    std::uint32_t index = 0;  ///< bufferViews[index]
  };
  std::array<View, kViewKinds> views;
  std::vector<View> draco;  ///< of each geometry, empty where it is plain; none at all without Draco
  std::vector<View> images;
  std::uint32_t view_count = 0;
  std::uint32_t buffer = 0;  ///< buffers[buffer], from its byte first_byte on
  std::uint64_t first_byte = 0;
  std::uint64_t bytes = 0;  ///< a multiple of 4

  const DracoStreams* streams = nullptr;
  std::vector<GeometryAccessors> geometries;
  std::uint32_t first_input = 0, first_byte_output = 0, first_scale_output = 0, first_value_output = 0,
                first_merged = 0, accessor_count = 0;
  std::vector<InstanceAccessors> instances;  ///< by NodePlan::sets
  const MergePlan* merge = nullptr;

  [[nodiscard]] const View& operator[](ViewKind kind) const { return views[static_cast<std::size_t>(kind)]; }
  [[nodiscard]] View& operator[](ViewKind kind) { return views[static_cast<std::size_t>(kind)]; }
  [[nodiscard]] std::uint32_t accessor_of(const AnimationSampler& sampler) const;
};

/// Which geometries some mesh uses (1) and which none (0); the others are not written.
[[nodiscard]] std::vector<std::uint8_t> used_geometries(const Scene& scene);
/// Bytes of a geometry's vertices and indices without compression.
[[nodiscard]] std::uint64_t plain_bytes(const Geometry& geometry);

/// Accessors of a merged primitive: one a stream, then the indices.
[[nodiscard]] std::uint32_t merged_accessors(const MergedPrimitive& primitive);

/// `draco` and `merge` must outlive the plan.
[[nodiscard]] BufferPlan plan_buffer(const Scene& scene, const NodePlan& nodes,
                                     const AnimationPlan& animation, const DracoStreams& draco,
                                     const MergePlan& merge);

/// The elements of /accessors and /bufferViews, without the brackets.
void emit_accessors(const Scene& scene, const NodePlan& nodes, const AnimationPlan& animation,
                    const BufferPlan& plan, TextOut& out);
void emit_buffer_views(const Scene& scene, const BufferPlan& plan, TextOut& out);

/// plan.bytes bytes.
void write_buffer(const Scene& scene, const NodePlan& nodes, const AnimationPlan& animation,
                  const BufferPlan& plan, ByteSink& sink);

}  // namespace scenegen::gltf
