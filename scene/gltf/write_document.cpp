#include "scene/gltf/write_document.h"

#include <algorithm>
#include <set>

#include "scene/gltf/write_info.h"

namespace scenegen::gltf {

namespace {

std::string_view name_of(Layout layout) {
  switch (layout) {
    case Layout::groups:
      return "groups";
    case Layout::instances:
      return "instances";
    case Layout::merged:
      return "merged";
    default:
      return "nodes";
  }
}

void emit_strings(const std::set<std::string>& strings, TextOut& out) {
  Commas commas(out);
  out.raw("[");
  for (const std::string& s : strings) commas.next().string(s);
  out.raw("]");
}

}  // namespace

Document::Document(const Scene& scene, const WriteOptions& options)
    : scene_(scene),
      nodes_(plan_nodes(scene, options)),
      strengths_(emissive_strengths(scene)),
      channels_(plan_channels(scene, nodes_, strengths_)),
      draco_(encode_draco(scene, options.draco)),
      merge_(plan_merge(scene, nodes_)),
      buffer_(plan_buffer(scene, nodes_, channels_.animation, draco_, merge_)),
      assets_(make_assets(scene, buffer_, strengths_)) {
  const auto any_sampler = [](const std::vector<std::uint32_t>& samplers) {
    return std::any_of(samplers.begin(), samplers.end(),
                       [](std::uint32_t s) { return s != ChannelPlan::kNone; });
  };
  const bool has_visibility =
      any_sampler(channels_.pointer_of_track) || any_sampler(channels_.pointer_of_group_node);
  if (has_visibility) assets_.extensions_used.insert("KHR_node_visibility");
  if (has_visibility || !scene.material_tracks.empty())
    assets_.extensions_used.insert("KHR_animation_pointer");
  if (nodes_.layout == Layout::instances && !nodes_.groups.empty()) {
    assets_.extensions_used.insert("EXT_mesh_gpu_instancing");
    assets_.extensions_required.insert("EXT_mesh_gpu_instancing");
  }
}

WriteReport Document::report() const {
  WriteReport report;
  report.nodes = nodes_.node_count;
  report.channels = channels_.channel_count;
  report.samplers = channels_.animation.samplers.size();
  report.accessors = buffer_.accessor_count;
  report.draws = draws();
  report.layout = nodes_.layout;
  if (nodes_.compact()) {
    report.instance_groups = nodes_.groups.size();
    report.instanced_objects = nodes_.grouped.size();
    report.single_object_groups = nodes_.single_object_groups;
  }
  report.notes = nodes_.notes;
  report_draco(report);
  return report;
}

/// Primitives of the meshes of all nodes.
std::uint64_t Document::draws() const {
  const auto of_mesh = [&](MeshId mesh) {
    return std::uint64_t{scene_.meshes[mesh.value].primitives.size()};
  };
  std::uint64_t count = merge_.primitives.size();
  for (const GroupNode& node : nodes_.group_nodes) {
    if (nodes_.layout == Layout::merged) break;
    const Group& group = nodes_.groups[node.group];
    if (nodes_.layout == Layout::instances) {
      count += of_mesh(node.look.valid() ? node.look : group.mesh);
    } else if (node.look.valid()) {  // its objects have a node for each look
      count += group.count * of_mesh(node.look);
    }
  }
  auto look = nodes_.looks.begin();  // by object, as the loop is
  for (std::uint32_t k = 0; k < nodes_.object_node_count(scene_); ++k) {
    const std::uint32_t i = nodes_.object_at(k);
    const bool has_looks = look != nodes_.looks.end() && look->object == i;
    if (!has_looks && nodes_.look_group(i) == nullptr) count += of_mesh(scene_.objects.mesh[i]);
    for (; look != nodes_.looks.end() && look->object == i; ++look) count += of_mesh(look->look);
  }
  return count;
}

void Document::report_draco(WriteReport& report) const {
  for (const DracoStream& stream : draco_.of_geometry) {
    report.draco_geometries += stream.used() ? 1 : 0;
    report.draco_bytes += stream.bytes.size();
  }
  report.draco_left = draco_.larger + draco_.unfit;
  if (draco_.larger > 0)
    report.notes.push_back("draco: " + std::to_string(draco_.larger) +
                           " of the geometries would be larger compressed; left as they are");
  if (draco_.unfit > 0)
    report.notes.push_back(
        "draco: " + std::to_string(draco_.unfit) +
        " of the geometries are no triangle lists that Draco gives back whole; left as they are");
  if (!draco_.of_geometry.empty() && merge_.any()) {
    report.draco_left += merge_.primitives.size();
    report.notes.emplace_back("draco: merged meshes are left as they are");
  }
}

void Document::emit_json(std::string_view buffer_uri, ByteSink& sink) const {
  TextOut out(sink);
  out.raw("{");
  emit_asset(out);
  emit_extensions(out);
  emit_scenes(out);
  emit_nodes(out);
  emit_cameras(out);
  emit_animation(out);
  emit_assets(out);
  if (buffer_.accessor_count > 0) {
    out.raw(R"(,"accessors":[)");
    emit_accessors(scene_, nodes_, channels_.animation, buffer_, out);
    out.raw("]");
  }
  if (buffer_.view_count > 0) {
    out.raw(R"(,"bufferViews":[)");
    emit_buffer_views(scene_, buffer_, out);
    out.raw(R"(],"buffers":[{"byteLength":)");
    out.number(buffer_.bytes);
    if (!buffer_uri.empty()) {
      out.raw(R"(,"uri":)");
      out.string(buffer_uri);
    }
    out.raw("}]");
  }
  out.raw("}");
}

void Document::emit_asset(TextOut& out) const {
  out.raw(R"("asset":{"version":"2.0","generator":"scenegen )" SCENEGEN_VERSION "\"");
  if (!scene_.info.copyright.empty()) {
    out.raw(R"(,"copyright":)");
    out.string(scene_.info.copyright);
  }
  out.raw(R"(,"extras":{"scenegen":)");
  emit_scenegen(scene_, {name_of(nodes_.layout), nodes_.visibility, {}}, out);
  out.raw("}}");
}

void Document::emit_extensions(TextOut& out) const {
  if (!assets_.extensions_used.empty()) {
    out.raw(R"(,"extensionsUsed":)");
    emit_strings(assets_.extensions_used, out);
  }
  if (!assets_.extensions_required.empty()) {
    out.raw(R"(,"extensionsRequired":)");
    emit_strings(assets_.extensions_required, out);
  }
}

void Document::emit_scenes(TextOut& out) const {
  out.raw(R"(,"scene":0,"scenes":[{"name":"scene")");
  Commas roots(out);
  const auto root = [&](std::uint32_t node) {
    if (roots.empty()) out.raw(R"(,"nodes":[)");
    roots.next().number(node);
  };
  if (nodes_.layout != Layout::nodes) {
    for (std::uint32_t g = 0; g < nodes_.group_nodes.size(); ++g) {
      if (!nodes_.groups[nodes_.group_nodes[g].group].frame.valid()) root(nodes_.first_group + g);
    }
  }
  const bool all = nodes_.layout == Layout::nodes;
  const std::size_t count = all ? scene_.objects.size() : nodes_.single.size();
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t i = all ? k : nodes_.single[k];
    if (!scene_.objects.frame[i].valid()) root(top_node_of(i));
  }
  for (std::uint32_t i = 0; i < scene_.frames.size(); ++i) {
    if (!scene_.frames[i].parent.valid()) root(nodes_.first_frame + i);
  }
  for (std::uint32_t i = 0; i < scene_.cameras.size(); ++i) {
    if (!scene_.cameras[i].frame.valid()) root(nodes_.first_camera + i);
  }
  if (!roots.empty()) out.raw("]");
  emit_scene_extras(out);
  out.raw("}]");
}

void Document::emit_scene_extras(TextOut& out) const {
  const bool has_names = buffer_[ViewKind::names].bytes > 0;
  if (!has_names && nodes_.timelines.empty() && !merge_.any()) return;
  out.raw(R"(,"extras":{"scenegen":{)");
  Commas members(out);
  if (has_names) {
    members.next().raw(R"("names":{"bufferView":)");
    out.number(buffer_[ViewKind::names].index);
    out.raw(R"(,"count":)");
    out.number(scene_.objects.size());
    out.raw(R"(,"encoding":"front-coded-utf8"})");
  }
  if (nodes_.id_table && buffer_[ViewKind::object_ids].bytes > 0) {
    members.next().raw(R"("ids":{"bufferView":)");
    out.number(buffer_[ViewKind::object_ids].index);
    out.raw(R"(,"count":)");
    out.number(nodes_.grouped.size());
    out.raw(R"(,"encoding":"delta-leb128"})");
  }
  if (!nodes_.timelines.empty()) emit_timelines(members, out);
  if (merge_.any()) {
    members.next().raw(R"("merged":{"meshes":)");
    out.number(scene_.meshes.size());
    out.raw("}");
  }
  out.raw("}}");
}

/// In JSON, not in a buffer view: other tools copy extras as they are, but leave views behind that nothing
/// they know refers to.
void Document::emit_timelines(Commas& members, TextOut& out) const {
  members.next().raw(R"("timelines":[)");
  Commas timelines(out);
  for (const TrackId track : nodes_.timelines) {
    const std::span<const float> times = scene_.times_s(track), values = scene_.values(track);
    timelines.next().raw(R"({"times":[)");
    Commas items(out);
    for (const float time_s : times) items.next().number(time_s);
    const bool is_mesh = scene_.tracks[track.value].property == Property::mesh;
    out.raw(is_mesh ? R"(],"looks":[)" : R"(],"shown":[)");
    const std::vector<MeshId> looks = is_mesh ? looks_of(scene_, track) : std::vector<MeshId>();
    Commas numbers(out);
    for (const float value : values) {
      if (!is_mesh) {
        numbers.next().number(value != 0.0F ? 1 : 0);
        continue;
      }
      const MeshId mesh(static_cast<std::uint64_t>(value));
      numbers.next().number(std::find(looks.begin(), looks.end(), mesh) - looks.begin());
    }
    out.raw("]}");
  }
  out.raw("]");
}

void Document::emit_cameras(TextOut& out) const {
  if (scene_.cameras.empty()) return;
  out.raw(R"(,"cameras":[)");
  Commas commas(out);
  for (const Camera& camera : scene_.cameras) {
    const auto member = [&](std::string_view key, float value) {
      out.raw(key);
      out.number(value);
    };
    commas.next().raw("{");
    if (!camera.name.empty()) {
      out.raw(R"("name":)");
      out.string(camera.name);
      out.raw(",");
    }
    if (camera.orthographic) {
      member(R"("type":"orthographic","orthographic":{"xmag":)", camera.xmag_m);
      member(R"(,"ymag":)", camera.ymag_m);
      member(R"(,"zfar":)", camera.zfar_m);
    } else {
      member(R"("type":"perspective","perspective":{"yfov":)", camera.yfov_rad);
      if (camera.zfar_m > 0.0F) member(R"(,"zfar":)", camera.zfar_m);
    }
    member(R"(,"znear":)", camera.znear_m);
    out.raw("}}");
  }
  out.raw("]");
}

void Document::emit_assets(TextOut& out) const {
  const auto member = [&](std::string_view key, const nlohmann::json& tree) {
    if (tree.empty()) return;
    out.raw(key);
    out.tree(tree);
  };
  if (!merge_.any()) member(R"(,"meshes":)", assets_.meshes);
  if (merge_.any()) emit_merged_meshes(out);
  member(R"(,"materials":)", assets_.materials);
  member(R"(,"textures":)", assets_.textures);
  member(R"(,"samplers":)", assets_.samplers);
  member(R"(,"images":)", assets_.images);
}

/// The scene's own meshes, which no node uses, and behind them the merged ones.
void Document::emit_merged_meshes(TextOut& out) const {
  constexpr std::string_view kAttributes[] = {"POSITION",   "NORMAL",  "TANGENT",   "TEXCOORD_0",
                                              "TEXCOORD_1", "COLOR_0", "_OBJECT_ID"};
  if (assets_.meshes.empty() && merge_.primitives.empty()) return;
  out.raw(R"(,"meshes":[)");
  Commas meshes(out);
  for (const nlohmann::json& mesh : assets_.meshes) meshes.next().tree(mesh);
  std::uint32_t accessor = buffer_.first_merged;
  for (std::size_t n = 0; n < nodes_.group_nodes.size() && !out.sink().failed(); ++n) {
    if (!merge_.mesh_of_node[n].valid()) continue;
    meshes.next().raw(R"({"name":)");
    out.string(nodes_.names[n]);
    out.raw(R"(,"primitives":[)");
    Commas primitives(out);
    for (std::uint32_t p = merge_.first_primitive[n]; p < merge_.first_primitive[n + 1]; ++p) {
      const MergedPrimitive& primitive = merge_.primitives[p];
      primitives.next().raw(R"({"attributes":{)");
      Commas attributes(out);
      for (std::size_t s = 0; s < std::size(kAttributes); ++s) {
        if (!primitive.has(static_cast<VertexStream>(s))) continue;
        attributes.next().string(kAttributes[s]);
        out.raw(":");
        out.number(accessor++);
      }
      out.raw("}");
      const auto member = [&](std::string_view key, std::uint32_t value) {
        out.raw(key);
        out.number(value);
      };
      if (primitive.indexed) member(R"(,"indices":)", accessor++);
      if (primitive.material.valid()) member(R"(,"material":)", primitive.material.value);
      if (primitive.topology != Topology::triangles)
        member(R"(,"mode":)", static_cast<std::uint32_t>(primitive.topology));
      out.raw("}");
    }
    out.raw("]}");
  }
  out.raw("]");
}

}  // namespace scenegen::gltf
