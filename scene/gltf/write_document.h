// The whole document: plan, then JSON text and binary part as often as they are asked for.
#pragma once

#include <string>
#include <vector>

#include "scene/gltf/write.h"
#include "scene/gltf/write_assets.h"
#include "scene/gltf/write_buffer.h"
#include "scene/gltf/write_content.h"
#include "scene/gltf/write_plan.h"
#include "scene/gltf/write_text.h"
#include "scene/scene.h"

namespace scenegen::gltf {

/// The sampler of every channel; kNone where there is no channel.
struct ChannelPlan {
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;
  AnimationPlan animation;
  std::vector<std::uint32_t> pointer_of_track;     ///< of visibility tracks of objects with nodes
  std::vector<std::uint32_t> unit_scale_of_track;  ///< (0,0,0) and (1,1,1): inserted parents
  std::vector<std::uint32_t> scale_of_group_node, pointer_of_group_node;  ///< scale: (0,0,0) and (1,1,1)
  std::vector<std::uint32_t> scale_of_object;  ///< by object node (NodePlan::object_at)
  std::vector<std::uint32_t> of_look, of_frame_track, of_material_track;
  std::uint64_t channel_count = 0;
};

/// Everything about a scene's file but its bytes. Keeps a reference to the scene.
class Document : public FileContent {
 public:
  Document(const Scene& scene, const WriteOptions& options);
  Document(const Document&) = delete;  // buffer_ points at draco_ and merge_
  Document& operator=(const Document&) = delete;

  /// Before the first emit_json(): what has to be computed from all vertices.
  [[nodiscard]] Result<void> measure() { return merge_.measure(scene_); }
  void emit_json(std::string_view buffer_uri, ByteSink& sink) const override;
  [[nodiscard]] std::uint64_t buffer_bytes() const override { return buffer_.bytes; }
  void emit_buffer(ByteSink& sink) const override {
    write_buffer(scene_, nodes_, channels_.animation, buffer_, sink);
  }
  [[nodiscard]] WriteReport report() const override;

 private:
  void emit_merged_meshes(TextOut& out) const;
  void report_draco(WriteReport& report) const;
  [[nodiscard]] std::uint64_t draws() const;
  void emit_asset(TextOut& out) const;
  void emit_extensions(TextOut& out) const;
  void emit_scenes(TextOut& out) const;
  void emit_scene_extras(TextOut& out) const;
  void emit_timelines(Commas& members, TextOut& out) const;
  void emit_nodes(TextOut& out) const;
  void emit_object_nodes(Commas& commas, TextOut& out) const;
  void emit_group_nodes(Commas& commas, TextOut& out) const;
  void emit_attributes(std::uint32_t set, TextOut& out) const;
  void emit_merged_node(std::size_t n, TextOut& out) const;
  void emit_look_members(const Group& group, std::uint32_t number, MeshId mesh, TextOut& out) const;
  void emit_look_of_object(const Group& group, std::uint32_t number, std::uint32_t object,
                           TextOut& out) const;
  void emit_frame_nodes(Commas& commas, TextOut& out) const;
  void emit_inserted_nodes(Commas& commas, TextOut& out) const;
  void emit_animation(TextOut& out) const;
  void emit_channels(TextOut& out) const;
  void emit_cameras(TextOut& out) const;
  void emit_assets(TextOut& out) const;
  /// Node at the top of an object: its own, or the inserted parent.
  [[nodiscard]] std::uint32_t top_node_of(std::uint32_t object) const;

  const Scene& scene_;
  NodePlan nodes_;
  std::vector<float> strengths_;
  ChannelPlan channels_;
  DracoStreams draco_;
  MergePlan merge_;
  BufferPlan buffer_;
  AssetTrees assets_;
};

[[nodiscard]] ChannelPlan plan_channels(const Scene& scene, const NodePlan& nodes,
                                        const std::vector<float>& strengths);

}  // namespace scenegen::gltf
