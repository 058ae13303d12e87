#include "scene/gltf/write_document.h"

#include <algorithm>
#include <set>

namespace scenegen::gltf {

namespace {

std::string_view name_of(Layout layout) {
  switch (layout) {
    case Layout::groups:
      return "groups";
    case Layout::instances:
      return "instances";
    default:
      return "nodes";
  }
}

std::string_view name_of(VisibilityEncoding encoding) {
  switch (encoding) {
    case VisibilityEncoding::scale:
      return "scale";
    case VisibilityEncoding::pointer:
      return "pointer";
    case VisibilityEncoding::both:
      return "both";
  }
  return "scale";
}

/// ,"translation":[…],"rotation":[…],"scale":[…] without what is neutral.
void emit_transform(const Transform& transform, TextOut& out) {
  if (transform.translation_m != glm::vec3(0.0F)) {
    out.raw(R"(,"translation":)");
    out.numbers(transform.translation_m);
  }
  if (transform.rotation != glm::quat(1.0F, 0.0F, 0.0F, 0.0F)) {
    out.raw(R"(,"rotation":)");
    out.numbers(transform.rotation);
  }
  if (transform.scale != glm::vec3(1.0F)) {
    out.raw(R"(,"scale":)");
    out.numbers(transform.scale);
  }
}

void emit_name(std::string_view name, TextOut& out) {
  out.raw(R"({"name":)");
  out.string(name);
}

void emit_strings(const std::set<std::string>& strings, TextOut& out) {
  Commas commas(out);
  out.raw("[");
  for (const std::string& s : strings) commas.next().string(s);
  out.raw("]");
}

constexpr std::string_view kNodeVisibility = R"("extensions":{"KHR_node_visibility":{}})";

}  // namespace

Document::Document(const Scene& scene, const WriteOptions& options)
    : scene_(scene),
      nodes_(plan_nodes(scene, options)),
      strengths_(emissive_strengths(scene)),
      channels_(plan_channels(scene, nodes_, strengths_)),
      draco_(encode_draco(scene, options.draco)),
      buffer_(plan_buffer(scene, nodes_, channels_.animation, draco_)),
      assets_(make_assets(scene, buffer_, strengths_)) {
  const bool has_visibility =
      std::any_of(channels_.pointer_of_track.begin(), channels_.pointer_of_track.end(),
                  [](std::uint32_t s) { return s != ChannelPlan::kNone; });
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
  report.layout = nodes_.layout;
  if (nodes_.layout == Layout::instances) {
    report.instance_groups = nodes_.groups.size();
    report.instanced_objects = nodes_.grouped.size();
    report.single_object_groups = nodes_.single_object_groups;
  }
  report.notes = nodes_.notes;
  report_draco(report);
  return report;
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
  const SceneInfo& info = scene_.info;
  out.raw(R"("asset":{"version":"2.0","generator":"scenegen )" SCENEGEN_VERSION
          R"(","extras":{"scenegen":{"format":1,"version":")" SCENEGEN_VERSION "\"");
  if (info.seed) {
    out.raw(R"(,"seed":)");
    out.number(*info.seed);
  }
  out.raw(R"(,"arguments":[)");
  Commas commas(out);
  for (const std::string& argument : info.arguments) commas.next().string(argument);
  out.raw(R"(],"objects":)");
  out.number(scene_.objects.size());
  out.raw(R"(,"layout":")");
  out.raw(name_of(nodes_.layout));
  out.raw(R"(","visibility":")");
  out.raw(name_of(nodes_.visibility));
  out.raw(R"(","time":{"unit":"s","start":0,"end":)");
  out.number(scene_.duration_s);
  out.raw("}");
  emit_appearance(out);
  out.raw("}}}");
}

void Document::emit_appearance(TextOut& out) const {
  if (!scene_.info.appearance) return;
  const AppearanceInfo& a = *scene_.info.appearance;
  const auto text = [&](std::string_view key, std::string_view value) {
    out.raw(key);
    out.string(value);
  };
  const auto value = [&](std::string_view key, auto number) {
    out.raw(key);
    out.number(number);
  };
  text(R"(,"appearance":{"curve":)", a.curve);
  text(R"(,"curveVariant":)", a.curve_variant);
  text(R"(,"order":)", a.order);
  value(R"(,"cells":[)", a.cells.x);
  value(",", a.cells.y);
  value(",", a.cells.z);
  out.raw(R"(],"gridMinZUp":)");
  out.numbers(a.grid_z_up_m.lo);
  out.raw(R"(,"gridMaxZUp":)");
  out.numbers(a.grid_z_up_m.hi);
  value(R"(,"interval":)", a.interval_s);
  value(R"(,"hold":)", a.hold_s);
  value(R"(,"coherence":)", a.coherence_given);
  value(R"(,"coherenceMeasured":)", a.coherence_measured);
  value(R"(,"displaced":)", a.displaced_objects);
  value(R"(,"timed":)", a.timed_objects);
  value(R"(,"moments":)", a.moments);
  value(R"(,"locality":)", a.locality_cells);
  out.raw("}");
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

std::uint32_t Document::top_node_of(std::uint32_t object) const {
  if (!nodes_.wrapped.empty()) {
    const auto at = std::lower_bound(nodes_.wrapped.begin(), nodes_.wrapped.end(), object);
    if (at != nodes_.wrapped.end() && *at == object)
      return nodes_.first_wrapper + static_cast<std::uint32_t>(at - nodes_.wrapped.begin());
  }
  return nodes_.node_of(object);
}

void Document::emit_scenes(TextOut& out) const {
  out.raw(R"(,"scene":0,"scenes":[{"name":"scene")");
  Commas roots(out);
  const auto root = [&](std::uint32_t node) {
    if (roots.empty()) out.raw(R"(,"nodes":[)");
    roots.next().number(node);
  };
  if (nodes_.layout != Layout::nodes) {
    for (std::uint32_t g = 0; g < nodes_.groups.size(); ++g) root(nodes_.first_group + g);
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
  if (buffer_[ViewKind::names].bytes > 0) {
    out.raw(R"(,"extras":{"scenegen":{"names":{"bufferView":)");
    out.number(buffer_[ViewKind::names].index);
    out.raw(R"(,"count":)");
    out.number(scene_.objects.size());
    out.raw(R"(,"encoding":"front-coded-utf8"}}})");
  }
  out.raw("}]");
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
  member(R"(,"meshes":)", assets_.meshes);
  member(R"(,"materials":)", assets_.materials);
  member(R"(,"textures":)", assets_.textures);
  member(R"(,"samplers":)", assets_.samplers);
  member(R"(,"images":)", assets_.images);
}

void Document::emit_nodes(TextOut& out) const {
  if (nodes_.node_count == 0) return;
  out.raw(R"(,"nodes":[)");
  Commas commas(out);
  if (nodes_.layout == Layout::instances) emit_group_nodes(commas, out);
  emit_object_nodes(commas, out);
  if (nodes_.layout == Layout::groups) emit_group_nodes(commas, out);
  emit_frame_nodes(commas, out);
  emit_inserted_nodes(commas, out);
  out.raw("]");
}

void Document::emit_object_nodes(Commas& commas, TextOut& out) const {
  const Objects& objects = scene_.objects;
  const bool instances = nodes_.layout == Layout::instances;
  auto look = nodes_.looks.begin();     // both lists are by object, as the loop is
  auto single = nodes_.single.begin();  // layout groups: the others are in groups
  auto wrapped = nodes_.wrapped.begin();
  for (std::uint32_t k = 0; k < nodes_.object_node_count(scene_) && !out.sink().failed(); ++k) {
    const std::uint32_t i = nodes_.object_at(k);
    commas.next();
    emit_name(objects.names[i], out);
    emit_transform(objects.frame_from_object[i], out);
    const auto first_look = look;
    while (look != nodes_.looks.end() && look->object == i) ++look;
    const bool has_looks = look != first_look;
    if (!has_looks) {
      out.raw(R"(,"mesh":)");
      out.number(objects.mesh[i].value);
    } else {
      out.raw(R"(,"children":[)");
      Commas children(out);
      for (auto l = first_look; l != look; ++l)
        children.next().number(nodes_.first_look + static_cast<std::uint32_t>(l - nodes_.looks.begin()));
      out.raw("]");
    }
    bool carries_visibility = objects.visibility[i].valid();
    if (wrapped != nodes_.wrapped.end() && *wrapped == i) {
      carries_visibility = false;
      ++wrapped;
    }
    if (nodes_.layout == Layout::groups) {
      const bool is_single = single != nodes_.single.end() && *single == i;
      carries_visibility = carries_visibility && is_single;
      if (is_single) ++single;
    }
    if (carries_visibility && nodes_.pointer()) {
      out.raw(",");
      out.raw(kNodeVisibility);
    }
    if (instances || has_looks) {
      out.raw(R"(,"extras":{"scenegen":{)");
      if (instances) {
        out.raw(R"("object":)");
        out.number(i);
      }
      if (has_looks) {
        out.raw(instances ? R"(,"mesh":)" : R"("mesh":)");
        out.number(objects.mesh[i].value);
      }
      out.raw("}}");
    }
    out.raw("}");
  }
}

void Document::emit_group_nodes(Commas& commas, TextOut& out) const {
  std::uint32_t accessor = buffer_.first_instance;
  for (std::size_t g = 0; g < nodes_.groups.size() && !out.sink().failed(); ++g) {
    const Group& group = nodes_.groups[g];
    const bool carries_pointer = nodes_.pointer() && group.track.valid();
    commas.next();
    emit_name(nodes_.names[g], out);
    if (nodes_.layout == Layout::groups) {
      out.raw(R"(,"children":[)");
      Commas children(out);
      for (std::uint32_t k = group.first; k < group.first + group.count; ++k)
        children.next().number(nodes_.grouped[k]);
      out.raw("]");
      if (carries_pointer) {
        out.raw(",");
        out.raw(kNodeVisibility);
      }
      out.raw("}");
      continue;
    }
    const auto attribute = [&](std::string_view key) {
      out.raw(key);
      out.number(accessor++);
    };
    out.raw(R"(,"mesh":)");
    out.number(group.mesh.value);
    attribute(R"(,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)");
    if (group.rotated) attribute(R"(,"ROTATION":)");
    if (group.scaled) attribute(R"(,"SCALE":)");
    attribute(R"(,"_OBJECT_ID":)");
    out.raw(carries_pointer ? R"(}},"KHR_node_visibility":{}}})" : "}}}}");
  }
}

void Document::emit_frame_nodes(Commas& commas, TextOut& out) const {
  const std::size_t first_name = nodes_.groups.size();
  for (std::uint32_t f = 0; f < scene_.frames.size() && !out.sink().failed(); ++f) {
    const Frame& frame = scene_.frames[f];
    commas.next();
    emit_name(nodes_.names[first_name + f], out);
    if (frame.has_matrix) {
      out.raw(R"(,"matrix":)");
      out.floats(&frame.matrix[0][0], 16);
    } else {
      emit_transform(frame.local, out);
    }
    Commas children(out);
    const auto child = [&](std::uint32_t node) {
      if (children.empty()) out.raw(R"(,"children":[)");
      children.next().number(node);
    };
    for (const std::uint32_t i : nodes_.objects_of_frame[f]) child(top_node_of(i));
    for (const std::uint32_t i : nodes_.frames_of_frame[f]) child(nodes_.first_frame + i);
    for (const std::uint32_t i : nodes_.cameras_of_frame[f]) child(nodes_.first_camera + i);
    if (!children.empty()) out.raw("]");
    out.raw(R"(,"extras":{"scenegen":{"frame":)");
    out.number(f);
    out.raw("}}}");
  }
  for (std::uint32_t c = 0; c < scene_.cameras.size(); ++c) {
    Transform transform = scene_.cameras[c].frame_from_camera;
    transform.scale = glm::vec3(1.0F);
    commas.next();
    emit_name(nodes_.names[first_name + scene_.frames.size() + c], out);
    emit_transform(transform, out);
    out.raw(R"(,"camera":)");
    out.number(c);
    out.raw("}");
  }
}

void Document::emit_inserted_nodes(Commas& commas, TextOut& out) const {
  std::size_t name = nodes_.groups.size() + scene_.frames.size() + scene_.cameras.size();
  for (const std::uint32_t i : nodes_.wrapped) {
    commas.next();
    emit_name(nodes_.names[name++], out);
    out.raw(R"(,"children":[)");
    out.number(nodes_.node_of(i));
    out.raw("]");
    if (nodes_.pointer()) {
      out.raw(",");
      out.raw(kNodeVisibility);
    }
    out.raw("}");
  }
  for (const LookNode& look : nodes_.looks) {
    commas.next();
    emit_name(nodes_.names[name++], out);
    out.raw(R"(,"mesh":)");
    out.number(look.look.value);
    out.raw(R"(,"extras":{"scenegen":{"look":)");
    out.number(look.number);
    out.raw("}}}");
  }
}

}  // namespace scenegen::gltf
