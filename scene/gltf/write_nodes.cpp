// Text of the nodes, in the order that docs/FORMAT.md 2 gives.
#include <algorithm>

#include "scene/gltf/write_document.h"
#include "scene/gltf/write_info.h"

namespace scenegen::gltf {

namespace {

void emit_name(std::string_view name, TextOut& out) {
  out.raw(R"({"name":)");
  out.string(name);
}

constexpr std::string_view kNodeVisibility = R"("extensions":{"KHR_node_visibility":{}})";

}  // namespace

std::uint32_t Document::top_node_of(std::uint32_t object) const {
  if (!nodes_.wrapped.empty()) {
    const auto at = std::lower_bound(nodes_.wrapped.begin(), nodes_.wrapped.end(), object);
    if (at != nodes_.wrapped.end() && *at == object)
      return nodes_.first_wrapper + static_cast<std::uint32_t>(at - nodes_.wrapped.begin());
  }
  return nodes_.node_of(object);
}

void Document::emit_nodes(TextOut& out) const {
  if (nodes_.node_count == 0) return;
  out.raw(R"(,"nodes":[)");
  Commas commas(out);
  if (nodes_.compact()) emit_group_nodes(commas, out);
  emit_object_nodes(commas, out);
  if (nodes_.layout == Layout::groups) emit_group_nodes(commas, out);
  emit_frame_nodes(commas, out);
  emit_inserted_nodes(commas, out);
  out.raw("]");
}

void Document::emit_object_nodes(Commas& commas, TextOut& out) const {
  const Objects& objects = scene_.objects;
  const bool indexed = nodes_.compact() || !nodes_.timelines.empty();
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
    const Group* const look_group = nodes_.look_group(i);
    if (look_group != nullptr) {
      out.raw(R"(,"mesh":)");
      out.number(nodes_.group_nodes[look_group->first_node].look.value);
    } else if (!has_looks) {
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
    if (look_group != nullptr) {
      emit_look_of_object(*look_group, 0, i, out);
    } else if (indexed || has_looks) {
      out.raw(R"(,"extras":{"scenegen":{)");
      Commas members(out);
      if (indexed) {
        members.next().raw(R"("object":)");
        out.number(i);
      }
      if (has_looks) {
        members.next().raw(R"("mesh":)");
        out.number(objects.mesh[i].value);
      }
      out.raw("}}");
    }
    out.raw("}");
  }
}

/// What extras.scenegen says of look `number` of a group; `mesh` (if valid) is the Objects::mesh of what the
/// node stands for.
void Document::emit_look_members(const Group& group, std::uint32_t number, MeshId mesh, TextOut& out) const {
  const auto member = [&](std::string_view key, std::uint32_t value) {
    out.raw(key);
    out.number(value);
  };
  member(R"("look":)", number);
  if (number != 0) return;
  if (mesh.valid()) member(R"(,"mesh":)", mesh.value);
  if (group.track.valid()) member(R"(,"visibility":)", nodes_.timeline_of_track[group.track.value]);
  member(R"(,"looks":)", nodes_.timeline_of_track[group.looks.value]);
}

/// An object of layout groups in look `number` of its group.
void Document::emit_look_of_object(const Group& group, std::uint32_t number, std::uint32_t object,
                                   TextOut& out) const {
  out.raw(R"(,"extras":{"scenegen":{"object":)");
  out.number(object);
  out.raw(",");
  emit_look_members(group, number, scene_.objects.mesh[object], out);
  out.raw("}}");
}

void Document::emit_group_nodes(Commas& commas, TextOut& out) const {
  for (std::size_t n = 0; n < nodes_.group_nodes.size() && !out.sink().failed(); ++n) {
    const GroupNode& node = nodes_.group_nodes[n];
    const Group& group = nodes_.groups[node.group];
    const bool carries_pointer = node.by_pointer.track.valid();
    commas.next();
    emit_name(nodes_.names[n], out);
    if (nodes_.layout == Layout::groups) {
      out.raw(R"(,"children":[)");
      Commas children(out);
      for (std::uint32_t k = 0; k < group.count; ++k)
        children.next().number(node.number == 0 ? nodes_.grouped[group.first + k]
                                                : nodes_.leaf_of(group, node.number) + k);
      out.raw("]");
      if (carries_pointer) {
        out.raw(",");
        out.raw(kNodeVisibility);
      }
      out.raw("}");
      continue;
    }
    if (nodes_.layout == Layout::merged) {
      emit_merged_node(n, out);
      continue;
    }
    out.raw(R"(,"mesh":)");
    out.number((node.look.valid() ? node.look : group.mesh).value);
    out.raw(R"(,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{)");
    emit_attributes(group.first_set, out);  // looks share them
    out.raw(carries_pointer ? R"(}},"KHR_node_visibility":{}})" : "}}}");
    if (node.look.valid()) {
      out.raw(R"(,"extras":{"scenegen":{)");
      emit_look_members(group, node.number, group.mesh, out);
      out.raw("}}");
    } else if (nodes_.id_table) {
      out.raw(R"(,"extras":{"scenegen":{"ids":)");
      out.number(group.first);
      out.raw("}}");
    }
    out.raw("}");
  }
}

/// "TRANSLATION":17,… of a set.
void Document::emit_attributes(std::uint32_t set, TextOut& out) const {
  const InstanceAccessors& accessors = buffer_.instances[set];
  const auto attribute = [&](std::string_view key, std::uint32_t accessor) {
    out.raw(key);
    out.number(accessor);
  };
  attribute(R"("TRANSLATION":)", accessors.translation);
  if (nodes_.sets[set].rotated) attribute(R"(,"ROTATION":)", accessors.rotation);
  if (nodes_.sets[set].scaled) attribute(R"(,"SCALE":)", accessors.scale);
  if (!nodes_.id_table) attribute(R"(,"_OBJECT_ID":)", accessors.object_id);
}

/// A node of layout merged: what is drawn, and in extras the objects that it was made of.
void Document::emit_merged_node(std::size_t n, TextOut& out) const {
  const GroupNode& node = nodes_.group_nodes[n];
  const Group& group = nodes_.groups[node.group];
  if (merge_.mesh_of_node[n].valid()) {
    out.raw(R"(,"mesh":)");
    out.number(merge_.mesh_of_node[n].value);
  }
  if (node.by_pointer.track.valid()) {
    out.raw(",");
    out.raw(kNodeVisibility);
  }
  out.raw(R"(,"extras":{"scenegen":{)");
  if (node.look.valid()) {
    emit_look_members(group, node.number, {}, out);
    out.raw(R"(,"shows":)");
    out.number(node.look.value);
    out.raw(",");
  }
  out.raw(R"("objects":[)");
  Commas sets(out);
  for (std::uint32_t k = group.first_set; k < group.first_set + group.set_count; ++k) {
    sets.next().raw(R"({"mesh":)");
    out.number(nodes_.sets[k].mesh.value);
    out.raw(",");
    emit_attributes(k, out);
    out.raw("}");
  }
  out.raw("]}}}");
}

void Document::emit_frame_nodes(Commas& commas, TextOut& out) const {
  const std::size_t first_name = nodes_.group_nodes.size();
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
    if (nodes_.layout != Layout::nodes) {
      for (const std::uint32_t g : nodes_.groups_of_frame[f]) child(nodes_.first_group + g);
    }
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
  std::size_t name = nodes_.group_nodes.size() + scene_.frames.size() + scene_.cameras.size();
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
  if (nodes_.leaf_count() == 0) return;
  for (const Group& group : nodes_.groups) {
    for (std::uint32_t number = 1; number < group.node_count; ++number) {
      for (std::uint32_t k = 0; k < group.count && !out.sink().failed(); ++k) {
        const std::uint32_t i = nodes_.grouped[group.first + k];
        commas.next();
        emit_name(nodes_.names[name++], out);
        emit_transform(scene_.objects.frame_from_object[i], out);
        out.raw(R"(,"mesh":)");
        out.number(nodes_.group_nodes[group.first_node + number].look.value);
        emit_look_of_object(group, number, i, out);
        out.raw("}");
      }
    }
  }
}

}  // namespace scenegen::gltf
